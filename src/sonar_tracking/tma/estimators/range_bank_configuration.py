"""Parameters of the default estimator."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.configuration import parameter
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.tma.estimators.weaving import Weave


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
        0.8,
        "Of targets that weave about their mean course (zig-zag): standard deviation of the "
        "velocity, each axis; 0 = none",
        unit="m/s",
        minimum=0.0,
    )
    weave_period: float = parameter(
        130.0, "And how long a turn to port and one to starboard take", unit="s", minimum=1.0
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
    def weave(self) -> Weave:
        """How targets weave."""
        return Weave(self.weave_speed, self.weave_period)

    @property
    def accelerations(self) -> tuple[float, float, float]:
        """Process noise of what moves straight, manoeuvres and wanders, m/s^2."""
        return self.acceleration, self.manoeuvre_acceleration, self.wander_acceleration

    @property
    def lasting_shares(self) -> FloatArray:
        """Probability that a target wanders, and that it weaves, shape (2,)."""
        weaving = self.weave_probability
        return np.array([(1.0 - weaving) * self.wander_probability, weaving])

    def range_edges(self) -> FloatArray:
        """Return the bounds of the range intervals, shape (n_ranges + 1,), m."""
        return np.geomspace(self.minimum_range, self.maximum_range, self.n_ranges + 1)
