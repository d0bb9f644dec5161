"""Protects the list where ships meet: a track of both of them makes no second row of one."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest

from sonar_tracking.fusion.fused_target import FusedTarget
from sonar_tracking.fusion.fusion_records import FusionFrame
from sonar_tracking.fusion.track_fusion_configuration import TrackFusionConfiguration
from sonar_tracking.fusion.track_fusion_stage import TrackFusionStage
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import BearingTracks, TrackStatus
from sonar_tracking.records.positions import PositionTracks, TrackSource
from tests.fusion.fusion_scene import ARRAY, ECHOES, FOUR, Ships, moments

CONFIGURATION = TrackFusionConfiguration(
    travel_time=False, heading_standard_deviation_deg=0.0, alignment_deviation_deg=0.0
)
BESIDE = np.array([80.0, 60.0, 0.0, 0.0])
"""From a ship, where the tracker of echoes has one track more, m and m/s."""

SECOND = 103
"""Its identifier: it has the place of a third ship, which is not there."""


def with_second(tracks: PositionTracks, state: FloatArray, status: TrackStatus) -> PositionTracks:
    """Return a list whose last row is somewhere else, and was measured only if it is confirmed."""
    states, statuses = tracks.state.copy(), tracks.status.copy()
    measurement, covariance = tracks.measurement.copy(), tracks.covariance.copy()
    states[-1], statuses[-1] = state, status
    measurement[-1] = state[:2] if status == TrackStatus.CONFIRMED else np.nan
    covariance[-1] = np.diag([70.0**2, 70.0**2, 4.0, 4.0])
    return replace(
        tracks, state=states, status=statuses, measurement=measurement, covariance=covariance
    )


def without_last(bearings: BearingTracks) -> BearingTracks:
    """Return bearings of all ships but the last."""
    columns: dict[str, Any] = {
        field.name: value[:-1]
        for field in fields(bearings)
        if isinstance(value := getattr(bearings, field.name), np.ndarray) and value.size
    }
    return replace(bearings, **columns)


def second_row(confirmed_from: float, moved: FloatArray) -> list[tuple[float, int | None]]:
    """Return when the second track of a ship has which status in the fused list.

    Parameters
    ----------
    confirmed_from : float
        It is coasted between 40 s, where it begins, and then, s.
    moved : ndarray, shape (4,)
        From the ship, m and m/s.
    """
    stage, statuses = TrackFusionStage(CONFIGURATION), []
    there = np.array([True, True, False])
    for moment in moments(Ships(FOUR[:3]), 110.0):
        heard = tuple(without_last(one) for one in moment.frame.bearings)
        frame = replace(moment.frame, bearings=heard)
        if frame.active:
            told = frame.active[ECHOES].selected(there)
            if moment.time >= 30.0:
                first = moment.time == 30.0 or moment.time >= confirmed_from
                status = TrackStatus.CONFIRMED if first else TrackStatus.COASTED
                told = with_second(frame.active[ECHOES], moment.truth[0] + moved, status)
            frame = replace(frame, active={ECHOES: told})
        tracks = stage.update(frame).tracks
        if moment.frame.active and moment.time >= 40.0:
            made_of = tracks.contributor_track[tracks.contributor_id == SECOND]
            row = int(made_of[0]) if len(made_of) else None
            statuses.append((moment.time, None if row is None else int(tracks.status[row])))
    return statuses


@pytest.mark.slow
def test_a_track_beside_a_ship_that_nothing_confirms_is_tentative() -> None:
    statuses = second_row(np.inf, BESIDE)
    assert {status for _, status in statuses} <= {None, TrackStatus.TENTATIVE}
    # Far from every ship it is one of its own, and said to be lost.
    far = second_row(np.inf, 10.0 * BESIDE)
    assert TrackStatus.COASTED in {status for _, status in far}


@pytest.mark.slow
def test_a_ship_that_is_confirmed_again_is_shown_after_a_while() -> None:
    statuses = dict(second_row(60.0, BESIDE))
    assert statuses[50.0] == statuses[60.0] == statuses[70.0] == TrackStatus.TENTATIVE
    assert statuses[100.0] == TrackStatus.CONFIRMED


def pair_in_doubt() -> tuple[TrackFusionStage, FusedTarget, FusedTarget, FusedTarget]:
    """Return two ships, the first of which has lost its echoes to a target in doubt beside it."""
    stage = TrackFusionStage(CONFIGURATION)
    for moment in moments(Ships(FOUR[:2]), 62.0):
        stage.update(moment.frame)
    first, other = stage._filters.targets
    (key,) = first.echoes
    lost = first.echoes.pop(key)
    doubtful = FusedTarget(77, 60.0, {key: lost})
    own = stage._filters.state_of(first)
    stage._filters.begin(doubtful, own.mean, own.covariance)
    stage._target_of[key] = doubtful
    return stage, first, other, doubtful


def test_who_has_lost_the_echoes_after_an_exchange_is_the_one_that_was_meant() -> None:
    """The new track was held to be of the other ship: its echoes had been lost then."""
    stage, first, other, doubtful = pair_in_doubt()
    number = first.id
    doubtful.begin_doubt(other, 0.0)
    stage._exchange_rivals((first, other))
    assert len(stage._filters.targets) == 2
    kept = next(one for one in stage._filters.targets if one is not other)
    assert kept.id == number and kept.echoes and kept.rival is None


def test_an_exchange_between_others_says_nothing_of_a_doubt() -> None:
    stage, first, other, doubtful = pair_in_doubt()
    doubtful.begin_doubt(first, 0.0)
    stage._exchange_rivals((other, FusedTarget(78, 0.0)))
    assert doubtful.rival is first and len(stage._filters.targets) == 3


def test_bearings_that_have_been_given_back_make_no_row_for_a_minute() -> None:
    stage = TrackFusionStage(CONFIGURATION)
    for moment in moments(Ships(FOUR[:2]), 62.0):
        stage.update(moment.frame)
    key = next(iter(stage._filters.targets[0].heard))
    stage._links.remove(key)
    assert key[0] == ARRAY
    passive = ("passive/tracks", 1)
    assert not stage._stands_for(passive, (key,))
    stage._parted[key] = moment.frame.stamp + 60 * 10**9
    assert stage._stands_for(passive, (key,))
    later = FusionFrame(moment.frame.stamp + 61 * 10**9)
    stage.update(later)
    assert not stage._stands_for(passive, (key,))


@pytest.mark.parametrize(("metres", "shown"), [(30.0, False), (900.0, True)])
def test_what_is_told_to_be_fixed_where_a_ship_lost_its_echoes_is_no_row(
    metres: float, shown: bool
) -> None:
    stage = TrackFusionStage(CONFIGURATION)
    for moment in moments(Ships(FOUR[:2]), 62.0):
        told = moment.frame.active.get(ECHOES)
        if told is not None and moment.time == 60.0:
            # The first ship's track ends, and another one begins there, which does not move yet.
            identifiers, source, state = told.id.copy(), told.source.copy(), told.state.copy()
            identifiers[0], source[0] = SECOND, TrackSource.STATIC
            state[0] = [*(moment.truth[0, :2] + metres), 0.0, 0.0]
            begun = replace(told, id=identifiers, source=source, state=state)
            tracks = stage.update(replace(moment.frame, active={ECHOES: begun})).tracks
        else:
            stage.update(moment.frame)
    assert (SECOND in tracks.contributor_id) == shown
