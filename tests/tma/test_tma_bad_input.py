"""Protects the stage from what real data do: gaps, swaps, outliers, nonsense; it goes on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sonar_tracking.errors import Severity
from sonar_tracking.motion import KinematicState
from sonar_tracking.records.bearings import BearingTracks
from sonar_tracking.records.positions import PositionTracks
from sonar_tracking.simulation.scenarios.kinematic_motion import KinematicMotion
from sonar_tracking.simulation.scenarios.platforms import TurnConfiguration
from sonar_tracking.simulation.scenarios.target import LineConfiguration
from sonar_tracking.simulation.sensors.bearing_simulation import SimulatedFrame
from sonar_tracking.tma.targets.passive_frame import PassiveFrame, TmaUpdate
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration
from sonar_tracking.tma.tracker.tma_tracker_stage import TmaTrackerStage
from tests.tma.passive_scene import (
    ARRAY,
    DIRECTIONS,
    LINES,
    NEAR,
    error_of,
    fed,
    frames_of,
    listed,
    one_value,
    running,
    scene,
    simulated,
    with_bearings,
    without_pose,
)


def finite(tracks: PositionTracks) -> bool:
    return bool(np.isfinite(tracks.state).all() and np.isfinite(tracks.covariance).all())


def last_error(changes: Callable[[PassiveFrame, int], PassiveFrame], **world: Any) -> float:
    """Feed changed frames and return the final position error, m."""
    frames = simulated(scene(DIRECTIONS, **world))
    stage = TmaTrackerStage()
    for index, (frame, _) in enumerate(frames):
        update = stage.update(changes(frame, index))
        assert finite(listed(update))
    return error_of(listed(update), frames[-1][1])


@pytest.mark.slow
def test_all_lines_may_vanish_and_others_come() -> None:
    early = tuple(replace(line, present=(0.0, 120.0)) for line in LINES)
    late = (LineConfiguration(225.0, present=(160.0, 250.0)),)
    target = replace(NEAR, lines=early + late)
    assert last_error(lambda frame, _: frame, targets=(target,)) < 150.0


@pytest.mark.slow
def test_a_line_that_becomes_another_source_does_no_harm() -> None:
    """Line 1 keeps its name and is 5 Hz off from frame 150 on: not the target's any more."""

    def swapped(frame: PassiveFrame, index: int) -> PassiveFrame:
        (lines,) = frame.lines
        frequency = lines.frequency.copy()
        frequency[0] = 215.0 if index >= 150 else frequency[0]
        return replace(frame, lines=(replace(lines, frequency=frequency),))

    assert last_error(swapped) < 150.0


@pytest.mark.slow
def test_bearings_cross_0_and_360_degrees_unnoticed() -> None:
    """The target passes due west, where azimuths jump from pi to -pi."""
    west = replace(
        NEAR, motion=KinematicMotion(position=(-4000.0, 900.0), course_deg=180.0, speed=6.0)
    )
    frames = frames_of(scene(DIRECTIONS, targets=(west,)))
    signs = {float(np.sign(frame.bearings[0].measurement[0])) for frame in frames}
    assert signs == {-1.0, 1.0}
    assert last_error(lambda frame, _: frame, targets=(west,)) < 200.0


@pytest.mark.slow
def test_wild_bearings_and_frequencies_are_gated() -> None:
    wild = replace(DIRECTIONS, outlier_share=0.05, line_outlier_share=0.05)
    errors = []
    for sensor in (DIRECTIONS, wild):
        frames = simulated(scene(sensor))
        update = fed(TmaTrackerStage(), [frame for frame, _ in frames])[-1]
        errors.append(error_of(listed(update), frames[-1][1]))
    assert errors[1] < max(150.0, 2.0 * errors[0])


@pytest.mark.slow
def test_frames_may_come_at_any_interval() -> None:
    """Frames are dropped at random: intervals are 1 to several seconds."""
    frames = simulated(scene(replace(DIRECTIONS, missing_share=0.5)))
    intervals = np.diff([frame.stamp for frame, _ in frames])
    assert intervals.max() >= 3 * intervals.min()
    update = fed(TmaTrackerStage(), [frame for frame, _ in frames])[-1]
    assert error_of(listed(update), frames[-1][1]) < 200.0


@pytest.mark.parametrize(
    ("column", "value"),
    [
        ("measurement_variance", -1.0),
        ("measurement_variance", 0.0),
        ("measurement_variance", np.nan),
        ("measurement", np.inf),
        ("measurement", 1e6),
    ],
)
def test_a_bearing_that_makes_no_sense_is_left_out_with_a_notice(column: str, value: float) -> None:
    frames = frames_of(scene(DIRECTIONS, duration=30.0))
    stage = TmaTrackerStage()
    fed(stage, frames[:10])
    bad = with_bearings(
        frames[10], **{column: one_value(getattr(frames[10].bearings[0], column), value)}
    )
    update = stage.update(replace(bad, lines=()))
    assert [notice.severity for notice in update.notices] == [Severity.WARN]
    assert "array" in update.notices[0].text and "track 1" in update.notices[0].text
    assert finite(listed(update))
    assert listed(update).updated[0] == frames[9].stamp / 1e9
    assert not stage.update(frames[11]).notices


def test_a_missing_bearing_is_no_mistake() -> None:
    frames = frames_of(scene(DIRECTIONS, duration=30.0))
    stage = TmaTrackerStage()
    fed(stage, frames[:10])
    coasted = with_bearings(frames[10], measurement=np.array([np.nan]))
    assert not stage.update(coasted).notices


