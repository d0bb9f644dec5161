"""One target of a scenario: how loud it is, when it is heard, how it moves."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from sonar_tracking.configuration import SECTION, parameter
from sonar_tracking.records.arrays import BoolArray
from sonar_tracking.simulation.scenarios.bearing_motion import (
    ArctangentMotion,
    LinearMotion,
    SinusoidalMotion,
    TableMotion,
    TargetMotion,
)
from sonar_tracking.simulation.scenarios.kinematic_motion import KinematicMotion

MOTIONS: dict[str, type[TargetMotion]] = {
    "arctangent": ArctangentMotion,
    "linear": LinearMotion,
    "sinusoidal": SinusoidalMotion,
    "table": TableMotion,
    "kinematic": KinematicMotion,
}


@dataclass(frozen=True)
class LineConfiguration:
    """A tonal that a target emits."""

    frequency: float = parameter(300.0, "at rest", unit="Hz", minimum=1e-3)
    level_db: float = parameter(
        20.0, "power over that of an element's noise in 1 Hz", unit="dB", minimum=-100, maximum=200
    )
    present: tuple[float, ...] = parameter(
        (), "times from, to, from, to, ... between which it is emitted; empty = always", unit="s"
    )

    def is_present(self, times: ArrayLike) -> BoolArray:
        """Return at which times, shape (...), s, the line is there; intervals are half open."""
        return within(self.present, times)


PHASES = ("fixed", "random", "turning", "random_per_block")


@dataclass(frozen=True)
class TargetConfiguration:
    """A source of narrowband Gaussian sound.

    Targets of one coherent group emit the same waveform; each adds its own level and phase.
    """

    name: str = parameter("", "name for people; empty = target_<number>")
    level_db: float = parameter(
        0.0, "signal power over noise power per element", unit="dB", minimum=-100.0, maximum=100.0
    )
    present: tuple[float, ...] = parameter(
        (), "times from, to, from, to, ... between which it is there; empty = always", unit="s"
    )
    heard: bool = parameter(True, "it makes sound; otherwise it gives echoes at the most")
    echoes: bool = parameter(True, "an active sonar sees it; otherwise it is heard at the most")
    echo_level_db: float = parameter(
        0.0,
        "echo over that of a target of the active sonar's signal_to_noise_ratio_db",
        unit="dB",
        minimum=-100.0,
        maximum=100.0,
    )
    coherent_group: str = parameter("", "name of the group of one waveform; empty = none")
    coherent_phase: str = parameter(
        "fixed",
        "phase within the group: coherent_phase_deg, random per run, turning at "
        "coherent_phase_rate_deg, or random per block",
        choices=PHASES,
    )
    coherent_phase_deg: float = parameter(0.0, "phase at scenario time 0", unit="deg")
    coherent_phase_rate_deg: float = parameter(0.0, "for turning", unit="deg/s")
    lines: tuple[LineConfiguration, ...] = field(default=(), metadata=SECTION)
    motion: TargetMotion = field(default_factory=ArctangentMotion, metadata=SECTION)

    def is_present(self, times: ArrayLike) -> BoolArray:
        """Return at which times, shape (...), s, it is there."""
        return within(self.present, times)

    def is_heard(self, times: ArrayLike) -> BoolArray:
        """Return at which times of reception, shape (...), s, it is heard."""
        return self.is_present(times) & self.heard


def within(schedule: tuple[float, ...], times: ArrayLike) -> BoolArray:
    """Return which times lie in the half open intervals from, to, from, to, ...; empty = all.

    Parameters
    ----------
    schedule : tuple of float
        Ascending, s.
    times : array_like, shape (...)
        s.

    Returns
    -------
    ndarray of bool, shape (...)
        True inside.
    """
    if not schedule:
        return np.ones(np.shape(times), dtype=bool)
    return np.searchsorted(schedule, times, side="right") % 2 == 1
