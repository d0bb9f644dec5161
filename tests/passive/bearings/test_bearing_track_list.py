"""Protects the published list: every angle is that of its stamp."""

import numpy as np
import pytest

from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.geometry import line_array
from sonar_tracking.passive.bearings.bearing_measurement import BearingMeasurement
from sonar_tracking.passive.bearings.bearing_track_list import folded_angles, running_rows
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


def test_angles_at_the_ends_of_the_range_stay_and_those_beyond_come_back() -> None:
    square = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]])
    angles, signs = folded_angles(np.array([-np.pi, np.pi, np.pi + 0.1]), square)
    assert angles[:2].tolist() == [-np.pi, np.pi]
    assert angles[2] == pytest.approx(0.1 - np.pi)
    assert signs.tolist() == [1.0, 1.0, 1.0]
    angles, signs = folded_angles(0.5 * np.pi + np.array([-np.pi, 0.0, 0.1]), line_array(4, 0.5))
    assert angles[:2].tolist() == [-0.5 * np.pi, 0.5 * np.pi]
    assert angles[2] == pytest.approx(0.5 * np.pi - 0.1)
    assert signs.tolist() == [1.0, 1.0, -1.0]
