"""Protects alignment from bearings of two targets that an array does not tell apart."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.fusion.fused_target import Contributor, FusedTarget
from sonar_tracking.fusion.fusion_records import FusionFrame, FusionUpdate, HeardBearing
from sonar_tracking.fusion.track_fusion_configuration import TrackFusionConfiguration
from sonar_tracking.fusion.track_fusion_stage import TrackFusionStage
from sonar_tracking.fusion.unresolved_bearings import SILENT_AFTER, UnresolvedBearings
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.time import NANOSECONDS
from tests.fusion.fusion_scene import FOUR, Moment, Ships, moments

BEAM = np.radians(12.0)


def bearing(number: int, *azimuths_deg: float) -> HeardBearing:
    """Return a bearing of one track."""
    azimuths = tuple(float(np.radians(one)) for one in azimuths_deg)
    return HeardBearing(("array", number), azimuths, 1e-4, np.zeros(2), 0)


def target(number: int, *heard: int) -> FusedTarget:
    """Return a confirmed target with echoes, heard on some bearing tracks."""
    sure = Contributor(TrackStatus.CONFIRMED, 0.99, 0.0)
    own = {("array", one): sure for one in heard}
    return FusedTarget(number, 0.0, {("active/tracks", number): sure}, own)


def mixed(
    found: list[HeardBearing], targets: list[FusedTarget], azimuths_deg: list[float]
) -> set[int]:
    """Return the numbers of the bearing tracks that may be of two targets."""
    unresolved = UnresolvedBearings("array", BEAM)
    unresolved.take(found, targets, lambda: np.radians(azimuths_deg), NANOSECONDS)
    return {number for _, number in unresolved.keys}


def test_a_bearing_near_a_target_that_is_not_reported_may_be_of_both() -> None:
    one, other = target(1, 11), target(2, 12)
    assert mixed([bearing(11, 5.0)], [one, other], [0.0, 11.0]) == {11}
    assert mixed([bearing(11, 5.0)], [one, other], [0.0, 18.0]) == set()
    assert mixed([bearing(11, 0.0), bearing(12, 11.0)], [one, other], [0.0, 11.0]) == set()
    # A bearing that is unassociated so far may be that of the other target.
    assert mixed([bearing(11, 0.0), bearing(13, 11.0)], [one, target(2)], [0.0, 11.0]) == set()


def test_a_line_array_resolves_less_near_its_axis_and_takes_both_sides_for_one() -> None:
    one, other = target(1, 11), target(2)
    assert mixed([bearing(11, 90.0, -90.0)], [one, other], [90.0, 110.0]) == set()
    assert mixed([bearing(11, 15.0, -15.0)], [one, other], [15.0, 35.0]) == {11}
    assert mixed([bearing(11, 60.0, -60.0)], [one, other], [60.0, -64.0]) == {11}


def test_a_target_that_was_not_heard_where_nothing_else_was_near_disturbs_no_bearing() -> None:
    unresolved, (one, silent) = UnresolvedBearings("array", BEAM), (target(1, 11), target(2))
    far, near = np.radians([0.0, 90.0]), np.radians([0.0, 5.0])
    for time in range(int(SILENT_AFTER) + 2):
        heard = [bearing(11, 0.0)]
        unresolved.take(heard, [one, silent], lambda: far, (1 + time) * NANOSECONDS)
    unresolved.take(heard, [one, silent], lambda: near, 99 * NANOSECONDS)
    assert not unresolved.keys
    unresolved.take(heard, [one, target(3)], lambda: np.zeros(2), 100 * NANOSECONDS)
    assert unresolved.keys == {("array", 11)}


def two_near(seed: int, others: int) -> Ships:
    """Return two ships 11 degrees apart that go the same way, and some others."""
    generator = np.random.default_rng(seed)
    azimuth = generator.uniform(0.0, 2.0 * np.pi) + np.array([0.0, np.radians(11.0)])
    near = np.zeros((2, 4))
    near[:, :2] = generator.uniform(2500.0, 4500.0) * np.stack(
        [np.cos(azimuth), np.sin(azimuth)], axis=1
    )
    near[:, 2:] = generator.uniform(-4.0, 4.0, 2)
    return Ships(np.concatenate([near, FOUR[1 : 1 + others]]), acceleration=1e-4, seed=seed)


def merged(moment: Moment) -> FusionFrame:
    """Return a frame in which the array reports one bearing between two ships near each other."""
    (bearings,) = moment.frame.bearings
    offset = moment.truth[:2, :2] - moment.own_ship.position
    cosine = np.cos(np.arctan2(offset[:, 1], offset[:, 0]) - moment.own_ship.azimuth)
    measured, status = bearings.measurement.copy(), bearings.status.copy()
    if abs(cosine[0] - cosine[1]) <= np.sin(BEAM):
        measured[:2] = np.mean(measured[:2]), np.nan
        status[1] = TrackStatus.COASTED
    told: FloatArray = np.where(np.isnan(measured), bearings.arrival_angle, measured)
    changed = replace(bearings, measurement=measured, arrival_angle=told, status=status)
    return replace(moment.frame, bearings=(changed,))


def fused(seed: int, others: int, resolution_deg: float) -> list[FusionUpdate]:
    """Return the updates of a run of 300 s."""
    settings = TrackFusionConfiguration(
        travel_time=False,
        heading_standard_deviation_deg=0.0,
        bearing_resolution_deg=resolution_deg,
    )
    stage = TrackFusionStage(settings, n_sources=2)
    return [stage.update(merged(moment)) for moment in moments(two_near(seed, others), 300.0)]


@pytest.mark.slow
def test_ships_that_are_merged_turn_no_array() -> None:
    errors, deviations = [], []
    for seed in range(4):
        known = fused(seed, 2, 12.0)[-1].alignments
        errors.append(np.degrees(known.misalignment[0]))
        deviations.append(np.degrees(known.misalignment_standard_deviation[0]))
    assert np.max(np.abs(errors)) < 0.4 and np.max(deviations) < 0.3
    believed = (fused(seed, 0, 0.0)[-1].alignments.misalignment[0] for seed in range(4))
    assert any(np.degrees(abs(turned)) > 1.0 for turned in believed)


@pytest.mark.slow
def test_a_merged_bearing_that_no_other_ship_agrees_with_is_not_believed() -> None:
    """Without being told what the array resolves: what the third ship tells of it decides."""
    for seed in (0, 1, 3, 4):
        known = fused(seed, 1, 0.0)[-1].alignments
        assert abs(np.degrees(known.misalignment[0])) < 0.6
        assert np.degrees(known.misalignment_standard_deviation[0]) < 0.3


@pytest.mark.slow
def test_an_array_that_tells_nothing_apart_learns_nothing_and_that_is_told() -> None:
    updates = fused(1, 0, 12.0)
    known = updates[-1].alignments
    assert np.degrees(known.misalignment_standard_deviation[0]) > 1.5
    told = [one.text for update in updates for one in update.notices]
    assert any("'array'" in one or "array:" in one for one in told)
    assert all("bearing_resolution_deg" in one for one in told)
    assert all(len(update.tracks) == 2 for update in updates[-10:])
