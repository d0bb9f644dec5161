"""Protects the exchange of two ships: what each makes of it depends on stamps alone."""

from __future__ import annotations

import itertools

import numpy as np

from sonar_tracking.fusion.foreign_lists import CAPACITY, ForeignLists
from sonar_tracking.fusion.fused_rows import OwnPicture
from sonar_tracking.fusion.fusion_records import FusionFrame
from sonar_tracking.fusion.track_fusion_configuration import TrackFusionConfiguration
from sonar_tracking.fusion.track_fusion_stage import TrackFusionStage
from sonar_tracking.records.positions import PositionTracks, no_position_tracks
from tests.fusion.fusion_scene import ECHOES, FOUR, Ships, moments

OTHER = "b/own_tracks"


NO_ALIGNMENTS = TrackFusionStage().update(FusionFrame(1)).alignments


def picture(stamp: int) -> OwnPicture:
    """Return an empty picture of own sensors."""
    return OwnPicture((), no_position_tracks(stamp), NO_ALIGNMENTS, ())


def told(stamp: int, next_stamp: int = 0) -> PositionTracks:
    """Return an empty list of another ship."""
    return no_position_tracks(stamp, next_stamp)


def joined(order: tuple[int, ...]) -> list[tuple[int, int | None]]:
    """Return the stamps of what is made of pictures at 2, 4, 6 and lists at 3, 4, 7."""
    pictures, lists = (picture(2), picture(4), picture(6)), (told(3), told(4), told(7))
    waiting, made = ForeignLists([OTHER]), []
    for step in order:
        if step < len(pictures):
            waiting.add_own(pictures[step])
        else:
            waiting.add(OTHER, lists[step - len(pictures)])
        for own, foreign in waiting.ready([OTHER]):
            made.append((own.tracks.stamp, foreign[OTHER].stamp if OTHER in foreign else None))
    return made


def test_what_is_made_does_not_depend_on_who_comes_first() -> None:
    orders = [
        order
        for order in itertools.permutations(range(6))
        if all(order.index(n) < order.index(n + 1) for n in (0, 1, 3, 4))
    ]
    assert len(orders) == 20
    assert {tuple(joined(order)) for order in orders} == {((2, None), (4, 4), (6, None))}


def test_a_picture_waits_for_ships_that_may_tell_something_and_for_no_others() -> None:
    waiting = ForeignLists([OTHER])
    waiting.add_own(picture(5))
    assert not list(waiting.ready([OTHER]))
    assert len(list(waiting.ready([]))) == 1
    waiting.add(OTHER, told(4, next_stamp=9))
    waiting.add_own(picture(8))
    ((_, foreign),) = waiting.ready([OTHER])
    assert foreign[OTHER].stamp == 4
    for stamp in range(10, 11 + CAPACITY):
        waiting.add_own(picture(stamp))
    assert [own.tracks.stamp for own, _ in waiting.ready([OTHER])] == [10]


def test_a_ship_that_begins_again_is_believed_from_there() -> None:
    waiting = ForeignLists([OTHER])
    waiting.add(OTHER, told(50))
    waiting.add(OTHER, told(3, next_stamp=6))
    waiting.add_own(picture(5))
    ((_, foreign),) = waiting.ready([OTHER])
    assert foreign[OTHER].stamp == 3


def test_two_ships_tell_each_other_what_each_has_found_and_never_take_it_back() -> None:
    """Ship 1 has echoes of three ships, ship 2 of the last three: both see four, each its own."""
    settings = [
        TrackFusionConfiguration(
            travel_time=False,
            heading_standard_deviation_deg=0.0,
            ship=ship,
            alignment_deviation_deg=0.0,
        )
        for ship in (1, 2)
    ]
    stages = [TrackFusionStage(one) for one in settings]
    names, seen = ("a/own_tracks", "b/own_tracks"), (slice(0, 3), slice(1, 4))
    for moment in moments(Ships(FOUR), 60.0):
        frames = []
        for name, part in zip(names, seen, strict=True):
            active = {
                f"{name[0]}/{topic}": tracks.selected(np.isin(np.arange(4), np.arange(4)[part]))
                for topic, tracks in moment.frame.active.items()
            }
            frames.append(FusionFrame(moment.frame.stamp, active))
        own = [stage.own_picture(one) for stage, one in zip(stages, frames, strict=True)]
        both = [
            stages[this].with_foreign(own[this], {names[other]: own[other].tracks})[0]
            for this, other in ((0, 1), (1, 0))
        ]
    assert [len(tracks) for tracks in both] == [4, 4]
    identifiers = [set(tracks.id.tolist()) for tracks in both]
    assert not identifiers[0] & identifiers[1]
    for this, tracks in enumerate(both):
        mine, others = names[this], names[1 - this]
        made_of = set(tracks.contributor_sensor)
        assert others in made_of and mine not in made_of
        assert {f"{name[0]}/{ECHOES}" for name in names} <= made_of
        error = (
            tracks.state[:, :2]
            - moment.truth[:, :2][
                np.argmin(
                    np.hypot(
                        *(moment.truth[:, None, :2] - tracks.state[None, :, :2]).transpose(2, 0, 1)
                    ),
                    axis=0,
                )
            ]
        )
        spread = np.linalg.inv(tracks.covariance[:, :2, :2])
        assert np.all(np.einsum("ni,nij,nj->n", error, spread, error) < 20.0)
        # What both hear is known better than to either alone, and not as if all were independent.
        alone = own[this].tracks
        kept = [int(np.flatnonzero(tracks.id == one)[0]) for one in alone.id]
        gain = np.trace(tracks.covariance[kept, :2, :2], axis1=1, axis2=2) / np.trace(
            alone.covariance[:, :2, :2], axis1=1, axis2=2
        )
        assert np.all(gain <= 1.0 + 1e-9) and np.all(gain > 0.5)
