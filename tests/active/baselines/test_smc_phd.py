"""Protects the particle PHD: its mass by the published recursion, its births, its bounds."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sonar_tracking.active.baselines import smc_phd
from sonar_tracking.active.baselines.smc_phd import DensityTracker
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.records.contacts import Contacts
from tests.active.contact_scene import PUBLISHED

SECOND = 1_000_000_000


def tracker(**values: Any) -> DensityTracker:
    given = {**PUBLISHED, "sound_speed": 0.0, "n_particles": 500, **values}
    return DensityTracker(ContactTrackerConfiguration(method="smc_phd", **given))


def ping(number: int, *contacts: tuple[float, float], **changes: Any) -> Contacts:
    values = np.array(contacts, dtype=float).reshape(-1, 2)
    made = Contacts(
        stamp=(100 + 10 * number) * SECOND,
        range=values[:, 0],
        azimuth=values[:, 1],
        amplitude=np.zeros(0),
        range_standard_deviation=10.0,
        azimuth_standard_deviation=0.005,
        clutter_density=1e-8,
        detection_probability=0.75,
        maximum_range=5000.0,
    )
    return replace(made, **changes)


def test_silence_leaves_what_is_missed_and_survives() -> None:
    """Mass without contacts: (1 - P_D) (0.99 of what was, and 0.2 that is born)."""
    made = tracker()
    mass = 0.0
    for number in range(4):
        mass = 0.25 * (0.99 * mass + 0.2)
        assert made.update(ping(number)).target_count == pytest.approx(mass)


def test_a_contact_that_nothing_but_a_target_explains_counts_as_one() -> None:
    made = tracker()
    first = made.update(ping(0, (2000.0, 0.5))).target_count
    update = made.update(ping(1, (2000.0, 0.5)))
    # Born where the contact before was: the contact is one target, and what is missed.
    missed = 0.25 * (0.99 * first + 0.2)
    assert update.target_count == pytest.approx(1.0 + missed, abs=0.001)
    clutter = made.update(ping(2, (2000.0, 0.5), clutter_density=1.0)).target_count
    assert clutter == pytest.approx(0.25 * (0.99 * update.target_count + 0.2), abs=0.02)


def test_each_contact_adds_its_own_share_whatever_the_portions(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scene = [(2000.0, 0.5), (2000.0, 1.5), (3000.0, -2.0), (1500.0, 3.0)]
    counts = []
    for at_once in (1, 1500, 3_000_000):
        monkeypatch.setattr(smc_phd, "PAIRS_AT_ONCE", at_once)
        made = tracker()
        counts.append([made.update(ping(number, *scene)).target_count for number in range(5)])
    np.testing.assert_allclose(counts[:2], [counts[2]] * 2, atol=0.1)
    assert counts[0][0] == pytest.approx(counts[2][0], rel=1e-9)
    # Four contacts, and a quarter of what was and of what is born: m = 4 + (0.99 m + 0.2) / 4.
    assert counts[0][-1] == pytest.approx(4.05 / 0.7525, abs=0.1)


def test_targets_are_born_all_over_the_survey_until_there_are_contacts() -> None:
    """Evenly over its area; where its range is not told, as far as 10 km."""
    for maximum, reach in ((5000.0, 5000.0), (np.nan, 10_000.0)):
        made = tracker(n_particles=20_000, initial_speed_deviation=0.001)
        made.update(ping(0, maximum_range=maximum, sensor_position=(300.0, -200.0)))
        position = made._cloud.state[:, :2] - [300.0, -200.0]
        distance = np.hypot(position[:, 0], position[:, 1])
        assert np.max(distance) == pytest.approx(reach, rel=0.01)
        assert np.mean(distance**2) == pytest.approx(0.5 * reach**2, rel=0.15)
        assert np.abs(np.mean(position, axis=0)) == pytest.approx([0.0, 0.0], abs=0.1 * reach)


def test_targets_are_born_around_the_contacts_before_and_move_on() -> None:
    made = tracker(n_particles=5000, initial_speed_deviation=2.0)
    made.update(ping(0, (2000.0, 0.0)))
    made.update(ping(1))
    born = made._cloud.state
    near = born[np.max(np.abs(born[:, :2] - [2000.0, 0.0]), axis=1) < 200.0]
    along = near[:, 0] - 10.0 * near[:, 2]
    assert np.std(along) == pytest.approx(10.0, rel=0.15)
    assert np.std(near[:, 1] - 10.0 * near[:, 3]) == pytest.approx(10.0, rel=0.15)
    assert np.std(near[:, 2:]) == pytest.approx(2.0, rel=0.15)


def test_no_more_targets_are_told_apart_than_particles_are_kept_for() -> None:
    many = [(1000.0 + 60.0 * row, 0.1 * row) for row in range(60)]
    made = tracker(n_particles=50)
    for number in range(3):
        update = made.update(ping(number, *many, clutter_density=1e-12))
    assert update.target_count > 51.0
    assert [notice.culprit for notice in update.notices if notice.culprit != "amplitude"] == [
        "target_count"
    ]
    assert len(made._cloud.weight) == 50 * 50
    assert len(update.tracks) <= 100


def test_names_are_given_in_order_and_coasting_keeps_them() -> None:
    made = tracker()
    for number in range(4):
        update = made.update(ping(number, (2000.0, 0.5), (2500.0, 2.0)))
    names = update.tracks.id.tolist()
    assert made.next_id == max(names) + 1
    stamp = (100 + 10 * 4) * SECOND
    coasted = made.coast(stamp, stamp + 1)
    assert set(names) <= set(coasted.tracks.id.tolist())
    assert coasted.target_count == pytest.approx(update.target_count)
