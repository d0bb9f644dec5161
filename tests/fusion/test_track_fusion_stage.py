"""Protects the fused picture: one row a target, honest, under one name, whatever is lost."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.errors import ConfigurationError, InputError
from sonar_tracking.fusion.fusion_records import FusionFrame, FusionUpdate
from sonar_tracking.fusion.track_fusion_configuration import TrackFusionConfiguration
from sonar_tracking.fusion.track_fusion_stage import TrackFusionStage
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import PositionTracks, TrackHypothesis, TrackSource
from tests.fusion.fusion_scene import (
    ARRAY,
    ECHOES,
    EPOCH,
    FOUR,
    POSITIONS,
    Moment,
    Ships,
    moments,
    stamp_of,
    with_bearing_tracks,
)

AT_ONCE = TrackFusionConfiguration(travel_time=False, heading_standard_deviation_deg=0.0)
"""The ships of these scenes are heard where they are, and own ship knows its heading."""


def run(scene: Ships, duration: float = 600.0) -> list[tuple[Moment, FusionUpdate]]:
    stage = TrackFusionStage(AT_ONCE)
    return [(one, stage.update(one.frame)) for one in moments(scene, duration)]


def errors(moment: Moment, update: FusionUpdate) -> tuple[np.ndarray, np.ndarray]:
    """Return the state errors of all rows, each against the nearest ship, and covariances."""
    tracks = update.tracks
    apart = tracks.state[:, None, :2] - moment.truth[None, :, :2]
    nearest = np.argmin(np.hypot(apart[..., 0], apart[..., 1]), axis=1)
    return tracks.state - moment.truth[nearest], tracks.covariance


@pytest.fixture(scope="module")
def undisturbed() -> list[tuple[Moment, FusionUpdate]]:
    return run(Ships(FOUR))


@pytest.mark.slow
def test_every_ship_has_one_row_under_one_name(
    undisturbed: list[tuple[Moment, FusionUpdate]],
) -> None:
    names = {tuple(sorted(update.tracks.id)) for _, update in undisturbed[30:]}
    assert len(names) == 1 and len(names.pop()) == 4
    contributors = undisturbed[-1][1].tracks
    assert list(contributors.contributor_source).count(TrackSource.TMA) == 4
    assert set(contributors.contributor_sensor) == {ARRAY, ECHOES}


@pytest.mark.slow
@pytest.mark.parametrize(("degrees", "first"), [(0.0, 0), (1.0, 5), (-3.0, 10)])
def test_the_misalignment_is_found_within_what_is_claimed(degrees: float, first: int) -> None:
    scores = []
    for seed in range(first, first + 5):
        scene = Ships(FOUR, misalignment=np.radians(degrees), seed=seed)
        known = run(scene, 210.0)[-1][1].alignments  # until after own ship's turn
        assert known.sensor_id == (ARRAY,)
        assert known.misalignment_standard_deviation[0] < np.radians(0.2)
        error = known.misalignment[0] - np.radians(degrees)
        scores.append((error / known.misalignment_standard_deviation[0]) ** 2)
    assert np.mean(scores) < 2.5  # of chi-square with 5 degrees of freedom: 97 %


@pytest.mark.slow
@pytest.mark.parametrize("degrees", [0.0, 1.0])
def test_the_covariance_is_honest_and_bearings_help(degrees: float) -> None:
    """Half or twice the covariance is seen in the NEES of two runs, near that of eight, 1.1."""
    squares, nees, alone = [], [], []
    for seed in (1, 3):
        scene = Ships(FOUR, np.radians(degrees), acceleration=2.5e-3, seed=seed)
        for moment, update in run(scene, 400.0)[50::5]:
            error, covariance = errors(moment, update)
            squares.append(np.mean(np.sum(error[:, :2] ** 2, axis=1)))
            solved = np.linalg.solve(covariance, error[..., None])[..., 0]
            nees.append(np.mean(np.sum(error * solved, axis=1)) / 4.0)
            if moment.frame.active:
                apart = moment.frame.active[ECHOES].state - moment.truth
                alone.append(np.mean(np.sum(apart[:, :2] ** 2, axis=1)))
    assert 0.6 < np.mean(nees) < 1.5
    assert np.mean(squares) < 0.5 * np.mean(alone)


@pytest.mark.slow
@pytest.mark.parametrize(
    "scene",
    [Ships(FOUR, silent_sonar=(200.0, 500.0)), Ships(FOUR, silent_array=(200.0, 500.0))],
)
def test_one_name_through_the_loss_of_either_source(scene: Ships) -> None:
    results = run(scene)
    names = {int(name) for _, update in results[30:] for name in update.tracks.id}
    assert len(names) == 4
    for moment, update in results[100:250]:
        error, covariance = errors(moment, update)
        solved = np.linalg.solve(covariance[:, :2, :2], error[:, :2, None])[..., 0]
        assert np.all(np.sum(error[:, :2] * solved, axis=1) < 20.0)


@pytest.mark.slow
def test_the_side_of_the_array_follows_own_ship_s_turns(
    undisturbed: list[tuple[Moment, FusionUpdate]],
) -> None:
    """A ship abeam to starboard is to port after a turn: no bearing is taken for its mirror's."""
    for moment, update in undisturbed[80:]:
        error, _ = errors(moment, update)
        assert np.all(np.hypot(error[:, 0], error[:, 1]) < 150.0)


