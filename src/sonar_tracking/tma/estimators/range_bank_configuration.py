"""Parameters of the default estimator."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.configuration import parameter
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.tma.estimators.weaving import Weave

WEAVE_PERIODS = 0.5, 1.0, 1.6
"""Of targets that weave, in periods: one that is longer still would take a turn for a deviation."""

WEAVE_DAMPING = 0.2
"""Little enough to tell a zig-zag from a wandering velocity, enough for periods in between."""


@dataclass(frozen=True)
class RangeBankConfiguration:
    """Parameters of the default estimator."""

    minimum_range: float = parameter(
        500.0, "Nearest initial range considered", unit="m", minimum=1.0
    )
    maximum_range: float = parameter(
        20_000.0,
        "Farthest initial range expected; up to two and a half times it is considered, too",
        unit="m",
        minimum=2.0,
    )
    n_ranges: int = parameter(6, "Range hypotheses, geometrically spaced", minimum=1, maximum=40)
    maximum_speed: float = parameter(20.0, "Of the target, per axis", unit="m/s", minimum=0.1)
    acceleration: float = parameter(
        0.01, "Process noise of a target that moves straight", unit="m/s^2", minimum=0.0
    )
    gate: float = parameter(4.0, "Gate of each measurement, standard deviations", minimum=1.0)
    manoeuvre_acceleration: float = parameter(
        0.2, "Process noise while the target manoeuvres", unit="m/s^2", minimum=0.0
    )
    manoeuvre_interval: float = parameter(
        30_000.0,
        "Mean time between manoeuvres of a target; 1e9 = it never does",
        unit="s",
        minimum=1.0,
        maximum=1e9,
    )
    manoeuvre_duration: float = parameter(
        100.0, "Mean duration of a manoeuvre", unit="s", minimum=1.0, maximum=1e9
    )
    weave_speed: float = parameter(
        0.6,
        "Of targets that weave about their mean course (zig-zag): standard deviation of the "
        "velocity, each axis; 0 = none",
        unit="m/s",
        minimum=0.0,
    )
    weave_period: float = parameter(
        150.0,
        "And how long a turn to port and one to starboard take together; half of it and 1.6 times "
        "are considered, too",
        unit="s",
        minimum=1.0,
    )
    weave_probability: float = parameter(0.3, "That a target weaves", minimum=0.0, maximum=0.99)
    wander_acceleration: float = parameter(
        0.035,
        "Process noise of targets whose velocity wanders (small boats, gliders)",
        unit="m/s^2",
        minimum=0.0,
    )
    wander_probability: float = parameter(
        0.04, "That the velocity of a target that does not weave wanders", minimum=0.0, maximum=0.99
    )
    learn_errors: bool = parameter(
        True,
        "Learn from the data how large and how lasting the errors of bearings and lines are; "
        "false = independent, and as large as told",
    )

    @property
    def weaves(self) -> tuple[Weave, ...]:
        """How targets weave: each as probable as the others."""
        return tuple(
            Weave(self.weave_speed, part * self.weave_period, WEAVE_DAMPING)
            for part in WEAVE_PERIODS
        )

    @property
    def accelerations(self) -> tuple[float, float, float]:
        """Process noise of what moves straight, manoeuvres and wanders, m/s^2."""
        return self.acceleration, self.manoeuvre_acceleration, self.wander_acceleration

    @property
    def lasting_shares(self) -> FloatArray:
        """Probability that a target wanders, and that it weaves in each way, shape (4,)."""
        weaving = self.weave_probability
        ways = len(WEAVE_PERIODS)
        return np.array([(1.0 - weaving) * self.wander_probability, *[weaving / ways] * ways])

    @property
    def moves_one_way(self) -> bool:
        """Whether all modes of motion that are possible are one and the same."""
        weaves = self.weave_speed > 0.0 and self.weave_probability > 0.0
        turns = self.manoeuvre_acceleration != self.acceleration
        wanders = self.wander_acceleration != self.acceleration and self.wander_probability > 0.0
        return not (weaves or turns or wanders)

    def range_edges(self) -> FloatArray:
        """Return the bounds of the range intervals, shape (n_ranges + 1,), m."""
        return np.geomspace(self.minimum_range, self.maximum_range, self.n_ranges + 1)