def test_bearings_without_a_variance_may_be_given_one() -> None:
    stage = TmaTrackerStage(TmaTrackerConfiguration(azimuth_deviation_deg=0.5))
    unknown = np.array([np.nan])
    frames = [
        with_bearings(frame, measurement_variance=unknown)
        for frame in frames_of(scene(DIRECTIONS, duration=10.0))
    ]
    updates = fed(stage, frames)
    assert len(listed(updates[-1])) == 1 and not any(update.notices for update in updates)


@pytest.mark.parametrize("column", ["frequency", "standard_deviation"])
@pytest.mark.parametrize("value", [np.nan, -1.0, 0.0, np.inf])
def test_a_line_that_makes_no_sense_is_left_out_with_a_notice(column: str, value: float) -> None:
    frames = frames_of(scene(DIRECTIONS, duration=20.0))
    stage = TmaTrackerStage()
    fed(stage, frames[:10])
    (lines,) = frames[10].lines
    changes: dict[str, Any] = {column: one_value(getattr(lines, column), value)}
    bad = replace(lines, **changes)
    update = stage.update(replace(frames[10], lines=(bad,)))
    assert ["line 1" in notice.text for notice in update.notices] == [True]
    assert finite(listed(update))
    assert listed(update).line_id.tolist() == [1, 2, 3]


def test_a_line_or_track_told_twice_is_used_once() -> None:
    frames = frames_of(scene(DIRECTIONS, duration=20.0))
    stage = TmaTrackerStage()
    (lines,) = frames[0].lines
    twice = replace(lines, line_id=np.array([1, 1, 2], np.uint64))
    update = stage.update(replace(frames[0], lines=(twice,)))
    assert any("appears twice" in notice.text for notice in update.notices)
    (bearings,) = frames[1].bearings
    update = stage.update(replace(frames[1], bearings=(doubled(bearings),)))
    assert any("appears twice" in notice.text for notice in update.notices)
    assert len(listed(update)) == 1


def doubled(bearings: BearingTracks) -> BearingTracks:
    """Return a list with its only row twice."""
    columns: dict[str, Any] = {
        name: np.repeat(value, 2, axis=0)
        for name, value in vars(bearings).items()
        if isinstance(value, np.ndarray) and value.size
    }
    return replace(bearings, **columns)


def test_more_lines_than_can_be_followed_are_thinned_out() -> None:
    many = tuple(LineConfiguration(100.0 + 10.0 * n) for n in range(40))
    updates = fed(
        TmaTrackerStage(),
        frames_of(scene(DIRECTIONS, targets=(replace(NEAR, lines=many),), duration=10.0)),
    )
    assert not any(update.notices for update in updates)
    assert listed(updates[-1]).line_id.tolist() == list(range(25, 41))


def with_own_ship(frame: PassiveFrame, known: bool, truth: SimulatedFrame) -> PassiveFrame:
    """Return a frame without lines that does not tell its pose, and own ship's if known."""
    state = truth.own_ship
    heading = np.array([np.cos(state.yaw), np.sin(state.yaw)])
    motion = KinematicState(
        position=np.array(state.position),
        velocity=state.velocity[0] * heading,
        azimuth=np.array(state.yaw),
        turn_rate=np.array(state.yaw_rate),
    )
    (bearings,) = frame.bearings
    return replace(
        frame, bearings=(without_pose(bearings),), lines=(), own_ship=motion if known else None
    )


@pytest.mark.slow
def test_own_ship_tells_where_the_array_is_if_the_data_do_not() -> None:
    frames = simulated(scene(duration=130.0))
    told, found = TmaTrackerStage(), TmaTrackerStage()
    for frame, truth in frames:
        one = listed(told.update(replace(frame, lines=())))
        other = listed(found.update(with_own_ship(frame, True, truth)))
    assert other.state == pytest.approx(one.state, rel=1e-6)


def test_without_any_pose_the_targets_coast_and_it_is_said() -> None:
    frames = simulated(scene(duration=40.0))
    stage = TmaTrackerStage()
    for frame, truth in frames[:20]:
        before = listed(stage.update(with_own_ship(frame, True, truth)))
    for frame, truth in frames[20:35]:
        update = stage.update(with_own_ship(frame, False, truth))
        assert [notice.severity for notice in update.notices] == [Severity.ERROR]
        assert "own_ship/odometry" in update.notices[0].text
        assert listed(update).id.tolist() == before.id.tolist()
    assert listed(update).updated.tolist() == [frames[19][0].stamp / 1e9] * 2
    frame, truth = frames[35]
    assert not stage.update(with_own_ship(frame, True, truth)).notices


def test_while_own_ship_turns_a_towed_array_starts_nothing() -> None:
    frames = simulated(scene(duration=130.0))
    stage = TmaTrackerStage(TmaTrackerConfiguration(array_lag=10.0))
    first = [with_own_ship(frame, True, truth) for frame, truth in frames]
    assert len(listed(stage.update(first[105]))) == 0
    assert len(running(listed(stage.update(first[125])))) == 2


@pytest.mark.slow
def test_a_manoeuvre_of_the_target_is_followed() -> None:
    motion = KinematicMotion(
        position=(4000.0, 3000.0),
        course_deg=270.0,
        speed=3.0,
        turns=(TurnConfiguration(150.0, 330.0, 3.0),),
    )
    turning = replace(NEAR, motion=motion)
    assert last_error(lambda frame, _: frame, targets=(turning,), duration=300.0) < 250.0


def test_nothing_at_all_is_an_empty_list() -> None:
    frames = frames_of(scene(ARRAY, targets=(), duration=5.0))
    updates: list[TmaUpdate] = fed(TmaTrackerStage(), frames)
    assert [len(listed(update)) for update in updates] == [0] * 5