@pytest.mark.slow
def test_bearing_tracks_that_change_their_sources_are_given_back() -> None:
    stage, scene = TrackFusionStage(AT_ONCE), Ships(FOUR)
    for moment in moments(scene, 500.0):
        frame = moment.frame
        if moment.time >= 300.0:
            frame = with_bearing_tracks(frame, [1, 0, 2, 3])
        update = stage.update(frame)
    tracks = update.tracks
    error, _ = errors(moment, update)
    assert len(tracks) == 4 and np.all(np.hypot(error[:, 0], error[:, 1]) < 100.0)
    heard = {
        int(track): int(number)
        for track, number, source in zip(
            tracks.contributor_track,
            tracks.contributor_id,
            tracks.contributor_source,
            strict=True,
        )
        if source == TrackSource.TMA
    }
    apart = tracks.state[:, None, :2] - moment.truth[None, :, :2]
    ship = np.argmin(np.hypot(apart[..., 0], apart[..., 1]), axis=1)
    of_ship = {int(ship[track]): number for track, number in heard.items()}
    assert of_ship[0] == 202 and of_ship[1] == 201


@pytest.mark.slow
def test_echoes_show_that_a_bearing_track_is_of_something_else() -> None:
    """Bearings alone never contradict: the row would follow them away from its echoes."""
    stage = TrackFusionStage(AT_ONCE)
    for moment in moments(Ships(FOUR), 400.0):
        (bearings,) = moment.frame.bearings
        away = np.radians(0.08) * max(moment.time - 100.0, 0.0) * np.eye(4)[0]
        measured = bearings.measurement + away
        drifting = replace(bearings, measurement=measured, arrival_angle=measured)
        update = stage.update(replace(moment.frame, bearings=(drifting,)))
        error, _ = errors(moment, update)
        assert moment.time < 50.0 or np.all(np.hypot(error[:, 0], error[:, 1]) < 250.0)
    heard = update.tracks.contributor_id[update.tracks.contributor_source == TrackSource.TMA]
    assert set(heard.tolist()) == {202, 203, 204}


