"""Protects: tracks from contacts in clutter, their lives and their names."""

from copy import deepcopy
from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.detection.detection_model import make_detection_model
from sonar_tracking.records.bearings import TrackStatus
from tests.active.contact_scene import (
    METHODS,
    NOTHING,
    SECOND,
    WITH_EXISTENCE,
    confirmed,
    ping,
    start,
    target_positions,
)


@pytest.mark.parametrize("method", METHODS)
def test_targets_are_found_and_followed(method: str) -> None:
    generator = np.random.default_rng(1)
    tracker = start(method)
    counts, errors, names = [], [], set()
    for number in range(40):
        update = tracker.update(ping(number, generator, targets=3))
        rows = confirmed(update)
        if number >= 20:
            counts.append(len(rows))
            truth = target_positions(number, 3)
            distance = np.linalg.norm(update.tracks.state[rows, None, :2] - truth[None], axis=2)
            errors.append(np.min(distance, axis=0))
            names.update(update.tracks.id[rows].tolist())
    assert np.mean(counts) == pytest.approx(3.0, abs=0.4)
    assert np.median(errors) < 30.0
    if method in WITH_EXISTENCE:
        assert len(names) == 3


@pytest.mark.parametrize("method", WITH_EXISTENCE)
def test_a_lost_target_coasts_and_is_told_to_have_ended_once(method: str) -> None:
    generator = np.random.default_rng(2)
    tracker = start(method)
    for number in range(20):
        update = tracker.update(ping(number, generator))
    (identity,) = update.tracks.id[confirmed(update)]
    states = []
    for number in range(20, 40):
        update = tracker.update(ping(number, generator, heard=False))
        row = np.flatnonzero(update.tracks.id == identity)
        states += update.tracks.status[row].tolist()
    assert states[0] == TrackStatus.COASTED
    assert states.count(TrackStatus.TERMINATED) == 1
    assert states[-1] == TrackStatus.TERMINATED


@pytest.mark.parametrize("method", METHODS)
def test_clutter_alone_makes_no_lasting_tracks(method: str) -> None:
    generator = np.random.default_rng(3)
    tracker = start(method)
    counts = []
    for number in range(40):
        update = tracker.update(ping(number, generator, heard=False, clutter=10))
        counts.append(len(confirmed(update)))
    assert np.mean(counts) < 0.5


@pytest.mark.parametrize("method", METHODS)
def test_results_are_reproducible(method: str) -> None:
    states = []
    for _ in range(2):
        generator, tracker = np.random.default_rng(4), start(method)
        for number in range(12):
            update = tracker.update(ping(number, generator, targets=2))
        states.append(update.tracks.state)
    assert np.array_equal(states[0], states[1])


@pytest.mark.parametrize("method", METHODS)
def test_each_contact_may_have_its_own_errors(method: str) -> None:
    states = []
    for own in (False, True):
        generator = np.random.default_rng(17)
        tracker = start(method)
        for number in range(15):
            contacts = ping(number, generator)
            if own:
                count = len(contacts.range)
                contacts = replace(
                    contacts,
                    range_standard_deviation=np.full(count, 20.0),
                    azimuth_standard_deviation=np.full(count, 0.002),
                )
            update = tracker.update(contacts)
        states.append(update.tracks.state)
        none = replace(
            contacts,
            stamp=contacts.stamp + 10 * SECOND,
            range=NOTHING,
            azimuth=NOTHING,
            amplitude=NOTHING,
            range_standard_deviation=NOTHING if own else 20.0,
            azimuth_standard_deviation=NOTHING if own else 0.002,
        )
        assert np.all(np.isfinite(tracker.update(none).tracks.state))
    assert np.array_equal(states[0], states[1])


def test_two_tracks_of_one_target_become_one() -> None:
    """Contacts that come in pairs start two candidates; only one may live."""
    generator = np.random.default_rng(14)
    tracker = start("integrated")
    for number in range(25):
        contacts = ping(number, generator, clutter=0)
        twice = replace(
            contacts,
            range=np.repeat(contacts.range, 2) + np.array([0.0, 3.0]),
            azimuth=np.repeat(contacts.azimuth, 2),
            amplitude=np.repeat(contacts.amplitude, 2),
        )
        update = tracker.update(twice)
    assert len(confirmed(update)) == 1


def test_thresholds_in_gates_follow_their_size() -> None:
    generator = np.random.default_rng(15)
    tracker = start("integrated", gate_threshold="closed_form", search_false_alarm_probability=0.01)
    for number in range(20):
        contacts = replace(
            ping(number, generator),
            clutter_density=np.nan,
            false_alarm_probability=0.05,
            detection_threshold=-np.log(0.05),
            signal_to_noise_ratio_linear=10.0,
            range_resolution=2.0,
            azimuth_resolution=2e-4,
        )
        contacts = replace(contacts, amplitude=contacts.amplitude + 6.0)
        update = tracker.update(contacts)
    thresholds = update.thresholds
    assert thresholds.track_id.tolist() == update.tracks.id[confirmed(update)].tolist()
    assert np.all(thresholds.resolution_cells > 100.0)
    assert np.all(thresholds.false_alarm_probability < 0.01)
    assert thresholds.threshold == pytest.approx(-np.log(thresholds.false_alarm_probability))
    assert thresholds.search_threshold == pytest.approx(-np.log(0.01))


