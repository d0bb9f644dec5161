"""Protects: two targets side by side keep two tracks, one target keeps one."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.active.contact_tracker import make_contact_tracker
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.contacts import Contacts

DEVIATION = 4.0


def confirmed_after(targets: np.ndarray, n_pings: int, seed: int) -> np.ndarray:
    """Return the positions of the confirmed tracks of resting targets, shape (n, 2)."""
    generator = np.random.default_rng(seed)
    tracker = make_contact_tracker(
        ContactTrackerConfiguration(
            sound_speed=0.0, clutter_density=1e-6, initial_existence=0.05, detection_probability=0.9
        )
    )
    for ping in range(n_pings):
        seen = targets + generator.normal(0.0, DEVIATION, targets.shape)
        contacts = Contacts(
            stamp=10**18 + ping * 10**9,
            range=np.hypot(seen[:, 0], seen[:, 1]),
            azimuth=np.arctan2(seen[:, 1], seen[:, 0]),
            amplitude=np.zeros(0),
            range_standard_deviation=DEVIATION,
            azimuth_standard_deviation=DEVIATION / 200.0,
        )
        tracks = tracker.update(contacts).tracks
    shown = np.isin(tracks.status, (TrackStatus.CONFIRMED, TrackStatus.COASTED))
    return np.asarray(tracks.state[shown, :2])


@pytest.mark.slow
@pytest.mark.parametrize(("separation", "least"), [(8.0, 8), (12.0, 11)])
def test_targets_side_by_side_soon_have_two_tracks(separation: float, least: int) -> None:
    targets = np.array([[200.0, 0.5 * separation], [200.0, -0.5 * separation]])
    held = [len(confirmed_after(targets, 8, seed)) == 2 for seed in range(12)]
    assert np.count_nonzero(held) >= least


@pytest.mark.slow
def test_one_target_keeps_one_track() -> None:
    for seed in range(6):
        positions = confirmed_after(np.array([[200.0, 10.0]]), 25, seed)
        assert len(positions) == 1
        assert np.hypot(*(positions[0] - (200.0, 10.0))) < 1.5 * DEVIATION