@pytest.mark.slow
def test_echoes_far_from_where_a_lost_ship_may_be_wait_for_its_bearings() -> None:
    """Neither surely the old ship nor surely a new one: no second row is confirmed meanwhile."""
    stage, names = TrackFusionStage(AT_ONCE), set()
    for moment in moments(Ships(FOUR, silent_sonar=(200.0, 500.0)), 600.0):
        frame = moment.frame
        if moment.time >= 500.0 and frame.active:
            tracks = frame.active[ECHOES]
            frame = replace(frame, active={ECHOES: replace(tracks, id=tracks.id + np.uint64(1000))})
        tracks = stage.update(frame).tracks
        if moment.time >= 60.0:
            assert len(tracks.selected(tracks.status == TrackStatus.CONFIRMED)) <= 4
            names |= set(tracks.id[tracks.established].tolist())
    assert len(names) == 4


def both_sides(moment: Moment, number: int) -> PositionTracks:
    """Return what target motion analysis tells of one bearing track: both sides, confirmed left."""
    ship = moment.truth[number]
    heading = float(moment.own_ship.azimuth)
    along = np.array([np.cos(heading), np.sin(heading)])
    offset = ship[:2] - moment.own_ship.position
    mirror = moment.own_ship.position + 2.0 * along * (along @ offset) - offset
    return PositionTracks(
        stamp=moment.frame.stamp,
        id=np.array([11, 12], np.uint64),
        status=np.array([TrackStatus.CONFIRMED, TrackStatus.TENTATIVE], np.uint8),
        source=np.full(2, TrackSource.TMA, np.uint8),
        state=np.array([[*ship[:2], 0.0, 0.0], [*mirror, 0.0, 0.0]]),
        covariance=np.tile(np.diag([1e4, 1e4, 4.0, 4.0]), (2, 1, 1)),
        initiated=np.full(2, EPOCH * 1e-9 - 100.0),
        hypothesis=np.array([TrackHypothesis.LEFT, TrackHypothesis.RIGHT], np.uint8),
        bearing_track_id=np.full(2, 201 + number, np.uint64),
        contributor_track=np.array([0, 1], np.uint32),
        contributor_source=np.full(2, TrackSource.TMA, np.uint8),
        contributor_sensor=(ARRAY, ARRAY),
        contributor_id=np.full(2, 201 + number, np.uint64),
    )


def test_echoes_settle_the_side_and_the_older_name_stays() -> None:
    stage = TrackFusionStage(AT_ONCE)
    names = set()
    for moment in moments(Ships(FOUR, silent_sonar=(0.0, 60.0)), 200.0):
        told = replace(moment.frame, passive={POSITIONS: both_sides(moment, 0)})
        tracks = stage.update(told).tracks
        if moment.time == 50.0:
            assert sorted(tracks.hypothesis) == [TrackHypothesis.LEFT, TrackHypothesis.RIGHT]
            names = set(tracks.id[tracks.status == TrackStatus.CONFIRMED].tolist())
    established = tracks.selected(tracks.status == TrackStatus.CONFIRMED)
    assert len(tracks) == 4 and np.all(tracks.hypothesis == TrackHypothesis.SINGLE)
    assert names <= set(established.id.tolist())


@pytest.mark.slow
def test_a_sonar_that_restarts_with_other_identifiers_changes_no_names() -> None:
    stage = TrackFusionStage(AT_ONCE)
    names = set()
    for moment in moments(Ships(FOUR), 260.0):
        frame = moment.frame
        if moment.time >= 200.0 and frame.active:
            tracks = frame.active[ECHOES]
            frame = replace(frame, active={ECHOES: replace(tracks, id=tracks.id + np.uint64(1000))})
        tracks = stage.update(frame).tracks
        if moment.time >= 60.0:
            names |= set(tracks.id.tolist())
    assert len(names) == 4 and len(tracks) == 4


@pytest.mark.slow
def test_a_source_that_comes_late_is_taken_in() -> None:
    stage = TrackFusionStage(AT_ONCE)
    for moment in moments(Ships(FOUR, silent_array=(0.0, 200.0)), 320.0):
        tracks = stage.update(moment.frame).tracks
    assert list(tracks.contributor_source).count(TrackSource.TMA) == 4


