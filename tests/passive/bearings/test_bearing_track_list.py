"""Protects the published list: every angle is that of its stamp."""

import numpy as np
import pytest

from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.passive.bearings.bearing_measurement import BearingMeasurement
from sonar_tracking.passive.bearings.bearing_track_list import running_rows
from sonar_tracking.records.bearings import TrackStatus


@pytest.mark.parametrize("age", [0.0, 0.5])
def test_an_older_measurement_is_brought_to_the_stamp(age: float) -> None:
    """The window of data ends at the stamp; its angle is half a window older."""
    angle, rate = np.array([0.3, -0.2]), np.array([0.02, -0.01])
    filters = KalmanState(np.stack([angle, rate], axis=-1), np.zeros((2, 2, 2)))
    measurement = BearingMeasurement(angle - age * rate, 0.01 * angle, np.full(2, 1e-6), age)
    rows = running_rows(
        (1, 2), filters, measurement, np.ones(2), (TrackStatus.CONFIRMED,) * 2, None
    )
    assert rows.measurement == pytest.approx(angle)
    assert rows.innovation == pytest.approx(0.01 * angle)
