"""Parameters of the default estimator."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.configuration import parameter
from sonar_tracking.records.arrays import FloatArray


@dataclass(frozen=True)
class RangeBankConfiguration:
    """Parameters of the default estimator."""

    minimum_range: float = parameter(
        500.0, "Nearest initial range considered", unit="m", minimum=1.0
    )
    maximum_range: float = parameter(
        20_000.0, "Farthest initial range considered", unit="m", minimum=2.0
    )
    n_ranges: int = parameter(6, "Range hypotheses, geometrically spaced", minimum=1, maximum=40)
    maximum_speed: float = parameter(20.0, "Of the target, per axis", unit="m/s", minimum=0.1)
    acceleration: float = parameter(
        0.01, "Process noise of a target that moves straight", unit="m/s^2", minimum=0.0
    )
    gate: float = parameter(4.0, "Gate of each measurement, standard deviations", minimum=1.0)
    manoeuvre_acceleration: float = parameter(
        0.1, "Process noise while the target manoeuvres", unit="m/s^2", minimum=0.0
    )
    manoeuvre_duration: float = parameter(
        30.0, "How long it is taken to manoeuvre after an alarm", unit="s", minimum=0.0
    )
    manoeuvre_speed: float = parameter(
        2.0, "Velocity change that an alarm stands for", unit="m/s", minimum=0.0
    )
    manoeuvre_lag: float = parameter(
        20.0, "How long before its alarm a manoeuvre began", unit="s", minimum=0.0
    )

    def range_edges(self) -> FloatArray:
        """Return the bounds of the range intervals, shape (n_ranges + 1,), m."""
        return np.geomspace(self.minimum_range, self.maximum_range, self.n_ranges + 1)
