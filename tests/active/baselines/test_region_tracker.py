"""Protects the baseline of regions of interest: births, ends, and its filter beside a Gaussian."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sonar_tracking.active.baselines.region_tracker import RegionTracker, _inside_gates
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.tracks.particle_cloud import ParticleCloud, stacked
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.contacts import Contacts, ContactTrackerUpdate
from tests.active.contact_scene import PUBLISHED
from tests.active.track_scene import contacts_at

SECOND = 1_000_000_000
RANGE = 10.0


def tracker(**values: Any) -> RegionTracker:
    given = {
        **PUBLISHED,
        "sound_speed": 0.0,
        "n_particles": 4000,
        "acceleration_deviation": 0.0,
        **values,
    }
    return RegionTracker(ContactTrackerConfiguration(method="roi_clustering", **given))


def ping(number: int, *contacts: tuple[float, float], **changes: Any) -> Contacts:
    """Return contacts at (range, azimuth), 10 s after those before."""
    values = np.array(contacts, dtype=float).reshape(-1, 2)
    made = Contacts(
        stamp=(100 + 10 * number) * SECOND,
        range=values[:, 0],
        azimuth=values[:, 1],
        amplitude=np.zeros(0),
        range_standard_deviation=RANGE,
        azimuth_standard_deviation=0.005,
        clutter_density=1e-8,
        detection_probability=0.9,
        maximum_range=5000.0,
    )
    return replace(made, **changes)


def run(made: RegionTracker, *pings: list[tuple[float, float]]) -> list[ContactTrackerUpdate]:
    return [made.update(ping(number, *contacts)) for number, contacts in enumerate(pings)]


def test_a_region_that_lasts_for_two_pings_is_a_track() -> None:
    """A region takes two contacts of three pings, and a track two regions one after the other."""
    here = [(2000.0, 0.5)]
    updates = run(tracker(), here, here, here)
    assert [len(update.tracks) for update in updates] == [0, 0, 1]
    assert [update.target_count for update in updates] == [0.0, 0.0, 1.0]
    (track,) = updates[-1].tracks.id
    assert track == 1
    assert updates[-1].tracks.initiated.tolist() == [120.0]
    assert updates[-1].tracks.status.tolist() == [TrackStatus.CONFIRMED]
    assert updates[-1].tracks.state[0, :2] == pytest.approx(
        [2000.0 * np.cos(0.5), 2000.0 * np.sin(0.5)], abs=1.0
    )
    spread = updates[-1].tracks.covariance[0]
    assert np.trace(spread[:2, :2]) == pytest.approx(200.0, rel=0.1)
    assert spread[2, 2] == pytest.approx(1.5**2, rel=0.1)


@pytest.mark.parametrize(
    ("moved", "tracks"),
    [
        (0.0, 1),
        (42.0, 1),  # 3 sqrt(2) deviations of the range from ping to ping: 42.4 m
        (43.0, 0),
    ],
)
def test_regions_follow_each_other_within_three_deviations_of_their_difference(
    moved: float, tracks: int
) -> None:
    stream = [[(2000.0 + moved * number, 0.5)] for number in range(3)]
    assert len(run(tracker(roi_distance=50.0), *stream)[-1].tracks) == tracks


@pytest.mark.parametrize(("apart", "tracks"), [(29.0, 1), (31.0, 2)])
def test_regions_nearer_than_three_deviations_are_one(apart: float, tracks: int) -> None:
    pair = [(2000.0, 0.5), (2000.0 + apart, 0.5)]
    update = run(tracker(roi_distance=0.5), pair, pair, pair)[-1]
    assert len(update.tracks) == tracks


def test_a_track_ends_after_two_pings_without_a_region_and_is_reported_once() -> None:
    here: list[tuple[float, float]] = [(2000.0, 0.5)]
    updates = run(tracker(), here, here, here, here, [], [], [], [])
    statuses = [update.tracks.status.tolist() for update in updates]
    # After one ping without contacts the two before are a region still.
    assert statuses[3:] == [
        [TrackStatus.CONFIRMED],
        [TrackStatus.CONFIRMED],
        [TrackStatus.COASTED],
        [TrackStatus.TERMINATED],
        [],
    ]
    assert updates[5].tracks.updated.tolist() == [130.0]
    assert updates[-2].target_count == 0.0


def test_a_contact_moves_the_cloud_as_it_moves_a_gaussian() -> None:
    here = [(2000.0, 0.0)]
    made = tracker(n_particles=20_000)
    before = run(made, here, here, here)[-1].tracks
    after = made.update(ping(3, (2020.0, 0.0))).tracks
    motion = np.eye(4) + 10.0 * np.eye(4, k=2)
    covariance = motion @ before.covariance[0] @ motion.T
    gain = covariance[0] / (covariance[0, 0] + 100.0)
    expected = motion @ before.state[0] + 20.0 * gain
    assert after.state[0, 0] == pytest.approx(expected[0], abs=1.0)
    assert after.state[0, 2] == pytest.approx(expected[2], abs=0.15)
    assert after.covariance[0, 0, 0] == pytest.approx(covariance[0, 0] * (1.0 - gain[0]), rel=0.2)


def test_clutter_shares_a_contact_with_the_track() -> None:
    """With beta = r / (missed + r): the more clutter, the less the cloud is moved."""
    here = [(2000.0, 0.0)]
    moved = []
    for density in (1e-8, 3e-3, 1e-1):
        made = tracker()
        run(made, here, here, here)
        update = made.update(ping(3, (2030.0, 0.0), clutter_density=density))
        moved.append(float(update.tracks.state[0, 0]) - 2000.0)
    assert moved[0] > 1.3 * moved[1]
    assert moved[1] > 3.0 * abs(moved[2])


def test_a_crowd_starts_no_more_tracks_than_are_kept() -> None:
    many = [(1000.0 + 100.0 * row, 0.5) for row in range(15)]
    made = tracker(maximum_tracks=10, n_particles=50)
    updates = run(made, many, many, many)
    assert len(updates[-1].tracks) == 10
    assert [notice.culprit for notice in updates[-1].notices if notice.culprit != "amplitude"] == [
        "maximum_tracks"
    ]
    assert made.next_id == 11
    updates = run(tracker(maximum_tracks=16, n_particles=50), many, many, many)
    assert len(updates[-1].tracks) == 15
    assert all(notice.culprit != "maximum_tracks" for notice in updates[-1].notices)


def test_contacts_outside_the_gate_have_no_share() -> None:
    here = [(2000.0, 0.0)]
    alone, crowded = tracker(), tracker()
    for made in (alone, crowded):
        run(made, here, here, here)
    first = alone.update(ping(3, (2020.0, 0.0))).tracks.state
    far = [(2020.0, 0.0), (4000.0, 2.0), (2900.0, 0.0), (4500.0, -1.0)]
    second = crowded.update(ping(3, *far)).tracks.state
    assert second[0] == pytest.approx(first[0])


@pytest.mark.parametrize("delay", [0.0, 3.0])
def test_the_gate_is_where_the_track_is_when_sound_reaches_it(delay: float) -> None:
    """A track of one particle, 20 m/s along x; contacts of 10 m, a gate of 4 deviations."""
    cloud = ParticleCloud(np.array([[2000.0, 0.0, 20.0, 0.0]]), np.zeros(1, int), np.ones(1))
    along = [[2000.0 + 20.0 * delay + offset, 0.0] for offset in (-41.0, -39.0, 39.0, 41.0)]
    (inside,) = _inside_gates(stacked(cloud), contacts_at(along, delay))
    assert inside.tolist() == [False, True, True, False]
