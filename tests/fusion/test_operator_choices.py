"""What an operator says about fused rows: an end that lasts, two rows that are one target."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sonar_tracking.errors import InputError
from sonar_tracking.fusion.track_fusion_stage import TrackFusionStage
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import PositionTracks
from tests.fusion.fusion_scene import ECHOES, FOUR, POSITIONS, Moment, Ships, moments
from tests.fusion.test_track_fusion_stage import AT_ONCE, both_sides

AT = 80.0
"""Time before which the operator says something, s."""

Say = Callable[[TrackFusionStage, PositionTracks], object]


def told(
    scene: Ships, say: Say, duration: float = 160.0, passive: int | None = None
) -> tuple[PositionTracks, list[PositionTracks]]:
    """Return the last list before an operator says something, and those after it."""
    stage, before, after = TrackFusionStage(AT_ONCE), None, []
    for moment in moments(scene, duration):
        frame = moment.frame
        if passive is not None:
            frame = replace(frame, passive={POSITIONS: both_sides(moment, passive)})
        if moment.time == AT:
            assert before is not None
            say(stage, before)
        tracks = stage.update(frame).tracks
        if moment.time < AT:
            before = tracks
        else:
            after.append(tracks)
    assert before is not None
    return before, after


def alive(tracks: PositionTracks) -> list[int]:
    return sorted(tracks.id[tracks.status != TrackStatus.TERMINATED].tolist())


def ended(tracks: PositionTracks) -> list[int]:
    return tracks.id[tracks.status == TrackStatus.TERMINATED].tolist()


def nearest(tracks: PositionTracks, ship: int) -> int:
    (last,) = [one for one in moments(Ships(FOUR), AT) if one.time == AT - 2.0]
    apart = np.linalg.norm(tracks.state[:, :2] - last.truth[ship, :2], axis=1)
    return int(tracks.id[np.argmin(apart)])


@pytest.mark.slow
def test_an_ended_row_does_not_come_back_from_the_same_tracks() -> None:
    before, after = told(Ships(FOUR), lambda stage, seen: stage.end_track(nearest(seen, 1)))
    gone = nearest(before, 1)
    assert ended(after[0]) == [gone]
    assert all(alive(one) == sorted(set(alive(before)) - {gone}) for one in after)


def test_an_ended_row_of_bearings_alone_is_one_side_only() -> None:
    silent = Ships(FOUR, silent_sonar=(0.0, 1e6))
    before, after = told(silent, lambda stage, seen: stage.end_track(int(seen.id[0])), passive=0)
    assert len(alive(before)) == 2
    assert all(alive(one) == alive(before)[1:] for one in after)


def twice(moment: Moment) -> Moment:
    """Return a moment in which the sonar has a second track of the first ship, 300 m astern."""
    if not moment.frame.active:
        return moment
    tracks = moment.frame.active[ECHOES]
    aside = tracks.selected(np.arange(len(tracks)) == 0)
    shift = np.array([-300.0, 0.0])
    state = aside.state.copy()
    state[:, :2] += shift
    other = replace(
        aside,
        id=np.array([150], np.uint64),
        state=state,
        measurement=aside.measurement + shift,
    )
    columns = ("id", "status", "source", "state", "covariance", "existence_probability")
    more = ("initiated", "updated", "measurement", "measurement_covariance")
    both: dict[str, Any] = {
        name: np.concatenate([getattr(tracks, name), getattr(other, name)])
        for name in (*columns, *more)
    }
    merged = PositionTracks(stamp=tracks.stamp, next_stamp=tracks.next_stamp, **both)
    return replace(moment, frame=replace(moment.frame, active={ECHOES: merged}))


@pytest.mark.slow
@pytest.mark.parametrize("first_goes_on", [True, False])
def test_two_rows_of_one_ship_become_one(first_goes_on: bool) -> None:
    stage, frames = TrackFusionStage(AT_ONCE), list(moments(Ships(FOUR), 300.0))
    for moment in frames[:40]:
        before = stage.update(twice(moment).frame).tracks
    assert len(alive(before)) == 5
    first, second = nearest(before, 0), max(alive(before))
    keep, drop = (first, second) if first_goes_on else (second, first)
    stage.merge_tracks(keep, drop)
    after = [stage.update(twice(moment).frame).tracks for moment in frames[40:]]
    assert ended(after[0]) == [drop]
    assert all(keep in alive(one) and len(alive(one)) == 4 for one in after)
    (row,) = np.flatnonzero(after[-1].id == keep)
    assert np.linalg.norm(after[-1].state[row, :2] - frames[-1].truth[0, :2]) < 400.0


@pytest.mark.slow
def test_when_one_of_its_tracks_ends_a_merged_row_goes_on_with_the_other() -> None:
    stage, frames = TrackFusionStage(AT_ONCE), list(moments(Ships(FOUR), 300.0))
    for moment in frames[:40]:
        before = stage.update(twice(moment).frame).tracks
    keep = nearest(before, 0)
    stage.merge_tracks(keep, max(alive(before)))
    for moment in frames[40:]:
        frame = twice(moment).frame
        if frame.active:
            left = frame.active[ECHOES].selected(frame.active[ECHOES].id != 101)
            frame = replace(frame, active={ECHOES: left})
        after = stage.update(frame).tracks
    assert keep in alive(after) and len(alive(after)) == 4


@pytest.mark.slow
def test_a_row_of_bearings_gives_them_to_the_target_it_is_merged_with() -> None:
    """Before the evidence is there: the bearings of the array begin only then."""

    def merge(stage: TrackFusionStage, seen: PositionTracks) -> None:
        heard = int(seen.id[seen.bearing_track_id == 201][0])
        stage.merge_tracks(nearest(seen.selected(seen.bearing_track_id != 201), 0), heard)

    scene = Ships(FOUR, silent_array=(0.0, AT - 4.0))
    stage, before, after = TrackFusionStage(AT_ONCE), None, []
    for moment in moments(scene, 160.0):
        frame = moment.frame
        if moment.time >= AT - 4.0:
            frame = replace(frame, passive={POSITIONS: both_sides(moment, 0)})
        if moment.time == AT:
            assert before is not None and len(alive(before)) == 6
            merge(stage, before)
        before = stage.update(frame).tracks
        if moment.time >= AT:
            after.append(before)
    # Both sides of the bearing track are of the target by now.
    assert all(len(alive(one)) == 4 for one in after)
    (row,) = np.flatnonzero(after[1].bearing_track_id == 201)
    assert after[1].id[row] == nearest(after[1], 0)


@pytest.mark.slow
def test_what_cannot_be_done_changes_nothing() -> None:
    def fail(stage: TrackFusionStage, seen: PositionTracks) -> None:
        known = alive(seen)[0]
        for action in (
            lambda: stage.end_track(99_999),
            lambda: stage.merge_tracks(known, 99_999),
            lambda: stage.merge_tracks(99_999, known),
            lambda: stage.end_track(0),
        ):
            with pytest.raises(InputError, match=r"own sensors have no track .*; there are"):
                action()

    _, after = told(Ships(FOUR), fail)
    _, untouched = told(Ships(FOUR), lambda stage, seen: None)
    for found, expected in zip(after, untouched, strict=True):
        assert np.array_equal(found.id, expected.id)
        assert np.array_equal(found.state, expected.state)
        assert np.array_equal(found.covariance, expected.covariance)
