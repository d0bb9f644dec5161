"""The measure of kept identities: hand-made lists whose answer is plain."""

from __future__ import annotations

import math

import pytest

from sonar_tracking.graph.chaos.track_identities import (
    Identities,
    Place,
    TrackList,
    identities,
    longest_delay,
)

CUTOFF = 100.0
WEST: Place = (-1000.0, 0.0)
EAST: Place = (1000.0, 0.0)
TRUTH = [TrackList(0.0, stamp, {1: [WEST], 2: [EAST]}) for stamp in range(20)]


def lists(first: int, *places: dict[int, Place]) -> list[TrackList]:
    """Return lists that follow each other."""
    return [
        TrackList(float(stamp), stamp, {name: [place] for name, place in each.items()})
        for stamp, each in enumerate(places, start=first)
    ]


BEFORE = lists(0, *[{7: WEST, 8: EAST}] * 5)


def test_tracks_that_go_on_where_they_were_are_kept() -> None:
    after = lists(5, *[{7: (-950.0, 0.0), 8: EAST}] * 3)
    assert identities(BEFORE, after, TRUTH, CUTOFF) == Identities(2, 2)


def test_a_track_that_is_confirmed_now_and_then_is_neither_lost_nor_found_by_chance() -> None:
    before = lists(0, {7: WEST, 9: EAST}, {7: WEST}, {}, {7: WEST}, {})
    after = lists(5, {8: EAST}, {8: EAST}, {7: WEST}, {8: EAST})
    assert identities(before, after, TRUTH, CUTOFF) == Identities(1, 1), "9 was seen once only"


def test_a_track_with_another_identifier_is_lost() -> None:
    after = lists(5, *[{9: WEST, 8: EAST}] * 3)
    assert identities(BEFORE, after, TRUTH, CUTOFF) == Identities(2, 1)


def test_an_identifier_that_goes_to_another_target_is_lost() -> None:
    after = lists(5, {7: WEST, 8: EAST}, *[{7: EAST, 8: WEST}] * 3)
    assert identities(BEFORE, after, TRUTH, CUTOFF) == Identities(2, 0)
    assert identities(BEFORE, after, [], CUTOFF) == Identities(2, 2), "without truth nobody knows"


def test_what_is_lost_without_the_fault_as_well_does_not_count() -> None:
    after = lists(5, {9: WEST, 8: EAST})
    swapped = [*BEFORE, *lists(5, {3: WEST, 8: EAST})]
    assert identities(BEFORE, after, TRUTH, CUTOFF, swapped) == Identities(1, 1)
    whole = [*BEFORE, *lists(5, {7: WEST, 8: EAST})]
    assert identities(BEFORE, after, TRUTH, CUTOFF, whole) == Identities(2, 1)


def test_a_track_that_drifts_off_keeps_its_identifier() -> None:
    after = lists(5, {7: (-500.0, 0.0), 8: EAST})
    assert identities(BEFORE, after, TRUTH, CUTOFF) == Identities(2, 2)


def test_a_target_that_leaves_does_not_count() -> None:
    truth = [*TRUTH[:6], *(TrackList(0.0, stamp, {2: [EAST]}) for stamp in range(6, 20))]
    after = lists(5, {8: EAST}, {8: EAST})
    assert identities(BEFORE, after, truth, CUTOFF) == Identities(1, 1)


def test_both_sides_of_an_ambiguous_bearing_are_one_track() -> None:
    both = [TrackList(0.0, stamp, {7: [(0.0, 500.0), WEST]}) for stamp in range(5)]
    after = [TrackList(0.0, stamp, {7: [WEST]}) for stamp in range(5, 8)]
    assert identities(both, after, TRUTH, CUTOFF) == Identities(1, 1)


def test_bearings_are_compared_around_the_circle() -> None:
    truth = [TrackList(0.0, stamp, {1: [(math.pi - 0.01,)]}) for stamp in range(20)]
    one, other = (0.02 - math.pi,), (math.pi - 0.02,)
    before = lists(0, {7: one}, {7: one}, {7: one}, {7: one}, {7: one})
    after = lists(5, {7: other}, {7: other})
    assert identities(before, after, truth, 0.05) == Identities(1, 1)


def test_the_longest_time_without_tracks_counts_from_when_they_were_due() -> None:
    """A list that was on its way when the fault came does not end the wait."""
    assert longest_delay([10.2, 14.0, 15.0, 16.0], due=10.0, interval=1.0) == pytest.approx(2.8)
    assert longest_delay([13.0, 14.0], due=10.0, interval=1.0) == pytest.approx(3.0)
    assert longest_delay([9.5, 10.0], due=10.0, interval=1.0) == 0.0
