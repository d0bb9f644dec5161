"""Protects: scenes that are computed at once give what each of them gives by itself."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest

from sonar_tracking.active.contacts.contact_checks import origin_of
from sonar_tracking.active.contacts.contact_positions import place_contacts
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.multi_target_tracker import (
    MultiTargetTracker,
    hpda_kalman_tracker,
    hpda_particle_tracker,
    integrated_tracker,
    update_together,
)
from sonar_tracking.active.tracks.scene_rows import joined_tables
from sonar_tracking.active.tracks.shared_pings import SharedPings
from sonar_tracking.errors import InputError
from sonar_tracking.evaluation.studies.multi_target_clutter.scene import (
    SceneOptions,
    simulate_scene,
)
from sonar_tracking.records.contacts import Contacts, ContactTrackerUpdate

MAKERS = {
    "integrated": integrated_tracker,
    "hpda_kalman": hpda_kalman_tracker,
    "hpda_particle": hpda_particle_tracker,
}
CONFIGURATION = ContactTrackerConfiguration(sound_speed=0.0, n_particles=50)
VARIANTS = {
    "defaults": CONFIGURATION,
    "turning": replace(CONFIGURATION, motion="turning"),
    "few tracks": replace(CONFIGURATION, maximum_tracks=12),
    "hpda": replace(CONFIGURATION, method="hpda_kalman"),
    "particles": replace(CONFIGURATION, method="hpda_particle"),
}


def scenes(environment: int = 1, n_pings: int = 25) -> list[list[Contacts]]:
    """Return scenes with other targets, other contacts and in part other errors."""
    runs = []
    for number in range(4):
        seed = np.random.SeedSequence((3, number))
        pings = [ping.contacts for ping in simulate_scene(SceneOptions(environment), seed, n_pings)]
        runs.append(pings)
    quiet = np.zeros(len(runs[1][7].range), dtype=bool)
    runs[1][7] = runs[1][7].selected(quiet)
    # Errors that are claimed too large, and clutter that is claimed too small.
    runs[2] = [replace(ping, range_standard_deviation=300.0) for ping in runs[2]]
    runs[3] = [replace(ping, clutter_density=1e-9) for ping in runs[3]]
    return runs


def trackers(configuration: ContactTrackerConfiguration, count: int) -> list[MultiTargetTracker]:
    return [MAKERS[configuration.method](configuration) for _ in range(count)]


def assert_same(one: ContactTrackerUpdate, other: ContactTrackerUpdate) -> None:
    assert (one.target_count, one.notices) == (other.target_count, other.notices)
    for name in ("tracks", "thresholds"):
        first, second = getattr(one, name), getattr(other, name)
        for field in fields(first):
            np.testing.assert_array_equal(getattr(first, field.name), getattr(second, field.name))


@pytest.mark.slow
@pytest.mark.parametrize("name", VARIANTS)
def test_each_scene_is_as_by_itself_bit_for_bit(name: str) -> None:
    configuration, runs = VARIANTS[name], scenes()
    alone, together = trackers(configuration, len(runs)), trackers(configuration, len(runs))
    for pings in zip(*runs, strict=True):
        updates = update_together(together, pings)
        for tracker, contacts, update in zip(alone, pings, updates, strict=True):
            assert_same(tracker.update(contacts), update)


@pytest.mark.slow
def test_the_scenes_are_not_all_alike() -> None:
    """So that what is said of one is not taken for all."""
    runs = scenes(n_pings=60)
    together = trackers(CONFIGURATION, len(runs))
    told: list[set[str]] = [set() for _ in runs]
    for pings in zip(*runs, strict=True):
        for notices, update in zip(told, update_together(together, pings), strict=True):
            notices |= {notice.culprit for notice in update.notices}
    assert "clutter" in told[3] and "clutter" not in told[0]
    assert "lasting error" in told[2] and "lasting error" not in told[0]


@pytest.mark.slow
def test_scenes_with_pings_at_other_times_are_as_by_themselves() -> None:
    runs = scenes(n_pings=8)
    runs[1] = [replace(ping, stamp=ping.stamp + 3 * 10**9 * k) for k, ping in enumerate(runs[1])]
    alone, together = trackers(CONFIGURATION, len(runs)), trackers(CONFIGURATION, len(runs))
    for pings in zip(*runs, strict=True):
        updates = update_together(together, pings)
        for tracker, contacts, update in zip(alone, pings, updates, strict=True):
            assert_same(tracker.update(contacts), update)


@pytest.mark.slow
def test_a_ping_that_cannot_be_used_changes_no_scene() -> None:
    runs = scenes(n_pings=10)
    alone, together = trackers(CONFIGURATION, len(runs)), trackers(CONFIGURATION, len(runs))
    for number, pings in enumerate(zip(*runs, strict=True)):
        if number == 5:
            bad = (*pings[:3], replace(pings[3], stamp=1))
            with pytest.raises(InputError, match="not later"):
                update_together(together, bad)
        updates = update_together(together, pings)
        for tracker, contacts, update in zip(alone, pings, updates, strict=True):
            assert_same(tracker.update(contacts), update)


@pytest.mark.slow
def test_contacts_placed_for_another_tracker_give_the_same_tracks() -> None:
    """Also where one tracker believes other errors of the contacts than the first one."""
    runs = scenes()
    runs[0] = [replace(ping, azimuth_standard_deviation=np.radians(20.0)) for ping in runs[0]]
    told = replace(CONFIGURATION, motion="turning", detection_probability=0.9)
    kinds = [trackers(each, len(runs)) for each in (CONFIGURATION, told)]
    alone = [trackers(each, len(runs)) for each in (CONFIGURATION, told)]
    shared = SharedPings()
    for pings in zip(*runs, strict=True):
        for together, by_themselves in zip(kinds, alone, strict=True):
            updates = update_together(together, pings, shared)
            for one, other in zip(updates, update_together(by_themselves, pings), strict=True):
                assert_same(one, other)


def test_a_ping_is_checked_and_described_once_for_trackers_that_fill_in_the_same() -> None:
    shared, (early, late, *_) = SharedPings(), scenes()[0]
    assert shared.check(early, None) is shared.check(early, None)
    with pytest.raises(InputError, match="not later"):
        shared.check(early, origin_of(late))
    known = shared.model(early, CONFIGURATION)
    assert shared.model(early, replace(CONFIGURATION, motion="turning")) is known
    other, _ = shared.model(early, replace(CONFIGURATION, outlier_share=0.3))
    assert (known[0].outlier_share, other.outlier_share) == (CONFIGURATION.outlier_share, 0.3)
    assert shared.check(late, origin_of(early))[0] is late
    assert shared.model(early, CONFIGURATION) is not known, "older pings are forgotten"


def test_only_pings_that_differ_are_placed_anew() -> None:
    shared, (early, late, *_) = SharedPings(), scenes()[0]
    late = replace(late, stamp=early.stamp)
    first = shared.place_together([early, late], 0.0)
    assert shared.place_together([early, late], 0.0) is first
    wider = replace(late, range_standard_deviation=300.0)
    again = shared.place_together([early, wider], 0.0)
    both = joined_tables([place_contacts(early, 0.0), place_contacts(wider, 0.0)])
    for field in fields(both):
        assert np.array_equal(getattr(again, field.name), getattr(both, field.name))
    assert shared.place_together([early, late], 0.0) is first
    slow = replace(early, sensor_velocity=(1.0, 0.0))
    expected = place_contacts(slow, 1500.0)
    assert np.array_equal(shared.place(slow, 1500.0).position, expected.position)
    assert np.array_equal(shared.place(late, 0.0).distance, place_contacts(late, 0.0).distance)


def test_another_number_of_scenes_at_one_time_is_placed_anew() -> None:
    shared, (early, late, *_) = SharedPings(), scenes()[0]
    late = replace(late, stamp=early.stamp)
    shared.place_together([early, late], 0.0)
    alone, expected = (
        shared.place_together([early], 0.0),
        joined_tables([place_contacts(early, 0.0)]),
    )
    for field in fields(expected):
        assert np.array_equal(getattr(alone, field.name), getattr(expected, field.name))
