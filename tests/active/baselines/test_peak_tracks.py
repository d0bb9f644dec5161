"""Protects: peaks of a density maintain their identities, and the end of each is reported."""

import numpy as np
import pytest

from sonar_tracking.active.baselines.peak_tracks import (
    LONGEST_ABSENCE,
    PeakTracks,
    follow_peaks,
    nearest_peaks,
    no_peak_tracks,
    predict_peaks,
)
from sonar_tracking.active.baselines.state_extraction import Peaks
from sonar_tracking.active.tracks.particle_cloud import ParticleCloud
from sonar_tracking.records.bearings import TrackStatus
from tests.active.contact_scene import confirmed, ping, start, target_positions

COVARIANCE = np.diag([400.0, 400.0, 1.0, 1.0])
NO_CLOUD = ParticleCloud(np.zeros((0, 4)), np.zeros(0, dtype=np.int64), np.zeros(0))


def peaks_at(*states: list[float], mass: float = 0.9) -> Peaks:
    count = len(states)
    state = np.array(states, dtype=float).reshape(-1, 4)
    return Peaks(state, np.tile(COVARIANCE, (count, 1, 1)), np.full(count, mass))


def tracks_at(*states: list[float]) -> PeakTracks:
    return follow_peaks(no_peak_tracks(), peaks_at(*states), NO_CLOUD, 0, 1)


def later(tracks: PeakTracks, peaks: Peaks, cloud: ParticleCloud = NO_CLOUD) -> PeakTracks:
    """Return the tracks ten seconds later."""
    first_id = int(np.max(tracks.id)) + 1
    return follow_peaks(predict_peaks(tracks, 10.0, 0.01), peaks, cloud, 10**10, first_id)


def test_a_peak_keeps_its_name_as_it_moves() -> None:
    tracks = tracks_at([0.0, 0.0, 5.0, 0.0], [0.0, 300.0, -5.0, 0.0])
    tracks = later(tracks, peaks_at([-50.0, 300.0, -5.0, 0.0], [52.0, 1.0, 5.0, 0.0]))
    assert tracks.id.tolist() == [1, 2]
    assert tracks.state[:, 0].tolist() == [52.0, -50.0]
    assert np.all(tracks.rows().status == TrackStatus.CONFIRMED)


def test_the_sum_of_distances_decides_not_who_comes_first() -> None:
    """The nearest peak of the first is the only one that the second can have."""
    tracks = tracks_at([0.0, 0.0, 0.0, 0.0], [150.0, 0.0, 0.0, 0.0])
    rows, columns = nearest_peaks(tracks, peaks_at([55.0, 0.0, 0.0, 0.0], [-70.0, 0.0, 0.0, 0.0]))
    assert dict(zip(rows.tolist(), columns.tolist(), strict=True)) == {0: 1, 1: 0}


def test_a_far_peak_is_another_target() -> None:
    tracks = later(tracks_at([0.0, 0.0, 0.0, 0.0]), peaks_at([5000.0, 0.0, 0.0, 0.0]))
    assert tracks.id.tolist() == [1, 2]
    assert tracks.rows().status.tolist() == [TrackStatus.TENTATIVE, TrackStatus.CONFIRMED]


def test_a_missing_peak_is_predicted_and_its_end_is_told_once() -> None:
    tracks = tracks_at([0.0, 0.0, 2.0, -1.0])
    states = []
    for number in range(LONGEST_ABSENCE + 2):
        tracks = follow_peaks(predict_peaks(tracks, 10.0, 0.01), peaks_at(), NO_CLOUD, number, 2)
        if len(tracks):
            assert tracks.state[0, :2] == pytest.approx([20.0 * (number + 1), -10.0 * (number + 1)])
            assert tracks.existence[0] == 0.0
        states += tracks.rows().status.tolist()
    assert states == [TrackStatus.TENTATIVE] * LONGEST_ABSENCE + [TrackStatus.TERMINATED]


def test_a_peak_that_comes_back_in_time_is_the_same() -> None:
    tracks = later(tracks_at([0.0, 0.0, 1.0, 0.0]), peaks_at())
    tracks = later(tracks, peaks_at([20.0, 0.0, 1.0, 0.0]))
    assert tracks.id.tolist() == [1]
    assert tracks.rows().status.tolist() == [TrackStatus.CONFIRMED]


def test_existence_is_the_weight_of_the_peak() -> None:
    tracks = tracks_at([0.0, 0.0, 0.0, 0.0])
    assert tracks.existence.tolist() == [0.9]
    assert later(tracks, peaks_at([0.0, 0.0, 0.0, 0.0], mass=1.3)).existence.tolist() == [1.0]
    particles = np.zeros((10, 4))
    particles[5:, 0] = 5000.0
    cloud = ParticleCloud(particles, np.zeros(10, dtype=np.int64), np.full(10, 0.04))
    assert later(tracks, peaks_at(), cloud).existence == pytest.approx([0.2])


def test_targets_keep_their_names_in_clutter() -> None:
    generator = np.random.default_rng(1)
    tracker = start("smc_phd")
    names: list[set[int]] = [set(), set(), set()]
    n_held = 0
    for number in range(40):
        update = tracker.update(ping(number, generator, targets=3))
        existence = update.tracks.existence_probability
        assert np.all((existence >= 0.0) & (existence <= 1.0))
        rows = confirmed(update)
        if number < 10 or not len(rows):
            continue
        for target, truth in enumerate(target_positions(number, 3)):
            distance = np.linalg.norm(update.tracks.state[rows, :2] - truth, axis=1)
            if np.min(distance) < 100.0:
                names[target].add(int(update.tracks.id[rows[np.argmin(distance)]]))
                n_held += 1
    assert n_held > 75
    assert all(1 <= len(own) <= 2 for own in names)
