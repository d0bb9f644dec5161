"""The broadband element time series of a scenario's array, and the lines of own ship in them.

Levels are relative to the noise of an element: Gaussian, white, of power 1 in every hertz (one
sided), so that its samples have the variance ``sample_rate / 2``. A target's ``level_db`` is its
broadband spectrum over that of the noise, the same ratio as in any narrow band of it; a line's
``level_db`` is its power over that of the noise in 1 Hz. Both hold at the array: sound does not
fade on its way.
"""

from __future__ import annotations

from dataclasses import dataclass

from sonar_tracking.configuration import parameter
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.passive.sample_records import MINIMUM_SAMPLE_RATE


@dataclass(frozen=True)
class HydrophoneConfiguration:
    """Broadband samples of every element of the section ``array``, which gives the geometry."""

    sample_rate: float = parameter(
        2000.0, "samples per second", unit="Hz", minimum=MINIMUM_SAMPLE_RATE, maximum=1e6
    )
    block_samples: int = parameter(500, "samples in one message", minimum=1, maximum=10_000_000)
    own_ship_line_frequencies: tuple[float, ...] = parameter(
        (), "lines of own ship, heard from the direction of its bow", unit="Hz", minimum=1e-3
    )
    own_ship_line_levels_db: tuple[float, ...] = parameter(
        (),
        "their power over that of an element's noise in 1 Hz, one for each",
        unit="dB",
        minimum=-100.0,
        maximum=200.0,
    )

    @property
    def block_period(self) -> float:
        """Time between messages, s."""
        return self.block_samples / self.sample_rate


def check_hydrophones(configuration: HydrophoneConfiguration, where: str) -> None:
    """Raise a sentence if the values do not fit together.

    Raises
    ------
    ConfigurationError
        Naming the value and what to do.
    """
    frequencies = configuration.own_ship_line_frequencies
    levels = configuration.own_ship_line_levels_db
    if len(frequencies) != len(levels):
        raise ConfigurationError(
            f"{where}.own_ship_line_frequencies has {len(frequencies)} entries and "
            f"own_ship_line_levels_db {len(levels)}; give one level for each line."
        )
    check_below_half_rate(max(frequencies, default=0.0), configuration, where)


def check_below_half_rate(
    frequency: float, configuration: HydrophoneConfiguration, where: str
) -> None:
    """Raise a sentence if a line cannot be sampled.

    Raises
    ------
    ConfigurationError
        Naming the frequency and the sample rate it needs.
    """
    if frequency >= 0.5 * configuration.sample_rate:
        raise ConfigurationError(
            f"{where}: a line of {frequency:g} Hz needs a hydrophones.sample_rate above "
            f"{2.0 * frequency:g} Hz; it is {configuration.sample_rate:g} Hz."
        )
