"""Protects what is published of the tracks: folded angles, signs of rates, rows of every kind."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.passive.bearings.bearing_measurement import BearingMeasurement
from sonar_tracking.passive.bearings.bearing_track_list import (
    bearing_tracks,
    folded_angles,
    running_rows,
    started_rows,
    tentative_rows,
)
from sonar_tracking.passive.track_start.tentative_track import StartedTrack, TentativeTrack
from sonar_tracking.records.bearings import Sensor, TrackStatus
from tests.passive.bearings.test_joined_bearings import SECOND, estimates
from tests.passive.crossing_scene import POSITIONS

RUNNING = KalmanState(
    np.array([[0.2, 0.01], [np.pi - 0.3, 0.02]]), np.stack([1e-4 * np.eye(2), 4e-4 * np.eye(2)])
)
MEASURED = BearingMeasurement(
    np.array([0.21, np.pi - 0.28]), np.array([0.01, 0.02]), np.array([1e-5, 2e-5]), age=0.5
)
CIRCLE = np.stack([np.cos(np.arange(8.0)), np.sin(np.arange(8.0)), np.zeros(8)], axis=1)


@pytest.mark.parametrize(
    ("angle_deg", "line_deg", "sign", "around_deg"),
    [
        (30.0, 30.0, 1.0, 30.0),
        (90.0, 90.0, 1.0, 90.0),
        (91.0, 89.0, -1.0, 91.0),
        (-100.0, -80.0, -1.0, -100.0),
        (179.0, 1.0, -1.0, 179.0),
        (181.0, -1.0, -1.0, -179.0),
        (-190.0, 10.0, -1.0, 170.0),
        (300.0, -60.0, 1.0, -60.0),
        (450.0, 90.0, 1.0, 90.0),
    ],
)
def test_a_line_hears_ahead_and_astern_alike_and_others_all_round(
    angle_deg: float, line_deg: float, sign: float, around_deg: float
) -> None:
    angles = np.radians([angle_deg, 10.0])
    folded, signs = folded_angles(angles, POSITIONS)
    assert np.degrees(folded) == pytest.approx([line_deg, 10.0])
    assert signs.tolist() == [sign, 1.0]
    wrapped, signs = folded_angles(angles, CIRCLE)
    assert np.degrees(wrapped) == pytest.approx([around_deg, 10.0])
    assert signs.tolist() == [1.0, 1.0]


def test_rows_of_all_kinds_follow_each_other() -> None:
    running = running_rows(
        (3, 5),
        RUNNING,
        MEASURED,
        np.array([10.0, 20.0]),
        (TrackStatus.CONFIRMED, TrackStatus.COASTED),
        np.array([0.9, 0.5]),
    )
    started = started_rows((StartedTrack(8, np.array([0.4, 0.03]), 9e-4 * np.eye(2)),))
    tentative = tentative_rows(
        (
            TentativeTrack(9, (0,), (0.5,), (1e-4,)),
            TentativeTrack(10, (0, SECOND), (0.6, 0.7), (1e-4, 1e-4)),
        ),
        2 * SECOND,
    )
    seen = replace(estimates(2 * SECOND), next_stamp=7, sensor=Sensor("stern"))
    tracks = bearing_tracks(seen, running.append(started).append(tentative))
    assert tracks.id.tolist() == [3, 5, 8, 9, 10]
    assert tracks.status.tolist() == [
        TrackStatus.CONFIRMED,
        TrackStatus.COASTED,
        TrackStatus.CONFIRMED,
        TrackStatus.TENTATIVE,
        TrackStatus.TENTATIVE,
    ]
    # The second one is astern of the line: mirrored, and turning the other way.
    assert tracks.arrival_angle == pytest.approx([0.2, 0.3, 0.4, 0.5, 0.8])
    assert tracks.arrival_angle_rate == pytest.approx([0.01, -0.02, 0.03, np.nan, 0.1], nan_ok=True)
    # Half a second old: moved on with the rate.
    unknown = [np.nan] * 3
    measured = [0.21 + 0.005, 0.28 - 0.01, *unknown]
    assert tracks.measurement == pytest.approx(measured, nan_ok=True)
    assert tracks.innovation == pytest.approx([0.01, -0.02, *unknown], nan_ok=True)
    assert tracks.measurement_variance == pytest.approx([1e-5, 2e-5, *unknown], nan_ok=True)
    assert tracks.signal_to_noise_ratio == pytest.approx([10.0, 20.0, *unknown], nan_ok=True)
    existence = [0.9, 0.5, 0.97, 0.2, 0.625 * 2.0 / 2.25]
    assert tracks.existence_probability == pytest.approx(existence)
    assert tracks.covariance[3] == pytest.approx(
        np.array([[1e-4, np.nan], [np.nan, np.nan]]), nan_ok=True
    )
    assert (tracks.stamp, tracks.next_stamp, tracks.sensor) == (2 * SECOND, 7, Sensor("stern"))
    assert tracks.ambiguous.all()
    around = bearing_tracks(replace(seen, element_positions=CIRCLE), running)
    assert not around.ambiguous.any()


def test_what_was_not_measured_is_unknown() -> None:
    rows = running_rows((3, 5), RUNNING, None, np.full(2, np.nan), (TrackStatus.COASTED,) * 2, None)
    for column in (rows.measurement, rows.innovation, rows.variance, rows.existence_probability):
        assert np.isnan(column).tolist() == [True, True]
