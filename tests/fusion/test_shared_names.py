"""Protects the names of targets of which several ships tell: one each, whoever found them first."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from sonar_tracking.fusion.fusion_records import FusionFrame
from sonar_tracking.fusion.shared_names import OTHERS_BEGIN, SharedNames
from sonar_tracking.fusion.track_fusion_stage import TrackFusionStage
from sonar_tracking.records.arrays import BoolArray
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import PositionTracks, TrackSource
from tests.fusion.fusion_scene import ECHOES, FOUR, Moment, Ships, moments
from tests.fusion.test_foreign_tracks import OTHER, SHIP_A, foreign_list

KEY, THIRD = ("b", 7), "/ship_c/tracks"


def since(**names: float) -> Callable[[int], float]:
    """Return since when names have been confirmed, written n3=5.0."""
    return lambda name: names.get(f"n{name}", math.inf)


def test_a_pair_goes_by_the_older_name_and_whoever_outlives_the_other_keeps_it() -> None:
    names = SharedNames(1)
    first = names.alone(KEY, set())
    assert first == OTHERS_BEGIN + 1
    assert names.join(KEY, 3, since(**{f"n{first}": 1.0, "n3": 2.0}), set()) == first
    names.keep("b", set())
    assert names.name_of(3) == first and names.own_row_called(first) == 3
    names.join(KEY, 3, since(), set())
    names.settle([KEY], [KEY], [])
    assert names.alone(KEY, set()) == first


def test_a_name_of_own_sensors_goes_on_with_what_another_ship_tells() -> None:
    names = SharedNames(1)
    names.join(KEY, 3, since(n3=1.0), set())
    names.keep_own(set())
    names.settle([KEY], [KEY], [])
    assert names.alone(KEY, set()) == 3
    names.settle([KEY], [], [4])
    assert names.join(KEY, 4, since(n3=1.0, n4=2.0), set()) == 3


def test_what_proves_to_be_two_targets_has_two_names_again() -> None:
    names = SharedNames(1)
    first = names.alone(KEY, set())
    names.join(KEY, 3, since(**{f"n{first}": 1.0}), set())
    names.settle([KEY], [KEY], [3])
    assert names.name_of(3) == 3
    assert names.alone(KEY, {3}) == first


def test_no_two_rows_have_one_name() -> None:
    names = SharedNames(1)
    names.join(KEY, 3, since(n3=1.0), set())
    names.settle([KEY], [KEY], [])
    assert names.alone(KEY, {3}) == OTHERS_BEGIN + 1


def shown(
    moment: Moment, stage: TrackFusionStage, own: BoolArray, told: dict[str, PositionTracks]
) -> PositionTracks:
    """Return what goes on in the list of a ship with echoes of some targets."""
    active = {name: tracks.selected(own) for name, tracks in moment.frame.active.items()}
    tracks = stage.update(FusionFrame(moment.frame.stamp, active, foreign=told)).tracks
    return tracks.selected(tracks.status != TrackStatus.TERMINATED)


def test_what_another_ship_found_first_keeps_its_name_when_own_sensors_find_it() -> None:
    """Told by a ship from 0 s on, own echoes from 60 s to 180 s, by the ship until 100 s."""
    stage, nobody = TrackFusionStage(SHIP_A), np.zeros(1, bool)
    identifiers, contributors = [], []
    for moment in moments(Ships(FOUR[:1]), 240.0):
        by_other = moment.time < 100.0 or moment.time >= 170.0
        told = foreign_list(moment.truth, moment.frame.stamp, TrackSource.ACTIVE)
        own = ~nobody if 60.0 <= moment.time < 180.0 else nobody
        tracks = shown(moment, stage, own, {OTHER: told} if by_other else {})
        identifiers.append(tuple(tracks.id.tolist()))
        contributors.append(set(tracks.contributor_sensor))
    # A new track of own sensors may need a second list until it is sure whose it is.
    assert len(set(identifiers[:30])) == 1 and len(identifiers[0]) == 1
    assert set(identifiers[35:]) == {identifiers[0]}
    assert contributors[29] == {OTHER, "sonar_b"}
    assert contributors[49] == {OTHER, "sonar_b", ECHOES}
    assert contributors[84] == {ECHOES}
    assert contributors[-1] == {OTHER, "sonar_b"}


def test_two_other_ships_that_tell_of_one_target_make_one_row() -> None:
    stage = TrackFusionStage(SHIP_A)
    for moment in moments(Ships(FOUR), 20.0):
        stamp = moment.frame.stamp
        told = {
            OTHER: foreign_list(moment.truth[:3], stamp, TrackSource.ACTIVE),
            THIRD: foreign_list(moment.truth[1:], stamp, TrackSource.ACTIVE),
        }
        tracks = shown(moment, stage, np.zeros(4, bool), told)
    assert len(tracks) == 4
    made_of = [
        set(np.array(tracks.contributor_sensor)[tracks.contributor_track == row])
        for row in range(4)
    ]
    assert sum({OTHER, THIRD} <= one for one in made_of) == 2


def test_an_operator_ends_a_row_by_the_name_that_is_shown() -> None:
    stage = TrackFusionStage(SHIP_A)
    for moment in moments(Ships(FOUR[:1]), 60.0):
        told = foreign_list(moment.truth, moment.frame.stamp, TrackSource.ACTIVE)
        own = np.full(1, moment.time >= 20.0)
        tracks = shown(moment, stage, own, {OTHER: told})
    assert ECHOES in tracks.contributor_sensor
    stage.end_track(int(tracks.id[0]))
    after = stage.update(FusionFrame(tracks.stamp + 1))
    assert ECHOES not in after.tracks.contributor_sensor
