"""What an operator does to tracks of contacts: it holds, is reported once, harms no other track."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.active.contact_tracker import CommandedTracker
from sonar_tracking.active.multi_target_tracker import MultiTargetTracker
from sonar_tracking.errors import InputError
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.contacts import ContactTrackerUpdate
from tests.active.contact_scene import (
    METHODS,
    WITH_EXISTENCE,
    confirmed,
    ping,
    start,
    target_positions,
)

AT = 16
"""Ping before which the operator does something."""


def started(
    method: str, targets: int = 2, pings: int = AT
) -> tuple[MultiTargetTracker, np.random.Generator]:
    """Return a tracker that has seen some pings, and the randomness of the others."""
    tracker, generator = start(method), np.random.default_rng(7)
    assert isinstance(tracker, MultiTargetTracker)
    for number in range(pings):
        tracker.update(ping(number, generator, targets=targets))
    return tracker, generator


def names(update: ContactTrackerUpdate, number: int, targets: int = 2) -> list[int]:
    """Return the identifier of the confirmed track nearest to each target."""
    rows = confirmed(update)
    truth = target_positions(number, targets)
    apart = np.linalg.norm(update.tracks.state[rows, None, :2] - truth, axis=2)
    assert len(rows) >= targets and apart.min(axis=0).max() < 200.0
    return [int(update.tracks.id[rows[row]]) for row in apart.argmin(axis=0)]


def ended(update: ContactTrackerUpdate) -> list[int]:
    return update.tracks.id[update.tracks.status == TrackStatus.TERMINATED].tolist()


def rest(
    tracker: MultiTargetTracker, generator: np.random.Generator, targets: int = 2
) -> list[ContactTrackerUpdate]:
    return [tracker.update(ping(n, generator, targets=targets)) for n in range(AT, AT + 8)]


@pytest.mark.parametrize("method", WITH_EXISTENCE)
def test_an_ended_track_is_reported_once_and_its_target_gets_a_new_one(method: str) -> None:
    first, second = names(rest(*started(method))[0], AT)
    tracker, generator = started(method)
    tracker.end_track(second)
    after = rest(tracker, generator)
    assert second in ended(after[0])
    assert all(second not in each.tracks.id for each in after[1:])
    found = names(after[-1], AT + 7)
    assert found[0] == first and found[1] > second


@pytest.mark.parametrize("method", WITH_EXISTENCE)
def test_a_started_track_is_confirmed_at_once_and_takes_the_echoes_there(method: str) -> None:
    tracker, generator = started(method, pings=1)
    new = tracker.next_id
    x, y = target_positions(1, 1)[0]
    tracker.start_track((x + 60.0, y - 40.0))
    for number in range(1, 8):
        update = tracker.update(ping(number, generator))
        assert new in update.tracks.id[confirmed(update)]
    assert names(update, 7, targets=1) == [new]


@pytest.mark.slow
@pytest.mark.parametrize("method", WITH_EXISTENCE)
def test_a_track_that_is_started_where_nothing_is_ends(method: str) -> None:
    tracker, generator = started(method)
    new = tracker.next_id
    tracker.start_track((-5000.0, -5000.0))
    statuses = []
    for number in range(AT, AT + 60):
        update = tracker.update(ping(number, generator, targets=2, clutter=0))
        statuses += update.tracks.status[update.tracks.id == new].tolist()
    assert statuses[-1] == TrackStatus.TERMINATED
    assert len(names(update, AT + 59)) == 2


@pytest.mark.parametrize("method", WITH_EXISTENCE)
def test_of_two_that_are_merged_the_first_name_goes_on(method: str) -> None:
    first, second = names(rest(*started(method))[0], AT)
    tracker, generator = started(method)
    tracker.merge_tracks(second, first)
    after = rest(tracker, generator)
    assert first in ended(after[0])
    assert second in after[0].tracks.id[confirmed(after[0])]
    assert all(first not in each.tracks.id for each in after[1:])
    assert all(np.all(np.diff(each.tracks.id[confirmed(each)].astype(int)) > 0) for each in after)


def test_over_a_ping_that_cannot_be_used_the_end_is_reported_too() -> None:
    _, second = names(rest(*started("integrated"))[0], AT)
    tracker, _ = started("integrated")
    tracker.end_track(second)
    assert second in ended(tracker.coast((100 + 10 * AT) * 10**9, 0))


@pytest.mark.slow
def test_what_cannot_be_done_changes_nothing() -> None:
    empty = start("integrated")
    assert isinstance(empty, CommandedTracker)
    with pytest.raises(InputError, match="no ping has come yet"):
        empty.start_track((0.0, 0.0))
    tracker, generator = started("integrated")
    for place in ((np.nan, 0.0), (0.0, np.inf), (1e12, 0.0)):
        with pytest.raises(InputError, match="give coordinates in map"):
            tracker.start_track(place)
    with pytest.raises(InputError, match="there is no track 999999; there are"):
        tracker.end_track(999_999)
    first, _ = names(rest(*started("integrated"))[0], AT)
    for pair in ((first, 999_999), (999_999, first)):
        with pytest.raises(InputError, match="there is no track 999999"):
            tracker.merge_tracks(*pair)
    for found, expected in zip(rest(tracker, generator), rest(*started("integrated")), strict=True):
        assert np.array_equal(found.tracks.id, expected.tracks.id)
        assert np.array_equal(found.tracks.state, expected.tracks.state)


def test_trackers_without_names_take_no_commands() -> None:
    others = set(METHODS) - set(WITH_EXISTENCE)
    assert others and not any(isinstance(start(one), CommandedTracker) for one in others)
    assert all(isinstance(start(one), CommandedTracker) for one in WITH_EXISTENCE)
