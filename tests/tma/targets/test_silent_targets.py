"""Protects a target that falls silent from the bearings of nothing that are reported meanwhile."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import PositionTracks
from sonar_tracking.records.time import nanoseconds
from sonar_tracking.tma.targets.passive_frame import PassiveFrame
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration
from sonar_tracking.tma.tracker.tma_tracker_stage import TmaTrackerStage
from tests.tma.direction_reports import reported, seen_from

STATION = np.array([0.0, 0.0, -1000.0])
USUAL, OF_NOTHING = np.radians(0.5), np.radians(7.0)
SILENT_FROM, HEARD_AGAIN = 150.0, 240.0


def ship(time: float) -> FloatArray:
    return np.array([900.0 - 3.0 * time, 1400.0 + 1.0 * time, 0.0])


def followed(seed: int, silent_from: float = SILENT_FROM) -> list[tuple[float, PositionTracks]]:
    """Return the lists of five minutes; while the ship is silent noise of another place is told."""
    generator = np.random.default_rng(seed)
    stage = TmaTrackerStage(TmaTrackerConfiguration(target_height=-STATION[2]))
    lists = []
    for time in np.arange(0.0, 300.0, 1.0):
        silent = silent_from <= time < HEARD_AGAIN
        deviation = OF_NOTHING * generator.uniform(0.8, 1.3) if silent else USUAL
        place = np.array([-500.0, -900.0, 0.0]) if silent else ship(time)
        angles = seen_from(STATION, place) + deviation * generator.standard_normal(2)
        stamp = nanoseconds(1000.0 + time)
        azimuth, elevation = angles.tolist()
        one = reported("bottom", STATION, azimuth, elevation, deviation, stamp)
        tracks = stage.update(PassiveFrame(stamp, (one,))).tracks
        assert tracks is not None
        lists.append((time, tracks))
    return lists


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_silent_ship_is_predicted_from_where_it_was_and_heard_again(seed: int) -> None:
    for time, tracks in followed(seed):
        if time < SILENT_FROM + 30.0 or HEARD_AGAIN <= time < HEARD_AGAIN + 20.0:
            continue
        assert tracks.id.tolist() == [1]
        expected = TrackStatus.COASTED if time < HEARD_AGAIN else TrackStatus.CONFIRMED
        assert tracks.status.tolist() == [expected]
        error = tracks.state[0, :2] - ship(time)[:2]
        assert error @ np.linalg.solve(tracks.covariance[0, :2, :2], error) < 9.21
        assert np.hypot(*error) < 300.0


def test_bearings_are_taken_in_as_long_as_nothing_is_known() -> None:
    """A first bearing may be far better than usual ones: that makes no ship silent."""
    stage = TmaTrackerStage(TmaTrackerConfiguration(target_height=-STATION[2]))
    for second, deviation in enumerate([np.radians(0.05), *[USUAL] * 60]):
        stamp = nanoseconds(1000.0 + second)
        azimuth, elevation = seen_from(STATION, ship(second)).tolist()
        one = reported("bottom", STATION, azimuth, elevation, float(deviation), stamp)
        tracks = stage.update(PassiveFrame(stamp, (one,))).tracks
    assert tracks is not None and tracks.status.tolist() == [TrackStatus.CONFIRMED]
    assert tracks.updated[0] == pytest.approx(1060.0)
