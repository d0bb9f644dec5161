"""Protects ``sonar-tracking smooth``: a bag with everything that was, and smoothed tracks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.bags.storage.bag_records import POSITION_TRACKS_TYPE, position_tracks_of
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.bags.storage.writer import BagWriter
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.evaluation.offline.smoothed_bag import smooth_bag
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import PositionTracks, TrackSource
from tests.bags.position_fixtures import position_tracks_cdr

SECOND = 10**9


def picture(number: int, source: TrackSource) -> PositionTracks:
    error = np.append(np.random.default_rng(number).normal(size=2), [0.0, 0.0])
    return PositionTracks(
        stamp=(number + 1) * SECOND,
        id=np.array([3], np.uint64),
        status=np.array([TrackStatus.CONFIRMED], np.uint8),
        source=np.array([source], np.uint8),
        state=np.array([[5.0 * number, 0.0, 5.0, 0.0]]) + error,
        covariance=np.diag([1.0, 1.0, 1e-4, 1e-4])[None],
        bearing_track_id=np.array([12], np.uint64),
        line_track=np.array([0], np.uint32),
        line_id=np.array([4], np.uint64),
        line_frequency=np.array([210.0]),
        contributor_track=np.array([0], np.uint32),
        contributor_sensor=("array",),
    )


def recorded(path: Path, source: TrackSource = TrackSource.TMA) -> Path:
    writer = BagWriter(path)
    writer.add_topic("/passive/tracks", POSITION_TRACKS_TYPE)
    for number in range(20):
        data = position_tracks_cdr(picture(number, source))
        writer.write("/passive/tracks", (number + 1) * SECOND, data)
    writer.close()
    return path


def test_the_new_bag_holds_what_was_and_the_same_tracks_smoothed(tmp_path: Path) -> None:
    bag = recorded(tmp_path / "bag")
    said = smooth_bag(bag, None, 0.01)
    assert said == f"{tmp_path / 'bag_smoothed'}: 1 tracks in /passive/tracks_smoothed."
    made = read_bag(tmp_path / "bag_smoothed")
    assert list(made.topics) == ["/passive/tracks", "/passive/tracks_smoothed"]
    before = list(position_tracks_of(read_bag(bag), "/passive/tracks"))
    kept = list(position_tracks_of(made, "/passive/tracks"))
    after = list(position_tracks_of(made, "/passive/tracks_smoothed"))
    assert [one.state.tolist() for one in kept] == [one.state.tolist() for one in before]
    for old, new in zip(before, after, strict=True):
        assert new.stamp == old.stamp and new.id.tolist() == [3]
        assert new.source.tolist() == [TrackSource.SMOOTHED]
        assert new.contributor_sensor == ("array",) and new.line_frequency.tolist() == [210.0]
        assert new.bearing_track_id.tolist() == [12]
    spread = [np.std([one.state[0, 1] for one in pictures]) for pictures in (before, after)]
    assert spread[1] < 0.5 * spread[0]


def test_what_cannot_be_smoothed_is_refused_in_words(tmp_path: Path) -> None:
    active = recorded(tmp_path / "active", TrackSource.ACTIVE)
    with pytest.raises(ConfigurationError, match="no tracks of target motion analysis"):
        smooth_bag(active, None, 0.01)
    assert not (tmp_path / "active_smoothed").exists()
    bag = recorded(tmp_path / "bag")
    smooth_bag(bag, tmp_path / "once", 0.01)
    with pytest.raises(ConfigurationError, match="smooth the bag it was made from"):
        smooth_bag(tmp_path / "once", tmp_path / "twice", 0.01)
    with pytest.raises(ConfigurationError, match="exists already"):
        smooth_bag(bag, tmp_path / "once", 0.01)