def test_of_two_stations_with_one_name_the_second_is_named_and_left_out() -> None:
    stage = TrackFusionStage(AT_ONCE)
    for moment in moments(Ships(FOUR), 40.0):
        (bearings,) = moment.frame.bearings
        elsewhere = replace(bearings.sensor, position=(9000.0, 9000.0, 0.0))
        twice = (bearings, replace(bearings, sensor=elsewhere))
        update = stage.update(replace(moment.frame, bearings=twice))
        assert any("two stations" in one.text and ARRAY in one.text for one in update.notices)
    assert len(update.tracks) == 4


def test_a_row_that_ends_is_reported_once() -> None:
    stage = TrackFusionStage(replace(AT_ONCE, coast_duration=0.0))
    frames = [one.frame for one in moments(Ships(FOUR[:1]), 40.0)]
    for frame in frames[:11]:
        stage.update(replace(frame, bearings=()))
    nothing = frames[0].active[ECHOES].selected(np.zeros(1, bool))
    gone = stage.update(FusionFrame(stamp_of(30.0), {ECHOES: nothing}))
    assert list(gone.tracks.status) == [TrackStatus.TERMINATED]
    assert len(stage.update(FusionFrame(stamp_of(32.0))).tracks) == 0


def test_frames_out_of_order_change_nothing() -> None:
    stage = TrackFusionStage(AT_ONCE)
    stage.update(FusionFrame(stamp_of(10.0)))
    with pytest.raises(InputError, match="send frames in order"):
        stage.update(FusionFrame(stamp_of(10.0)))
    assert len(stage.update(FusionFrame(stamp_of(12.0))).tracks) == 0


def test_a_station_that_does_not_tell_where_it_is_is_named() -> None:
    stage = TrackFusionStage(AT_ONCE)
    (moment, *_) = moments(Ships(FOUR), 2.0)
    (bearings,) = moment.frame.bearings
    lost = replace(bearings, sensor=replace(bearings.sensor, position=(np.nan,) * 3))
    update = stage.update(FusionFrame(moment.frame.stamp, moment.frame.active, (lost,)))
    assert len(update.tracks) == 4
    assert ARRAY in update.notices[0].text and "own_ship/odometry" in update.notices[0].text


def test_numbers_that_are_none_do_no_harm() -> None:
    stage = TrackFusionStage(AT_ONCE)
    for moment in moments(Ships(FOUR), 100.0):
        frame = moment.frame
        if frame.active and moment.time > 20.0:
            tracks = frame.active[ECHOES]
            broken = tracks.state.copy()
            broken[0] = np.nan
            measured = tracks.measurement.copy()
            measured[1] = np.inf
            noise = tracks.measurement_covariance.copy()
            noise[2] = -np.eye(2)
            frame = replace(
                frame,
                active={
                    ECHOES: replace(
                        tracks,
                        state=broken,
                        measurement=measured,
                        measurement_covariance=noise,
                    )
                },
            )
        update = stage.update(frame)
        if moment.time > 20.0 and frame.active:
            assert "track 101, 102, 103" in update.notices[0].text
    assert len(update.tracks) == 4 and np.all(np.isfinite(update.tracks.state))


@pytest.mark.slow
def test_an_array_turned_by_more_than_expected_is_named() -> None:
    stage = TrackFusionStage(replace(AT_ONCE, alignment_deviation_deg=1.0))
    said = set()
    for moment in moments(Ships(FOUR, np.radians(3.5)), 300.0):
        said |= {one.text for one in stage.update(moment.frame).notices}
    assert any("mounting_yaw_deg" in text and ARRAY in text for text in said)


