"""Protects that tracks are named whose contacts may be taken for each other's, and no others."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from sonar_tracking.active.lasting_error import ClaimedError
from sonar_tracking.active.unresolved_tracks import unresolved_tracks
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import PositionTracks, TrackSource

NORTH = 5000.0
SENSOR = ClaimedError((100.0, 0.0), range_standard_deviation=10.0, azimuth_standard_deviation=0.01)
"""A contact 5 km north is known by 50 m across and 10 m along the line of sight."""


def picture(places: list[tuple[float, float]], deviation: float = 0.0) -> PositionTracks:
    """Return tracks 11, 12, ... at places about 5 km north of the sensor, m."""
    state = np.zeros((len(places), 4))
    state[:, :2] = np.array(places).reshape(-1, 2) + np.array([SENSOR.position[0], NORTH])
    n = len(places)
    return PositionTracks(
        stamp=1,
        id=np.arange(11, 11 + n, dtype=np.uint64),
        status=np.full(n, TrackStatus.CONFIRMED, np.uint8),
        source=np.full(n, TrackSource.ACTIVE, np.uint8),
        state=state,
        covariance=np.tile(np.diag([deviation**2, deviation**2, 1.0, 1.0]), (n, 1, 1)),
    )


@pytest.mark.parametrize(
    ("offset", "deviation", "is_named"),
    [
        ((198.0, 0.0), 0.0, True),
        ((202.0, 0.0), 0.0, False),
        ((0.0, 39.0), 0.0, True),
        ((0.0, 41.0), 0.0, False),
        # The track itself is known by 50 m: a contact is predicted within 71 m across.
        ((281.0, 0.0), 50.0, True),
        ((285.0, 0.0), 50.0, False),
    ],
)
def test_four_deviations_of_a_predicted_contact_are_the_limit(
    offset: tuple[float, float], deviation: float, is_named: bool
) -> None:
    x, y = offset
    tracks = picture([(-0.5 * x, 0.0), (0.5 * x, y)], deviation)
    assert unresolved_tracks(tracks, SENSOR) == ({11: (12,), 12: (11,)} if is_named else {})


def test_every_pair_of_a_crowd_is_looked_at() -> None:
    places = np.random.default_rng(3).uniform(-600.0, 600.0, (40, 2))
    found = unresolved_tracks(picture(list(map(tuple, places))), SENSOR)
    named = {(a, b) for a, others in found.items() for b in others if a < b}
    alone = {
        (11 + a, 11 + b)
        for a, b in combinations(range(len(places)), 2)
        if unresolved_tracks(picture([tuple(places[a]), tuple(places[b])]), SENSOR)
    }
    assert named == alone
    assert 0 < len(named) < 200


def test_what_is_fixed_is_told_apart_from_what_is_fixed_alone() -> None:
    tracks = picture([(0.0, 0.0), (50.0, 0.0), (100.0, 0.0)])
    tracks.source[:2] = TrackSource.STATIC
    assert unresolved_tracks(tracks, SENSOR) == {11: (13,), 12: (13,), 13: (11, 12)}
    tracks.source[2] = TrackSource.STATIC
    assert unresolved_tracks(tracks, SENSOR) == {}


def test_candidates_and_what_has_ended_are_left_out() -> None:
    tracks = picture([(0.0, 0.0), (50.0, 0.0), (100.0, 0.0)])
    tracks.status[:] = (TrackStatus.TENTATIVE, TrackStatus.COASTED, TrackStatus.TERMINATED)
    assert unresolved_tracks(tracks, SENSOR) == {}
    assert unresolved_tracks(picture([]), SENSOR) == {}
