"""Protects the fusion with other ships: honest, no echo of one's own words, names of all apart."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.fusion.fusion_records import FusionFrame, FusionUpdate
from sonar_tracking.fusion.track_fusion_configuration import TrackFusionConfiguration
from sonar_tracking.fusion.track_fusion_stage import TrackFusionStage
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import PositionTracks, TrackSource
from sonar_tracking.records.time import NANOSECONDS
from tests.fusion.fusion_scene import ECHOES, FOUR, Ships, moments

OTHER = "/ship_b/tracks"
SHIP_A = TrackFusionConfiguration(
    travel_time=False, heading_standard_deviation_deg=0.0, ship=1, alignment_deviation_deg=0.0
)


def foreign_list(truth: np.ndarray, stamp: int, source: TrackSource) -> PositionTracks:
    """Return what another ship tells of all ships, made of tracks of one kind."""
    count = len(truth)
    generator = np.random.default_rng(stamp % 1000)
    deviation = np.array([20.0, 20.0, 0.5, 0.5])
    return PositionTracks(
        stamp=stamp,
        id=np.arange(count, dtype=np.uint64) + np.uint64((2 << 48) + 1),
        status=np.full(count, TrackStatus.CONFIRMED, np.uint8),
        source=np.full(count, TrackSource.FUSED, np.uint8),
        state=truth + deviation * generator.standard_normal(truth.shape),
        covariance=np.tile(np.diag(deviation**2), (count, 1, 1)),
        existence_probability=np.full(count, 0.9),
        contributor_track=np.arange(count, dtype=np.uint32),
        contributor_source=np.full(count, source, np.uint8),
        contributor_sensor=("sonar_b",) * count,
        contributor_id=np.arange(count, dtype=np.uint64) + np.uint64(7),
    )


def fused(own: slice, source: TrackSource) -> tuple[FusionUpdate, np.ndarray]:
    """Return the last update of a ship that has echoes of some ships, told of all by another."""
    stage = TrackFusionStage(SHIP_A)
    for moment in moments(Ships(FOUR), 120.0):
        active = {
            name: tracks.selected(np.isin(np.arange(4), np.arange(4)[own]))
            for name, tracks in moment.frame.active.items()
        }
        told = {OTHER: foreign_list(moment.truth, moment.frame.stamp, source)}
        update = stage.update(FusionFrame(moment.frame.stamp, active, foreign=told))
    return update, moment.truth


def test_ships_that_both_see_are_one_row_and_the_rest_is_shown() -> None:
    update, truth = fused(slice(0, 2), TrackSource.ACTIVE)
    tracks, alone = update.tracks, update.own_tracks
    assert len(tracks) == 4 and len(alone) == 2
    for row in range(2):
        assert np.trace(tracks.covariance[row, :2, :2]) < np.trace(alone.covariance[row, :2, :2])
        made_of = tracks.contributor_track == row
        names = {name for name, own in zip(tracks.contributor_sensor, made_of, strict=True) if own}
        assert names == {ECHOES, OTHER, "sonar_b"}
    error = tracks.state - truth
    square = np.einsum("ni,nij,nj->n", error, np.linalg.inv(tracks.covariance), error)
    assert np.all(square < 20.0)


def test_identifiers_of_two_ships_are_different() -> None:
    update, _ = fused(slice(0, 4), TrackSource.ACTIVE)
    assert {int(name) >> 48 for name in update.tracks.id} == {1}
    other = TrackFusionStage(replace(SHIP_A, ship=2))
    (moment, *_) = moments(Ships(FOUR), 2.0)
    assert {int(name) >> 48 for name in other.update(moment.frame).tracks.id} == {2}


def test_nothing_is_taken_back_that_may_be_one_s_own() -> None:
    update, _ = fused(slice(0, 2), TrackSource.FUSED)
    assert len(update.tracks) == 2
    assert np.array_equal(update.tracks.covariance, update.own_tracks.covariance)


def broken(covariance: FloatArray, which: str) -> FloatArray:
    """Return covariances the first of which is impossible."""
    wrong = covariance.copy()
    wrong[0] = {"negative": -wrong[0], "nan": wrong[0] * np.nan, "tiny": wrong[0] * 1e-12}[which]
    return wrong


@pytest.mark.parametrize("which", ["negative", "nan", "tiny"])
def test_a_row_with_an_impossible_covariance_is_named_and_the_others_are_used(which: str) -> None:
    stage = TrackFusionStage(SHIP_A)
    for moment in moments(Ships(FOUR[:2]), 30.0):
        told = foreign_list(moment.truth, moment.frame.stamp, TrackSource.ACTIVE)
        wrong = replace(told, covariance=broken(told.covariance, which))
        frame = replace(moment.frame, active={}, bearings=(), foreign={OTHER: wrong})
        update = stage.update(frame)
        (text,) = [one.text for one in update.notices]
        assert OTHER in text and f"track {told.id[0]}" in text and "left out" in text
    assert len(update.tracks) == 1
    assert list(update.tracks.contributor_id[:1]) == [told.id[1]]


@pytest.mark.parametrize(("late", "said"), [(1000, "1000 s before"), (-1000, "1000 s after")])
def test_a_list_of_another_epoch_is_left_out_with_a_sentence(late: int, said: str) -> None:
    stage = TrackFusionStage(SHIP_A)
    for moment in moments(Ships(FOUR[:1]), 10.0):
        told = foreign_list(moment.truth, moment.frame.stamp, TrackSource.ACTIVE)
        there = replace(told, stamp=told.stamp - late * NANOSECONDS)
        frame = replace(moment.frame, active={}, bearings=(), foreign={OTHER: there})
        update = stage.update(frame)
        (text,) = [one.text for one in update.notices]
        assert OTHER in text and said in text
    assert len(update.tracks) == 0


def test_impossible_covariances_and_other_epochs_are_left_out() -> None:
    stage = TrackFusionStage(SHIP_A)
    for moment in moments(Ships(FOUR[:1]), 30.0):
        told = foreign_list(moment.truth, moment.frame.stamp, TrackSource.ACTIVE)
        wrong = replace(told, covariance=-told.covariance)
        long_ago = replace(told, stamp=told.stamp - 1000 * NANOSECONDS)
        frame = replace(
            moment.frame, bearings=(), foreign={OTHER: wrong, "/ship_c/tracks": long_ago}
        )
        update = stage.update(frame)
        assert any(OTHER in one.text and "left out" in one.text for one in update.notices)
    assert np.array_equal(update.tracks.covariance, update.own_tracks.covariance)
    assert len(update.tracks) == 1
