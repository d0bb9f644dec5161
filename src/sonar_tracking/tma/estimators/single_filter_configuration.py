"""Parameters of the estimators with one hypothesis of range, and their prior."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.configuration import parameter
from sonar_tracking.tma.estimators.bank_restart import COVARIANCE, FULL, NEVER, SOURCE_FREQUENCY
from sonar_tracking.tma.estimators.hypothesis_bank import HypothesisBank, start_bank
from sonar_tracking.tma.estimators.sensor_frame import TmaMeasurement


@dataclass(frozen=True)
class SingleFilterConfiguration:
    """Parameters of the filters with one hypothesis."""

    maximum_range: float = parameter(
        20_000.0, "The initial range is uniform up to this", unit="m", minimum=1.0
    )
    maximum_speed: float = parameter(20.0, "Of the target, per axis", unit="m/s", minimum=0.1)
    acceleration: float = parameter(0.01, "Process noise", unit="m/s^2", minimum=0.0)
    restart: str = parameter(
        NEVER,
        "What a line that appears restarts",
        choices=(NEVER, FULL, COVARIANCE, SOURCE_FREQUENCY),
    )

    def start(self, measurement: TmaMeasurement) -> HypothesisBank:
        """Return the paper's prior (24), (25) around the measured azimuth."""
        edges = np.array([0.0, self.maximum_range])
        return start_bank(measurement, edges, self.maximum_speed)
