"""Protects: bounded work and memory in a crowd of contacts, and nothing lost outside of it."""

import numpy as np
import pytest

from sonar_tracking.active.contact_tracker import make_contact_tracker
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.multi_target_tracker import MultiTargetTracker
from sonar_tracking.active.tracks.pair_limits import (
    CONTACTS_IN_GATE,
    MAXIMUM_BOXED,
    MAXIMUM_PAIRS,
    few_enough,
    half_widths,
    nearest_in_gates,
)
from sonar_tracking.records.contacts import Contacts
from tests.active.contact_scene import SECOND, confirmed, ping, start


def test_few_contacts_are_all_kept() -> None:
    track = np.repeat(np.arange(50), 40)
    square = np.random.default_rng(1).random(len(track))
    assert np.all(nearest_in_gates(track, square))
    assert np.all(few_enough(track, square, np.zeros(50, dtype=bool)))


def test_a_full_gate_keeps_its_nearest_contacts() -> None:
    counts = np.array([3, 200, 0, 64, 90])
    track = np.repeat(np.arange(5), counts)
    square = np.random.default_rng(2).random(len(track))
    kept = nearest_in_gates(track, square)
    assert np.bincount(track[kept], minlength=5).tolist() == [3, 64, 0, 64, 64]
    for row in (1, 4):
        own = track == row
        assert np.max(square[own & kept]) < np.min(square[own & ~kept])


def test_candidates_give_way_before_confirmed_tracks() -> None:
    n_tracks, each = 12_000, 40
    track = np.repeat(np.arange(n_tracks), each)
    square = np.random.default_rng(3).random(len(track))
    is_confirmed = np.arange(n_tracks) < 5
    kept = few_enough(track, square, is_confirmed)
    counts = np.bincount(track[kept])
    assert np.sum(kept) <= MAXIMUM_PAIRS
    assert set(counts[:5]) == {each}
    assert set(counts[5:]) <= set(CONTACTS_IN_GATE)


def test_boxes_are_searched_as_a_whole_unless_there_are_too_many() -> None:
    counts = np.full(5000, 100)
    assert np.all(half_widths(counts, np.zeros(5000, dtype=bool)) >= counts)
    many = np.full(5000, 5000)
    is_confirmed = np.arange(5000) < 3
    widths = half_widths(many, is_confirmed)
    assert np.all(widths[:3] == 5000)
    assert 2 * np.sum(widths[3:]) <= MAXIMUM_BOXED


@pytest.mark.slow
def test_contacts_in_one_spot_take_bounded_work() -> None:
    """The worst: all gates hold all contacts. The pairs would be millions."""
    generator = np.random.default_rng(4)
    tracker = make_contact_tracker(ContactTrackerConfiguration(sound_speed=0.0))
    assert isinstance(tracker, MultiTargetTracker)
    for number in range(3):
        contacts = Contacts(
            stamp=(100 + 10 * number) * SECOND,
            range=3000.0 + 20.0 * generator.standard_normal(1500),
            azimuth=0.002 * generator.standard_normal(1500),
            amplitude=1.0 + generator.exponential(size=1500),
            range_standard_deviation=20.0,
            azimuth_standard_deviation=0.002,
            detection_threshold=1.0,
            clutter_density=1e-7,
            maximum_range=10_000.0,
        )
        update = tracker.update(contacts)
    assert np.all(np.isfinite(update.tracks.state))


@pytest.mark.slow
def test_a_target_outside_the_crowd_is_followed() -> None:
    generator = np.random.default_rng(5)
    tracker = start("integrated")
    crowd = np.random.default_rng(6)
    for number in range(15):
        usual = ping(number, generator)
        many = 200
        contacts = Contacts(
            stamp=usual.stamp,
            range=np.append(usual.range, 8000.0 + 30.0 * crowd.standard_normal(many)),
            azimuth=np.append(usual.azimuth, -2.0 + 0.004 * crowd.standard_normal(many)),
            amplitude=np.append(usual.amplitude, 1.0 + crowd.exponential(size=many)),
            range_standard_deviation=20.0,
            azimuth_standard_deviation=0.002,
            detection_threshold=1.0,
            clutter_density=usual.clutter_density,
            maximum_range=10_000.0,
        )
        update = tracker.update(contacts)
    states = update.tracks.state[confirmed(update), :2]
    truth = np.array([-3000.0, 4000.0]) + 140.0 * np.array([2.0, -1.0])
    assert np.min(np.linalg.norm(states - truth, axis=1)) < 40.0
