"""Protects births, ends, duplicates and what is shown of tracks, each by its definition."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.detection.detection_levels import prior_weights
from sonar_tracking.active.tracks import track_management
from sonar_tracking.active.tracks.contact_gating import GatePairs
from sonar_tracking.active.tracks.contact_track_list import shown_tracks
from sonar_tracking.active.tracks.motion_modes import MotionModes
from sonar_tracking.active.tracks.track_bank import TrackBank, empty_bank
from sonar_tracking.active.tracks.track_management import (
    ListedTracks,
    duplicates,
    limit_tracks,
    list_tracks,
    listed_rows,
    start_candidates,
    survivors,
)
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import TrackSource
from tests.active.track_scene import COVARIANCE, bank_of, contacts_at

CONFIGURATION = ContactTrackerConfiguration()


def alike(*offsets: list[float], confirmed: bool = False) -> TrackBank:
    """Return tracks at (x, y, vx, vy) around a common state, all with one contact in common."""
    bank = bank_of([[0.0, 0.0]] * len(offsets))
    mean = bank.mean + np.array(offsets)[:, None]
    return replace(bank, mean=mean, confirmed=np.full(len(offsets), confirmed))


def one_contact(count: int) -> GatePairs:
    return GatePairs(np.arange(count), np.zeros(count, dtype=np.intp))


def ended(bank: TrackBank, pairs: GatePairs, weights: FloatArray | None = None) -> list[int]:
    given = np.full((len(pairs.track), 1), 0.9) if weights is None else weights
    return np.flatnonzero(duplicates(bank, pairs, given)).tolist()


def test_tracks_end_at_the_bounds_of_existence_and_variance_and_not_before() -> None:
    # A candidate: one and a half times its beginning after three misses, 1.5 * 0.003 * 0.1^3.
    bank = replace(
        bank_of([[0.0, 0.0]] * 4),
        existence=np.array([4.51e-6, 4.49e-6, 0.6, 0.599]),
        confirmed=np.array([False, False, True, True]),
    )
    alive = survivors(bank, np.zeros(4), 1e4, 0.9, CONFIGURATION)
    assert alive.tolist() == [True, False, True, False]
    wide = bank_of([[0.0, 0.0]] * 3)
    covariance = wide.covariance.copy()
    covariance[:, 0, 0, 0] = [5e5, 6e5, 5e5 + 1.0]
    covariance[:, 0, 1, 1] = 5e5  # the trace of the position may be 1e6
    wide = replace(wide, covariance=covariance)
    assert survivors(wide, np.zeros(3), 1e4, 0.9, CONFIGURATION).tolist() == [True, False, False]


def test_a_candidate_starts_at_its_contact_with_the_next_name() -> None:
    contacts = contacts_at([[1.0, 2.0], [3.0, 4.0]])
    modes = MotionModes(3, 0.0, 0.01, 0.025, 0.9, initial_speed_deviation=3.0)
    weights = prior_weights(0.7)
    bank = start_candidates(contacts, np.array([0.1, 0.2]), 77, 5, modes, modes.mode_prior, weights)
    assert bank.id.tolist() == [5, 6]
    assert bank.existence.tolist() == [0.1, 0.2]
    assert bank.initiated.tolist() == bank.updated.tolist() == [77, 77]
    assert not np.any(bank.confirmed)
    for mode in range(3):
        assert bank.mean[:, mode].tolist() == [[1.0, 2.0, 0.0, 0.0], [3.0, 4.0, 0.0, 0.0]]
        assert bank.covariance[0, mode] == pytest.approx(np.diag([100.0, 50.0, 9.0, 9.0]))
    assert bank.mode_probability == pytest.approx(np.tile([0.8, 0.1, 0.1], (2, 1)))
    assert bank.detection_weight.tolist() == [weights.tolist()] * 2
    assert not np.any(bank.entered) and not np.any(bank.calm) and np.all(bank.shown)


@pytest.mark.parametrize(
    ("offset", "ends"),
    [
        ([0.0, 0.0, 0.0, 0.0], True),
        # One and a half deviations of the difference: of x sqrt(800), y sqrt(1800), vx sqrt(2).
        ([42.0, 0.0, 0.0, 0.0], True),
        ([43.0, 0.0, 0.0, 0.0], False),
        ([0.0, -63.5, 0.0, 0.0], True),
        ([0.0, -64.0, 0.0, 0.0], False),
        ([0.0, 0.0, 2.1, 0.0], True),
        ([0.0, 0.0, 2.15, 0.0], False),
        ([0.0, 0.0, 0.0, 2.95], True),
        ([0.0, 0.0, 0.0, 3.05], False),
        ([35.0, 35.0, 0.0, 0.0], True),  # 1.53 + 0.68 of 2.25
        ([35.0, 40.0, 0.0, 0.0], False),  # 1.53 + 0.89
    ],
)
def test_two_tracks_are_one_within_one_and_a_half_deviations_of_all_their_states(
    offset: list[float], ends: bool
) -> None:
    bank = alike([0.0] * 4, offset)
    assert ended(bank, one_contact(2)) == ([1] if ends else [])
    # It is the difference that counts, not who is first.
    assert ended(alike(offset, [0.0] * 4), one_contact(2)) == ([1] if ends else [])


def test_a_correlation_between_position_and_speed_counts() -> None:
    """Along the line on which errors lie together a large difference is no difference."""
    root = np.eye(4)
    root[0, 2] = 30.0
    covariance = root @ COVARIANCE @ root.T
    for offset, ends in [([60.0, 0.0, 2.0, 0.0], True), ([60.0, 0.0, -2.0, 0.0], False)]:
        bank = alike([0.0] * 4, offset)
        bank = replace(bank, covariance=np.tile(covariance, (2, 1, 1, 1)))
        assert ended(bank, one_contact(2)) == ([1] if ends else [])


def test_only_tracks_that_share_a_contact_and_claim_no_other_are_compared() -> None:
    bank = alike([0.0] * 4, [0.0] * 4)
    apart = GatePairs(np.array([0, 1]), np.array([0, 1]))
    assert ended(bank, apart) == []
    assert ended(bank, GatePairs(np.zeros(0, np.intp), np.zeros(0, np.intp))) == []
    # Both have both contacts in their gates, and each takes its own: two targets side by side.
    both = GatePairs(np.array([0, 0, 1, 1]), np.array([0, 1, 0, 1]))
    own = np.array([[0.9], [0.05], [0.05], [0.9]])
    assert ended(bank, both, own) == []
    same = np.array([[0.9], [0.05], [0.9], [0.05]])
    assert ended(bank, both, same) == [1]
    for undecided in ([0.4, 0.4, 0.05, 0.9], [0.05, 0.9, 0.4, 0.4], [0.5, 0.1, 0.1, 0.5]):
        assert ended(bank, both, np.array(undecided)[:, None]) == [1]


def test_weights_of_modes_count_by_their_probability() -> None:
    bank = replace(
        bank_of([[0.0, 0.0]] * 2, n_modes=2),
        confirmed=np.zeros(2, dtype=bool),
        mode_probability=np.array([[0.9, 0.1], [0.9, 0.1]]),
    )
    both = GatePairs(np.array([0, 0, 1, 1]), np.array([0, 1, 0, 1]))
    # Each takes another contact in its probable mode: 0.9 * 0.7 = 0.63.
    weights = np.array([[0.7, 0.0], [0.0, 0.9], [0.0, 0.9], [0.7, 0.0]])
    assert ended(bank, both, weights) == []


def test_of_many_alike_one_stays() -> None:
    many = alike(*[[0.1 * row, 0.0, 0.0, 0.0] for row in range(80)])
    assert ended(many, one_contact(80)) == list(range(1, 80))
    confirmed = replace(many, confirmed=np.arange(80) == 79)
    assert 79 not in ended(confirmed, one_contact(80))


def test_each_track_is_compared_with_the_next_ones_only_as_far_as_work_is_bounded(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    bank = alike([0.0] * 4, [500.0, 0.0, 0.0, 0.0], [0.0] * 4)
    monkeypatch.setattr(track_management, "COMPARED_TRACKS", 1)
    assert ended(bank, one_contact(3)) == []
    monkeypatch.setattr(track_management, "COMPARED_TRACKS", 2)
    assert ended(bank, one_contact(3)) == [2]


def listed(bank: TrackBank, **changes: list[bool] | list[float]) -> ListedTracks:
    count = len(bank)
    values = {
        "alive": np.ones(count, dtype=bool),
        "was_shown": np.zeros(count, dtype=bool),
        "detected": np.ones(count),
        **{name: np.array(value) for name, value in changes.items()},
    }
    return ListedTracks(bank, **values)


def test_confirmed_tracks_and_likely_candidates_are_shown_and_each_end_once() -> None:
    bank = replace(
        bank_of([[float(row), 0.0] for row in range(7)]),
        existence=np.array([0.95, 0.95, 0.3, 0.1, 0.09, 0.2, 0.95]),
        confirmed=np.array([True, True, False, False, False, False, True]),
        initiated=np.arange(7),
        updated=10 + np.arange(7),
    )
    tracks = listed(
        bank,
        alive=[True, True, True, True, True, False, False],
        was_shown=[True, False, False, False, False, True, False],
        detected=[0.49, 0.51, 0.0, 0.0, 0.0, 0.0, 0.0],
    )
    rows = list_tracks(tracks, listed_rows(tracks, 0.1), None)
    assert rows.id.tolist() == [1, 2, 3, 4, 6]
    assert rows.status.tolist() == [
        TrackStatus.COASTED,
        TrackStatus.CONFIRMED,
        TrackStatus.TENTATIVE,
        TrackStatus.TENTATIVE,
        TrackStatus.TERMINATED,
    ]
    assert rows.state[:, 0].tolist() == [0.0, 1.0, 2.0, 3.0, 5.0]
    assert rows.existence.tolist() == [0.95, 0.95, 0.3, 0.1, 0.2]
    assert (rows.initiated.tolist(), rows.updated.tolist()) == (
        [0, 1, 2, 3, 5],
        [10, 11, 12, 13, 15],
    )


def test_what_is_rather_fixed_than_moving_is_told_as_such() -> None:
    bank = bank_of([[0.0, 0.0]] * 3, n_modes=2)
    probability = np.array([[0.51, 0.49], [0.5, 0.5], [0.01, 0.99]])
    tracks = listed(replace(bank, mode_probability=probability))
    rows = list_tracks(tracks, np.arange(3), 0)
    assert rows.static is not None
    shown = shown_tracks(rows, 1, 2)
    assert shown.source.tolist() == [TrackSource.STATIC, TrackSource.ACTIVE, TrackSource.ACTIVE]
    assert list_tracks(tracks, np.arange(3), None).static is None
    assert shown_tracks(rows.select(slice(0, 1)), 1, 2).source.tolist() == [TrackSource.STATIC]


def test_of_too_many_the_least_probable_end_candidates_first() -> None:
    bank = replace(
        bank_of([[0.0, 0.0]] * 4),
        existence=np.array([0.7, 0.8, 0.5, 0.9]),
        confirmed=np.array([True, False, False, False]),
    )
    before = listed(bank, alive=[True, True, True, False])
    candidates = start_candidates(
        contacts_at([[1.0, 1.0], [2.0, 2.0]]),
        np.array([0.6, 0.4]),
        0,
        9,
        MotionModes(1, 0.0, initial_speed_deviation=8.0),
        np.ones(1),
        prior_weights(np.nan),
    )
    assert limit_tracks(before, candidates, 5) == (before, candidates)
    after, kept = limit_tracks(before, candidates, 3)
    # Worth: 1.7 (confirmed), 0.8, 0.5, and 0.6, 0.4; the fourth has ended before.
    assert after.alive.tolist() == [True, True, False, False]
    assert kept.id.tolist() == [9]
    assert before.alive.tolist() == [True, True, True, False], "the record is not changed"
    after, kept = limit_tracks(before, empty_bank(1), 1)
    assert after.alive.tolist() == [True, False, False, False]
    assert len(kept) == 0
