"""The broadband element time series of a scenario's array, and the lines of own ship in them.

Levels are relative to the noise of an element: Gaussian, white, of power 1 in every hertz (one
sided), so that its samples have the variance ``sample_rate / 2``. A target's ``level_db`` is its
broadband spectrum over that of the noise, the same ratio as in any narrow band of it; a line's
``level_db`` is its power over that of the noise in 1 Hz. Both hold at the array: sound does not
fade on its way.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sonar_tracking.configuration import parameter
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.records.samples import MINIMUM_SAMPLE_RATE
from sonar_tracking.simulation.scenarios.target import TargetConfiguration


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


def check_hydrophones(
    hydrophones: HydrophoneConfiguration, targets: Sequence[TargetConfiguration], where: str
) -> None:
    """Raise a sentence on the first thing that cannot be simulated.

    Parameters
    ----------
    hydrophones : HydrophoneConfiguration
        Sampling and own ship's lines.
    targets : sequence of TargetConfiguration
        What is heard.
    where : str
        Where it comes from, named in errors.

    Raises
    ------
    ConfigurationError
        Naming the value and what to do.
    """
    frequencies = hydrophones.own_ship_line_frequencies
    levels = hydrophones.own_ship_line_levels_db
    if len(frequencies) != len(levels):
        raise ConfigurationError(
            f"{where}hydrophones.own_ship_line_frequencies has {len(frequencies)} entries and "
            f"own_ship_line_levels_db {len(levels)}; give one level for each line."
        )
    _check_rate(hydrophones.sample_rate, frequencies, f"{where}hydrophones")
    for index, target in enumerate(targets):
        name = f"{where}targets[{index}]"
        if target.coherent_group:
            raise ConfigurationError(
                f"{name}.coherent_group is {target.coherent_group}, but hydrophones know no "
                "coherent groups; leave it out."
            )
        lines = tuple(line.frequency for line in target.lines)
        _check_rate(hydrophones.sample_rate, lines, f"{name}.lines")


def _check_rate(sample_rate: float, frequencies: tuple[float, ...], where: str) -> None:
    highest = max(frequencies, default=0.0)
    if highest >= 0.5 * sample_rate:
        raise ConfigurationError(
            f"{where}: {highest:g} Hz needs a hydrophones.sample_rate above {2.0 * highest:g} Hz; "
            f"it is {sample_rate:g} Hz."
        )
