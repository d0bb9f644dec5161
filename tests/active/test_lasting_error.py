"""Protects the split of a contact's error into what is new at each ping and what lasts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.active.contact_tracker import make_contact_tracker
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.lasting_error import CLEAR_SHARE, LastingErrorMonitor
from sonar_tracking.errors import Severity
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.contacts import Contacts, ContactTrackerUpdate

SECOND = 1_000_000_000
RANGE, AZIMUTH = 4.0, 0.02
"""Claimed deviations, m and rad."""

BEGIN = np.array([[300.0, 0.0], [-200.0, 200.0], [0.0, -400.0]])
VELOCITY = np.array([[0.0, 2.0], [1.0, 1.0], [-2.0, 0.0]])


def tracked(
    noise: float, lasting: float, seed: int = 3, pings: int = 60
) -> tuple[list[ContactTrackerUpdate], np.ndarray]:
    """Return what is made of contacts with errors of both kinds, and the last true states.

    Both are shares of the claimed deviations; the lasting ones are drawn once a target.
    """
    generator = np.random.default_rng(seed)
    tracker = make_contact_tracker(ContactTrackerConfiguration(sound_speed=0.0))
    bias = lasting * generator.choice([-1.0, 1.0], (3, 2))
    updates = []
    for number in range(pings):
        position = BEGIN + 2.0 * number * VELOCITY
        error = bias + noise * generator.standard_normal((3, 2))
        distance = np.hypot(position[:, 0], position[:, 1])
        contacts = Contacts(
            stamp=10**18 + 2 * number * SECOND,
            range=distance + RANGE * error[:, 0],
            azimuth=np.arctan2(position[:, 1], position[:, 0]) + AZIMUTH * error[:, 1],
            amplitude=np.zeros(0),
            range_standard_deviation=RANGE,
            azimuth_standard_deviation=AZIMUTH,
            maximum_range=1000.0,
        )
        updates.append(tracker.update(contacts))
    return updates, np.hstack([position, VELOCITY])


def test_errors_that_are_noise_are_taken_for_noise() -> None:
    updates, _ = tracked(1.0, 0.0)
    assert not any(n.culprit == "lasting error" for u in updates for n in u.notices)


@pytest.mark.slow
def test_errors_that_last_stay_in_the_covariances() -> None:
    """The filter would otherwise claim to know a position eight times better than it can."""
    squares = []
    for seed in range(4):
        updates, truth = tracked(0.2, 1.0, seed)
        (notice,) = (n for n in updates[-1].notices if n.culprit == "lasting error")
        assert "covariances" in notice.text
        assert notice.severity is Severity.WARN  # of what is well nothing is shown
        tracks = updates[-1].tracks
        for state, covariance in zip(tracks.state, tracks.covariance, strict=True):
            nearest = truth[np.argmin(np.hypot(*(truth - state)[:, :2].T))]
            error = state - nearest
            squares.append(error[:2] @ np.linalg.solve(covariance[:2, :2], error[:2]) / 2.0)
    assert 0.5 < np.mean(squares) < 1.5


def test_the_share_is_that_of_the_squares() -> None:
    """Median of a chi-square variable of two degrees of freedom: 2 ln 2."""
    unsure = LastingErrorMonitor(squares=np.full(19, 0.1))
    assert unsure.noise_share == 1.0
    for square in (0.1, 0.4):
        monitor = LastingErrorMonitor(squares=np.full(20, square))
        assert monitor.noise_share == pytest.approx(square / (2.0 * np.log(2.0)))
    assert LastingErrorMonitor(squares=np.full(20, 1.4 * CLEAR_SHARE)).noise_share == 1.0
    assert LastingErrorMonitor(squares=np.zeros(20)).noise_share == 1e-3


def test_the_deviations_that_are_used_are_those_of_the_noise() -> None:
    monitor = LastingErrorMonitor(squares=np.full(20, 0.02 * np.log(2.0)))
    contacts = Contacts(
        stamp=1,
        range=np.array([100.0]),
        azimuth=np.zeros(1),
        amplitude=np.zeros(0),
        range_standard_deviation=np.array([4.0]),
        azimuth_standard_deviation=0.02,
    )
    used = monitor.without_it(contacts)
    assert used.range_standard_deviation == pytest.approx([0.4])
    assert used.azimuth_standard_deviation == pytest.approx(0.002)
    assert LastingErrorMonitor().without_it(contacts) is contacts


def test_a_track_that_coasts_is_remembered_and_one_that_ends_is_not() -> None:
    generator = np.random.default_rng(5)
    tracker = make_contact_tracker(ContactTrackerConfiguration(sound_speed=0.0))
    for number in range(40):
        silent = 20 <= number < 23 or number > 30
        distance = 300.0 + 2.0 * number + RANGE * generator.standard_normal(0 if silent else 1)
        contacts = Contacts(
            stamp=10**18 + 2 * number * SECOND,
            range=distance,
            azimuth=np.zeros(len(distance)),
            amplitude=np.zeros(0),
            range_standard_deviation=RANGE,
            azimuth_standard_deviation=AZIMUTH,
            maximum_range=1000.0,
            clutter_density=1e-6,
        )
        update = tracker.update(replace(contacts))
        kept = vars(tracker)["_scene"].lasting.id
        if number == 22:
            assert len(kept) == 1 and update.tracks.status[0] == TrackStatus.COASTED
    assert len(update.tracks) == 0
    assert len(kept) == 0


def test_times_are_counted_from_the_first_ping() -> None:
    """So that they keep the digits that seconds since 1970 would cost them."""
    tracker = make_contact_tracker(ContactTrackerConfiguration(sound_speed=0.0))
    for number in range(12):
        contacts = Contacts(
            stamp=10**18 + 2 * number * SECOND,
            range=np.array([300.0]),
            azimuth=np.zeros(1),
            amplitude=np.zeros(0),
            range_standard_deviation=RANGE,
            azimuth_standard_deviation=AZIMUTH,
            maximum_range=1000.0,
        )
        tracker.update(contacts)
    monitor = vars(tracker)["_scene"].lasting
    assert monitor.start == 10**18
    assert monitor.time.tolist() == [[20.0, 22.0]]