@pytest.mark.slow
@pytest.mark.parametrize("source", [ECHOES, ARRAY])
def test_ships_that_meet_keep_their_names_though_a_tracker_exchanges_them(source: str) -> None:
    """From where they meet on, either tracker goes on with the other ship: the rows do not."""
    crossing = np.array([[-3000.0, 3000.0, 6.0, 0.0], [-3000.0, 2250.0, 6.0, 5.0]])
    stage, names = TrackFusionStage(AT_ONCE), {}
    for moment in moments(Ships(crossing), 400.0):
        frame = moment.frame
        if moment.time > 150.0 and source == ARRAY:
            frame = with_bearing_tracks(frame, [1, 0])
        if moment.time > 150.0 and source == ECHOES and frame.active:
            tracks = frame.active[ECHOES]
            frame = replace(frame, active={ECHOES: replace(tracks, id=tracks.id[::-1])})
        tracks = stage.update(frame).tracks
        if moment.time in (100.0, 398.0):
            apart = tracks.state[:, None, :2] - moment.truth[None, :, :2]
            ships = np.argmin(np.hypot(apart[..., 0], apart[..., 1]), axis=1)
            names[moment.time] = dict(zip(ships.tolist(), tracks.id.tolist(), strict=True))
    assert len(names[100.0]) == 2 and names[100.0] == names[398.0]


@pytest.mark.slow
def test_a_station_whose_clock_is_late_is_told_so() -> None:
    """Bearings of where a fast ship was 20 s ago: told the offset, the row is where the ship is."""
    fast = np.array([[2000.0, -2000.0, 0.0, 20.0]])
    wrong = {}
    for offsets in (("",), (f"{ARRAY}=20",)):
        settings = replace(AT_ONCE, clock_offsets=offsets, alignment_deviation_deg=0.0)
        stage, late, apart = TrackFusionStage(settings), {}, []
        for moment in moments(Ships(fast), 190.0):
            late[moment.time] = moment
            frame = moment.frame
            before = late.get(moment.time - 20.0)
            (now,) = frame.bearings
            then = now if before is None else before.frame.bearings[0]
            told = replace(then, stamp=now.stamp, next_stamp=now.next_stamp)
            update = stage.update(replace(frame, bearings=(told,) if before else ()))
            if moment.time > 100.0:
                error, _ = errors(moment, update)
                apart.append(np.hypot(*error[0, :2]))
        wrong[offsets] = np.mean(apart)
    told, untold = wrong[(f"{ARRAY}=20",)], wrong[("",)]
    assert told < 0.7 * untold, (told, untold)


@pytest.mark.parametrize("text", ["pier", "=3", "pier=soon", "pier=inf"])
def test_a_clock_offset_that_cannot_be_read_is_named(text: str) -> None:
    with pytest.raises(ConfigurationError, match="clock_offsets"):
        TrackFusionConfiguration(clock_offsets=(text,))


def test_targets_of_sources_that_have_died_are_coasted_and_end() -> None:
    """Nobody says that their tracks have ended: a list that is not sent any more says nothing."""
    stage = TrackFusionStage(AT_ONCE)
    for moment in moments(Ships(FOUR), 60.0):
        update = stage.update(moment.frame)
    assert set(update.tracks.status.tolist()) == {TrackStatus.CONFIRMED}
    update = stage.update(FusionFrame(stamp_of(100.0)))
    assert update.tracks.status.tolist() == 4 * [TrackStatus.COASTED]
    update = stage.update(FusionFrame(stamp_of(700.0)))
    assert update.tracks.status.tolist() == 4 * [TrackStatus.TERMINATED]
    assert len(stage.update(FusionFrame(stamp_of(710.0))).tracks) == 0


@pytest.mark.slow
def test_without_own_ship_s_odometry_stations_that_tell_their_pose_are_used() -> None:
    stage = TrackFusionStage(AT_ONCE)
    for moment in moments(Ships(FOUR), 120.0):
        update = stage.update(replace(moment.frame, own_ship=None))
    sources = update.tracks.contributor_source.tolist()
    assert len(update.tracks) == 4 and sources.count(TrackSource.TMA) == 4
