"""Protects the stage of target motion analysis: births, sides, ends, identities, stations."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.errors import ConfigurationError, InputError
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import TrackHypothesis, TrackSource
from sonar_tracking.records.time import END_OF_DATA
from sonar_tracking.simulation.scenarios.bearing_sensor_configuration import (
    BearingSensorConfiguration,
)
from sonar_tracking.tma.targets.passive_frame import PassiveFrame, UnusableBearings
from sonar_tracking.tma.targets.tma_method_registry import TMA_METHODS
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration
from sonar_tracking.tma.tracker.tma_tracker_stage import TmaTrackerStage
from tests.tma.passive_scene import (
    ARRAY,
    DIRECTIONS,
    FAR,
    NEAR,
    SECOND,
    STRAIGHT,
    consistency,
    error_of,
    fed,
    frames_of,
    listed,
    running,
    scene,
    simulated,
)


@pytest.mark.slow
def test_a_target_is_found_and_its_side_resolved_by_own_ship_s_turn() -> None:
    stage = TmaTrackerStage()
    ended = []
    frames = simulated(scene())
    for index, (frame, _) in enumerate(frames):
        tracks = listed(stage.update(frame))
        assert (tracks.stamp, tracks.next_stamp) == (frame.stamp, frame.bearings[0].next_stamp)
        assert set(tracks.bearing_track_id) == {1}
        rows = running(tracks)
        if index < 100:
            assert rows.hypothesis.tolist() == [TrackHypothesis.LEFT, TrackHypothesis.RIGHT]
            assert rows.hypothesis_probability.sum() == pytest.approx(1.0)
            assert set(rows.status) == {TrackStatus.TENTATIVE}
            assert rows.id.tolist() == [1, 2]
        ended += tracks.id[tracks.status == TrackStatus.TERMINATED].tolist()
    assert ended == [2]
    assert rows.id.tolist() == [1] and rows.hypothesis_probability[0] > 0.99
    assert rows.status[0] == TrackStatus.CONFIRMED
    assert rows.source[0] == TrackSource.TMA
    assert error_of(tracks, frames[-1][1]) < 150.0
    assert consistency(tracks, frames[-1][1], 0, 0) < 20.0
    assert rows.line_id.tolist() == [1, 2, 3]
    assert rows.line_frequency == pytest.approx([210.0, 300.0, 350.0], abs=0.5)
    assert rows.contributor_sensor == ("array",) and rows.contributor_id.tolist() == [1]
    assert tracks.next_stamp == END_OF_DATA


@pytest.mark.slow
def test_what_is_not_observable_stays_tentative() -> None:
    silent = replace(NEAR, lines=())
    stage = TmaTrackerStage()
    updates = fed(stage, frames_of(scene(DIRECTIONS, own_ship=STRAIGHT, targets=(silent,))))
    tracks = listed(updates[-1])
    assert tracks.status.tolist() == [TrackStatus.TENTATIVE]
    assert tracks.observability[0] < 0.5
    assert np.sqrt(np.trace(tracks.covariance[0, :2, :2])) > 500.0


def test_a_bearing_track_that_ends_ends_its_target_and_a_new_one_is_a_new_target() -> None:
    present = replace(NEAR, present=(0.0, 20.0, 30.0, 60.0))
    stage = TmaTrackerStage(TmaTrackerConfiguration(first_id=100))
    updates = fed(stage, frames_of(scene(DIRECTIONS, targets=(present,), duration=60.0)))
    rows = [[*zip(listed(u).id, listed(u).status, strict=True)] for u in updates]
    assert rows[19] == [(100, TrackStatus.TENTATIVE)]
    assert rows[20] == [(100, TrackStatus.TERMINATED)]
    assert all(row == [] for row in rows[21:30])
    assert rows[30][0][0] == 101
    assert listed(updates[-1]).bearing_track_id.tolist() == [2]


@pytest.mark.slow
def test_a_track_may_outlive_its_bearing_track_and_be_taken_up_again() -> None:
    present = replace(NEAR, present=(0.0, 160.0, 190.0, 250.0))
    stage = TmaTrackerStage(TmaTrackerConfiguration(coast_duration=60.0))
    frames = simulated(scene(DIRECTIONS, targets=(present,)))
    updates = [stage.update(frame) for frame, _ in frames]
    assert listed(updates[180]).status.tolist() == [TrackStatus.COASTED]
    assert running(listed(updates[-1])).id.tolist() == [1]
    assert listed(updates[-1]).bearing_track_id.tolist() == [2]
    assert error_of(listed(updates[-1]), frames[-1][1]) < 200.0


def test_identities_go_on_after_a_reset() -> None:
    frames = frames_of(scene(DIRECTIONS, duration=5.0))
    stage = TmaTrackerStage()
    fed(stage, frames)
    stage.reset()
    assert listed(stage.update(frames[0])).id.tolist() == [2]


def test_frames_must_be_in_order() -> None:
    frames = frames_of(scene(duration=5.0))
    stage = TmaTrackerStage()
    stage.update(frames[2])
    for frame in (frames[1], frames[2]):
        with pytest.raises(InputError, match="not later"):
            stage.update(frame)
    assert len(listed(stage.update(frames[3]))) == 2


@pytest.mark.slow
def test_lines_without_bearings_are_used_and_give_no_list() -> None:
    frames = frames_of(scene(DIRECTIONS))
    whole, split = TmaTrackerStage(), TmaTrackerStage()
    for frame in frames:
        together = listed(whole.update(frame))
        apart = listed(split.update(replace(frame, lines=())))
        later = tuple(replace(one, stamp=one.stamp + SECOND // 2) for one in frame.lines)
        assert split.update(PassiveFrame(frame.stamp + SECOND // 2, lines=later)).tracks is None
    assert apart.line_id.tolist() == together.line_id.tolist()
    assert np.hypot(*(apart.state[0, :2] - together.state[0, :2])) < 100.0


@pytest.mark.slow
def test_lines_without_a_track_are_attributed_by_their_angle() -> None:
    sensor = replace(ARRAY, attribute_lines=False)
    stage = TmaTrackerStage()
    updates = fed(stage, frames_of(scene(sensor, targets=(NEAR, FAR), duration=150.0)))
    tracks = listed(updates[-1])
    lines: dict[int, set[int]] = {int(n): set() for n in tracks.bearing_track_id}
    for row, line in zip(tracks.line_track, tracks.line_id, strict=True):
        lines[int(tracks.bearing_track_id[row])].add(int(line))
    assert lines == {1: {1, 2, 3}, 2: {4, 5}}


@pytest.mark.slow
def test_bearings_of_two_stations_become_one_solution() -> None:
    buoy = BearingSensorConfiguration(
        sensor_id="buoy",
        namespace="buoy",
        platform="fixed",
        position=(6000.0, 0.0),
        angle_kind="azimuth",
        frame_interval=2.0,
    )
    frames = simulated(scene(ARRAY, buoy, targets=(NEAR, FAR), duration=160.0))
    stage = TmaTrackerStage(n_stations=2)
    ended: list[int] = []
    for frame, _ in frames:
        tracks = listed(stage.update(frame))
        ended += tracks.id[tracks.status == TrackStatus.TERMINATED].tolist()
    rows = running(tracks)
    assert len(rows) == 2
    assert len(set(ended)) == len(ended)
    for row in range(2):
        own = rows.contributor_track == row
        sensors = np.array(rows.contributor_sensor)[own].tolist()
        assert sensors == ["array", "buoy"]
        assert len(set(rows.contributor_id[own])) == 1
        target = int(rows.contributor_id[own][0]) - 1
        truth = frames[-1][1]
        error = rows.state[row, :2] - truth.truth_tracks.position[target]
        assert np.hypot(*error) < 100.0
        assert consistency(rows, truth, row, target) < 25.0
    assert set(rows.status) == {TrackStatus.CONFIRMED}


def test_the_watermark_is_unknown_until_every_station_has_reported() -> None:
    frames = frames_of(scene(duration=5.0))
    stage = TmaTrackerStage(n_stations=2)
    assert [listed(update).next_stamp for update in fed(stage, frames)] == [0] * 5


@pytest.mark.parametrize(("bow", "stern", "told"), [(7, 9, 7), (9, 7, 7), (9, 5, 0), (9, 4, 0)])
def test_the_watermark_is_that_of_the_station_that_may_report_first(
    bow: int, stern: int, told: int
) -> None:
    """At 5 s; one that may report at 5 s again or has reported no more tells nothing."""
    stage = TmaTrackerStage(n_stations=2)
    frame = PassiveFrame(
        5 * SECOND,
        unusable=(
            UnusableBearings("bow", bow * SECOND),
            UnusableBearings("stern", stern * SECOND),
        ),
    )
    assert listed(stage.update(frame)).next_stamp == told * SECOND


def test_an_unusable_list_coasts_the_targets() -> None:
    frames = frames_of(scene(DIRECTIONS, duration=30.0))
    stage = TmaTrackerStage()
    before = listed(fed(stage, frames[:20])[-1])
    stamp, following = frames[20].stamp, frames[21].stamp
    lost = PassiveFrame(stamp, unusable=(UnusableBearings("array", following),))
    coasted = listed(stage.update(lost))
    assert coasted.id.tolist() == before.id.tolist()
    assert (coasted.stamp, coasted.next_stamp) == (stamp, following)
    expected = before.state[0, :2] + before.state[0, 2:]
    assert coasted.state[0, :2] == pytest.approx(expected)
    velocity = np.trace(before.covariance[0, 2:, 2:])
    assert np.trace(coasted.covariance[0, 2:, 2:]) > velocity


@pytest.mark.slow
@pytest.mark.parametrize(
    "method", [entry.name for entry in TMA_METHODS if not entry.weighs_hypotheses]
)
def test_methods_for_comparison_can_be_chosen(method: str) -> None:
    stage = TmaTrackerStage(TmaTrackerConfiguration(method=method))
    updates = fed(stage, frames_of(scene(duration=140.0)))
    tracks = listed(updates[-1])
    assert tracks.hypothesis_probability.tolist() == [0.5, 0.5]
    assert np.all(np.isfinite(tracks.state))


@pytest.mark.slow
def test_the_same_data_give_the_same_tracks() -> None:
    frames = frames_of(scene(duration=120.0))
    first, second = (fed(TmaTrackerStage(), frames) for _ in range(2))
    for one, other in zip(first, second, strict=True):
        assert listed(one).state.tobytes() == listed(other).state.tobytes()


def test_parameters_that_do_not_fit_are_refused() -> None:
    with pytest.raises(ConfigurationError, match="minimum_range"):
        TmaTrackerStage(TmaTrackerConfiguration(minimum_range=30_000.0))
    with pytest.raises(ConfigurationError, match="manoeuvre_acceleration"):
        TmaTrackerStage(TmaTrackerConfiguration(acceleration=1.0))


def test_lines_that_come_between_two_lists_are_taken_in() -> None:
    first, second = frames_of(scene(DIRECTIONS, duration=2.0))[:2]
    stage = TmaTrackerStage()
    assert listed(stage.update(replace(first, lines=()))).line_id.tolist() == []
    later = tuple(replace(one, stamp=one.stamp + SECOND // 2) for one in first.lines)
    assert stage.update(PassiveFrame(first.stamp + SECOND // 2, lines=later)).tracks is None
    assert listed(stage.update(replace(second, lines=()))).line_id.tolist() == [1, 2, 3]