@pytest.mark.parametrize("method", METHODS)
def test_identifiers_begin_where_they_are_told_and_never_repeat(method: str) -> None:
    generator = np.random.default_rng(18)
    first = 1 + (1 << 32)
    tracker = start(method, first_id=first)
    for number in range(15):
        update = tracker.update(ping(number, generator))
    assert np.all(update.tracks.id >= first)
    assert tracker.next_id > np.max(update.tracks.id)


@pytest.mark.parametrize("method", METHODS)
def test_thresholds_are_told_for_every_ping(method: str) -> None:
    generator = np.random.default_rng(21)
    tracker = start(method)
    for number in range(15):
        update = tracker.update(ping(number, generator))
        assert update.thresholds.stamp == update.tracks.stamp
        assert update.thresholds.method == "as_detected"
        assert update.thresholds.search_threshold == 1.0
    if method in WITH_EXISTENCE:
        assert update.thresholds.track_id.tolist() == update.tracks.id[confirmed(update)].tolist()
        assert np.all(update.thresholds.threshold == 1.0)


def test_a_sector_is_no_full_circle() -> None:
    """Clutter is expected, and counted, in what is surveyed."""
    contacts = replace(
        ping(0, np.random.default_rng(22)),
        clutter_density=1e-6,
        maximum_range=2000.0,
        minimum_range=1000.0,
        azimuth_width=np.pi / 2.0,
    )
    model, _ = make_detection_model(contacts, ContactTrackerConfiguration())
    assert model.expected_clutter() == pytest.approx(1e-6 * np.pi / 4.0 * 3e6)
    counted, _ = make_detection_model(
        replace(contacts, clutter_density=np.nan), ContactTrackerConfiguration()
    )
    assert counted.expected_clutter() == pytest.approx(len(contacts.range))


@pytest.mark.slow
@pytest.mark.parametrize("method", METHODS)
def test_what_is_shown_stays_until_its_end_is_told_once(method: str) -> None:
    """Tentative tracks as well: the end of each is reported."""
    generator = np.random.default_rng(26)
    tracker = start(method, tentative_probability=0.01)
    shown: set[int] = set()
    ended: set[int] = set()
    for number in range(60):
        tracks = tracker.update(ping(number, generator, clutter=60)).tracks
        listed = {int(name) for name in tracks.id}
        assert shown <= listed
        assert not ended & listed
        gone = {int(name) for name in tracks.id[tracks.status == TrackStatus.TERMINATED]}
        ended |= gone
        shown = listed - gone
    assert len(ended) > 3


@pytest.mark.parametrize("method", WITH_EXISTENCE)
def test_a_track_that_gives_way_to_a_crowd_is_told_to_have_ended(method: str) -> None:
    """Where there are more tracks than allowed, too, the end of each is reported."""
    generator = np.random.default_rng(27)
    tracker = start(method, maximum_tracks=10, tentative_probability=1e-6)
    shown: set[int] = set()
    ended: set[int] = set()
    for number in range(30):
        tracks = tracker.update(ping(number, generator, clutter=60)).tracks
        listed = {int(name) for name in tracks.id}
        assert shown <= listed
        gone = {int(name) for name in tracks.id[tracks.status == TrackStatus.TERMINATED]}
        assert not ended & listed
        ended |= gone
        shown = listed - gone
        assert len(shown) <= 10
    assert ended


@pytest.mark.slow
@pytest.mark.parametrize("method", WITH_EXISTENCE)
def test_thresholds_may_change_between_pings_without_losing_tracks(method: str) -> None:
    generator = np.random.default_rng(7)
    pings = [ping(number, generator, clutter=20) for number in range(30)]
    usual, same, changed = start(method), start(method), start(method)
    for each in pings[:20]:
        before, *_ = (t.update(each).tracks for t in (usual, same, changed))
    same.configuration = replace(same.configuration)
    changed.configuration = replace(changed.configuration, tentative_probability=1.0)
    (target,) = before.id[before.status == TrackStatus.CONFIRMED]
    for each in pings[20:]:
        expected, found, strict = (t.update(each).tracks for t in (usual, same, changed))
        assert found.state.tobytes() == expected.state.tobytes()
        assert target in strict.id
        # What has been shown before is shown to its end; no other candidate is likely enough.
        assert set(strict.id[strict.status == TrackStatus.TENTATIVE]) <= set(before.id)


def test_a_track_is_updated_by_a_contact_that_is_likelier_its_own_than_not() -> None:
    """And coasts with all others: contacts ever farther from where it is, in dense clutter."""
    generator = np.random.default_rng(29)
    tracker = start("integrated")
    for number in range(20):
        update = tracker.update(ping(number, generator, clutter=0))
    stamp, (row,) = float(update.tracks.updated[-1]), confirmed(update)
    near = replace(ping(20, generator, clutter=0), clutter_density=2e-3)
    updated = []
    for offset in np.arange(0.0, 60.0, 4.0):
        tracks = deepcopy(tracker).update(replace(near, range=near.range + offset)).tracks
        updated.append(tracks.updated[row] > stamp)
        assert updated[-1] == (tracks.status[row] == TrackStatus.CONFIRMED)
    assert updated == sorted(updated, reverse=True)
    assert updated[0] and not updated[-1]
