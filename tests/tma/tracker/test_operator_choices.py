"""What an operator says about targets: a side, an end, own ship's lines."""

from __future__ import annotations

import pickle
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from sonar_tracking.errors import InputError
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.commands import OwnShipLine
from sonar_tracking.records.positions import PositionTracks, TrackHypothesis
from sonar_tracking.tma.targets.passive_frame import PassiveFrame
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration
from sonar_tracking.tma.tracker.tma_tracker_stage import TmaTrackerStage
from tests.tma.passive_scene import STRAIGHT, fed, frames_of, listed, running, scene

AT = 30
"""Frame before which the operator says something."""


@cache
def frames() -> tuple[PassiveFrame, ...]:
    """Return frames of an array that goes straight: its sides stay open."""
    return tuple(frames_of(scene(own_ship=STRAIGHT, duration=100.0)))


@cache
def _kept(method: str) -> tuple[bytes, PositionTracks]:
    """Return a stage that has seen some frames, pickled, and its last list."""
    stage = TmaTrackerStage(TmaTrackerConfiguration(method=method))
    last = listed(fed(stage, frames()[:AT])[-1])
    return pickle.dumps(stage), last


def started(method: str = "range_bank") -> tuple[TmaTrackerStage, PositionTracks]:
    """Return a stage that has seen some frames, and its last list."""
    kept, last = _kept(method)
    return pickle.loads(kept), last


def row_of(tracks: PositionTracks, side: TrackHypothesis) -> int:
    return int(tracks.id[tracks.hypothesis == side][0])


def rest(stage: TmaTrackerStage) -> list[PositionTracks]:
    return [listed(one) for one in fed(stage, frames()[AT:])]


@cache
def untouched(method: str) -> list[PositionTracks]:
    """Return what a stage says that an operator leaves alone."""
    return rest(started(method)[0])


@pytest.mark.slow
@pytest.mark.parametrize("method", ["range_bank", "fused_line"])
@pytest.mark.parametrize(
    ("chosen", "lost"),
    [
        (TrackHypothesis.LEFT, TrackHypothesis.RIGHT),
        (TrackHypothesis.RIGHT, TrackHypothesis.LEFT),
    ],
)
def test_the_chosen_side_goes_on_alone_as_it_was(
    method: str, chosen: TrackHypothesis, lost: TrackHypothesis
) -> None:
    stage, before = started(method)
    stage.choose_side(row_of(before, lost), chosen.name.lower())
    after = rest(stage)
    (gone,) = np.flatnonzero(after[0].status == TrackStatus.TERMINATED)
    assert after[0].id[gone] == row_of(before, lost)
    for found, expected in zip(after, untouched(method), strict=True):
        (state,), (covariance,) = running(found).state, running(found).covariance
        assert running(found).hypothesis.tolist() == [chosen]
        assert running(found).hypothesis_probability == pytest.approx([1.0])
        apart = state - expected.state[expected.hypothesis == chosen][0]
        # One side is split and pruned by itself: the same but for what is far below a deviation.
        assert apart @ np.linalg.solve(covariance, apart) < 0.25


def test_a_side_that_is_not_open_is_not_chosen() -> None:
    stage, before = started()
    with pytest.raises(InputError, match="there is no track 77; there are"):
        stage.choose_side(77, "left")
    left = row_of(before, TrackHypothesis.LEFT)
    stage.choose_side(left, "left")
    with pytest.raises(InputError, match=f"side of track {left} is not open; it is left"):
        stage.choose_side(left, "right")


@pytest.mark.slow
def test_an_ended_target_does_not_come_back_from_the_same_bearing_track() -> None:
    stage, before = started()
    stage.end_track(int(before.id[0]))
    after = rest(stage)
    assert set(after[0].status) == {TrackStatus.TERMINATED}
    assert sorted(after[0].id) == sorted(before.id)
    assert all(len(one) == 0 for one in after[1:])
    with pytest.raises(InputError, match="there are none"):
        stage.end_track(int(before.id[0]))
    stage.reset()
    assert len(running(listed(fed(stage, frames()[:AT])[-1]))) == 2


@pytest.mark.slow
def test_marked_lines_are_not_used_until_they_are_unmarked() -> None:
    stage, _ = started()
    stage.mark_own_ship_line(OwnShipLine(210.0, 5.0))
    spoilt = [
        replace(frame, lines=tuple(_without(one, 210.0) for one in frame.lines))
        for frame in frames()[AT:]
    ]
    without = [listed(one) for one in fed(started()[0], spoilt)]
    for found, expected in zip(rest(stage), without, strict=True):
        assert np.array_equal(found.state, expected.state)
    with pytest.raises(InputError, match="no line of own ship is marked at 300 Hz; marked are 210"):
        stage.unmark_own_ship_line(OwnShipLine(300.0))
    stage.unmark_own_ship_line(OwnShipLine(211.0))
    again, _ = started()
    again.mark_own_ship_line(OwnShipLine(210.0, 5.0, "array"))
    again.unmark_own_ship_line(OwnShipLine(211.0))
    for found, expected in zip(rest(again), untouched("range_bank"), strict=True):
        assert np.array_equal(found.state, expected.state)


def _without(lines, frequency):  # type: ignore[no-untyped-def]
    return lines.without((np.abs(lines.frequency - frequency) < 2.5).tolist())


def test_a_mark_is_of_its_sensor_and_its_band() -> None:
    mark = OwnShipLine(50.0, 2.0, "array")
    assert mark.holds(51.0, "array") and mark.holds(49.0, "array")
    assert not mark.holds(51.1, "array") and not mark.holds(50.0, "buoy")
    assert OwnShipLine(50.0).holds(50.5, "buoy") and not OwnShipLine(50.0).holds(50.6, "buoy")
