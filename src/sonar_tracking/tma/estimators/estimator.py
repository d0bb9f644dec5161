"""The interface every estimator of one target has: measurements in, in order; estimates out."""

from __future__ import annotations

from typing import Protocol

from sonar_tracking.tma.estimators.sensor_frame import TmaEstimate, TmaMeasurement


class Estimator(Protocol):
    """Estimates where one target is from what a station measures of it."""

    def update(self, measurement: TmaMeasurement) -> TmaEstimate:
        """Take one measurement in and return where the target is.

        Parameters
        ----------
        measurement : TmaMeasurement
            Later than the one before; shapes (...,) are a batch of independent runs.
        """
