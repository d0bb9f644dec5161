"""What an operator does to bearing tracks: it holds, is reported once, and harms no other track."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from sonar_tracking.errors import InputError
from sonar_tracking.geometry import steering_vectors
from sonar_tracking.passive.bearings.bearing_tracker_stage import (
    BearingTrackerConfiguration,
    BearingTrackerStage,
)
from sonar_tracking.passive.subspaces.subspace_stage import SubspaceConfiguration, SubspaceStage
from sonar_tracking.records.bearings import BearingTracks, SubspaceEstimates, TrackStatus
from tests.passive.crossing_scene import EPOCH, POSITIONS, WAVENUMBER, blocks_of, circular_noise

SOURCES_DEG = (-30.0, 20.0)
AT = 8
"""Estimate before which the operator does something."""


@cache
def estimates() -> tuple[SubspaceEstimates, ...]:
    """Return estimates of two sources at rest, two a second."""
    generator = np.random.default_rng(5)
    n_snapshots = 200 * 8
    vectors = steering_vectors(POSITIONS, np.deg2rad(SOURCES_DEG), WAVENUMBER)
    data = circular_noise(generator, n_snapshots, 2) @ vectors.T
    data += circular_noise(generator, n_snapshots, len(POSITIONS))
    stage = SubspaceStage(
        SubspaceConfiguration(n_subspaces=1, period=0.5, covariance_snapshots=100)
    )
    return tuple(e for block in blocks_of(data, 100, EPOCH) for e in stage.update(block).estimates)


def started(method: str = "joint_map", **changes: object) -> BearingTrackerStage:
    """Return a tracker that has seen the first estimates."""
    configuration = BearingTrackerConfiguration(method=method, **changes)  # type: ignore[arg-type]
    stage = BearingTrackerStage(configuration)
    for each in estimates()[:AT]:
        stage.update(each)
    return stage


def rest(stage: BearingTrackerStage) -> list[BearingTracks]:
    return [stage.update(each).tracks for each in estimates()[AT:]]


def names(tracks: BearingTracks) -> dict[int, float]:
    """Return the angles of what goes on, in degrees, by identifier."""
    rows = np.isin(tracks.status, (TrackStatus.CONFIRMED, TrackStatus.COASTED))
    degrees = np.rad2deg(tracks.arrival_angle[rows]).tolist()
    return dict(zip(tracks.id[rows].tolist(), degrees, strict=True))


def ended(tracks: BearingTracks) -> list[int]:
    return tracks.id[tracks.status == TrackStatus.TERMINATED].tolist()


def nearest(found: dict[int, float], angle: float) -> int:
    return min(found, key=lambda number: abs(found[number] - angle))


def test_an_ended_track_is_reported_once_and_its_source_gets_a_new_one() -> None:
    stage, untouched = started(), rest(started())
    before = names(untouched[0])
    stage.end_track(nearest(before, 20.0))
    after = rest(stage)
    gone = nearest(before, 20.0)
    assert [ended(each) for each in after] == [[gone]] + [[]] * (len(after) - 1)
    assert gone not in {number for each in after for number in names(each)}
    found = names(after[-1])
    assert found[nearest(before, -30.0)] == pytest.approx(-30.0, abs=1.0)
    assert found[nearest(found, 20.0)] == pytest.approx(20.0, abs=1.0)
    assert min(set(found) - set(before)) > max(before)


def test_a_started_track_holds_a_source_and_is_confirmed_at_once() -> None:
    stage = started()
    stage.end_track(nearest(names(rest(started())[0]), 20.0))
    stage.start_track(np.deg2rad(18.5))
    after = rest(stage)
    new = nearest(names(after[0]), 20.0)
    assert abs(names(after[-1])[new] - 20.0) < 1.0
    assert len(names(after[-1])) == 2


def test_a_track_that_is_started_where_nothing_is_ends_and_harms_no_other() -> None:
    stage = started()
    stage.start_track(np.deg2rad(60.0))
    after = rest(stage)
    assert len(names(after[0])) == 3
    found = names(after[-1])
    assert found[nearest(found, 20.0)] == pytest.approx(20.0, abs=1.0)
    assert found[nearest(found, -30.0)] == pytest.approx(-30.0, abs=1.0)


@pytest.mark.parametrize("method", ["joint_map", "ml_fusion"])
def test_of_two_that_are_merged_the_first_name_goes_on(method: str) -> None:
    angles = {} if method == "joint_map" else {"start": "given", "process_noise_deg2": 0.01}
    if angles:
        angles |= {"initial_bearings_deg": SOURCES_DEG, "initial_rates_deg": (0.0, 0.0)}
    before = names(rest(started(method, **angles))[0])
    first, second = nearest(before, -30.0), nearest(before, 20.0)
    stage = started(method, **angles)
    stage.merge_tracks(second, first)
    after = rest(stage)
    assert ended(after[0]) == [first]
    assert second in names(after[0]) and first not in names(after[0])
    assert all(first not in names(each) for each in after)


def test_what_cannot_be_done_changes_nothing() -> None:
    empty, stage, untouched = (
        BearingTrackerStage(BearingTrackerConfiguration()),
        started(),
        started(),
    )
    with pytest.raises(InputError, match="no data have come yet"):
        empty.start_track(0.1)
    for angle, words in ((np.nan, "between -pi and pi"), (np.deg2rad(20.3), "within 1 degree")):
        with pytest.raises(InputError, match=words):
            stage.start_track(float(angle))
    for number in (0, 99):
        with pytest.raises(InputError, match=f"no bearing track {number} runs; there are"):
            stage.end_track(number)
    known = min(names(rest(started())[0]))
    with pytest.raises(InputError, match="no bearing track 99"):
        stage.merge_tracks(known, 99)
    with pytest.raises(InputError, match="no bearing track 99"):
        stage.merge_tracks(99, known)
    for found, expected in zip(rest(stage), rest(untouched), strict=True):
        assert np.array_equal(found.id, expected.id)
        assert np.array_equal(found.arrival_angle, expected.arrival_angle)
        assert np.array_equal(found.covariance, expected.covariance)


def test_no_more_tracks_are_started_than_the_array_can_tell_apart() -> None:
    stage = started()
    with pytest.raises(InputError, match="the most here; end one first"):
        for angle in np.linspace(-1.4, 1.4, 40):
            try:
                stage.start_track(float(angle))
            except InputError as error:
                if "within" not in str(error):
                    raise
    assert len(names(rest(stage)[0])) == len(POSITIONS) - 1
