"""Protects how bearings of successive covariances are joined: gates, misses, starts of tracks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.filtering.constant_velocity import process_noise_matrix
from sonar_tracking.passive.track_start import bearing_start
from sonar_tracking.passive.track_start.bearing_start import BearingStart
from sonar_tracking.passive.track_start.tentative_track import StartedTrack
from sonar_tracking.records.bearings import SubspaceEstimates
from tests.passive.crossing_scene import FREQUENCY, POSITIONS, SAMPLE_PERIOD, SOUND_SPEED

SECOND = 1_000_000_000
HALF = SECOND // 2
VARIANCE = 1e-8
FASTEST = np.radians(5.0)
NOTHING = np.empty(0)


def estimates(stamp: int) -> SubspaceEstimates:
    """Return estimates whose covariance of a hundred snapshots ends at the stamp."""
    return SubspaceEstimates(
        stamp=stamp,
        method="covariance",
        basis=np.zeros((1, 15, 5), dtype=complex),
        time_offsets=np.zeros(1),
        element_positions=POSITIONS,
        sample_period=SAMPLE_PERIOD,
        center_frequency=FREQUENCY,
        bandwidth=10.0,
        sound_speed=SOUND_SPEED,
        effective_snapshots=100.0,
        covariance=np.eye(15, dtype=complex),
        covariance_snapshots=100,
        covariance_time_offset=-0.25,
    )


class Feed:
    """Feeds a start with bearings, one list every half a second."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, process_noise: float = 0.0) -> None:
        self.start = BearingStart(process_noise, FASTEST, next_id=7)
        self.stamp = 0
        self._bearings: Sequence[float] = ()
        monkeypatch.setattr(bearing_start, "new_bearings", self._given)

    def _given(self, *_: object) -> tuple[np.ndarray, np.ndarray]:
        return np.array(self._bearings, float), np.full(len(self._bearings), VARIANCE)

    def __call__(
        self, *bearings: float, tracked: int = 0, n_seen: int | None = None, step: int = HALF
    ) -> tuple[StartedTrack, ...]:
        self._bearings = bearings
        self.stamp += step
        self.start, started = self.start.update(
            estimates(self.stamp), np.full(tracked, 1.5), n_seen
        )
        return started

    @property
    def lengths(self) -> dict[int, int]:
        """Number of bearings joined, by identifier."""
        return {track.id: len(track.stamps) for track in self.start.tentative}


@pytest.fixture
def feed(monkeypatch: pytest.MonkeyPatch) -> Feed:
    return Feed(monkeypatch)


@pytest.mark.parametrize(("turned_deg", "joined"), [(2.49, True), (-2.49, True), (2.51, False)])
def test_a_second_bearing_lies_as_far_as_the_fastest_gets(
    feed: Feed, turned_deg: float, joined: bool
) -> None:
    """5 deg/s for half a second."""
    feed(0.1)
    feed(0.1 + np.radians(turned_deg))
    assert feed.lengths == ({7: 2} if joined else {7: 1, 8: 1})


@pytest.mark.parametrize(("deviations", "joined"), [(3.9, True), (-3.9, True), (4.1, False)])
def test_the_third_one_lies_on_the_line_of_the_two_before(
    feed: Feed, deviations: float, joined: bool
) -> None:
    """Two equal errors one step apart predict the next with five times their variance."""
    feed(0.10)
    feed(0.11)
    feed(0.12 + deviations * np.sqrt(6.0 * VARIANCE))
    assert feed.lengths == ({7: 3} if joined else {7: 2, 8: 1})


def test_a_motion_that_is_not_straight_widens_the_gate(monkeypatch: pytest.MonkeyPatch) -> None:
    density = 1e-6
    for deviations, joined in [(3.9, True), (4.1, False)]:
        feed = Feed(monkeypatch, density)
        feed(0.10)
        feed(0.11)
        # The first bearing is a second old.
        spread = 6.0 * VARIANCE + process_noise_matrix(density, 1.0)[0, 0]
        feed(0.12 + deviations * np.sqrt(spread))
        assert feed.lengths == ({7: 3} if joined else {7: 2, 8: 1})


def test_one_miss_is_forgiven_and_two_in_a_row_are_not(feed: Feed) -> None:
    feed(0.1)
    feed()
    feed(0.1)
    feed()
    assert feed.lengths == {7: 2}
    feed()
    assert feed.lengths == {}


def test_four_bearings_start_a_track_on_their_line(monkeypatch: pytest.MonkeyPatch) -> None:
    feed = Feed(monkeypatch, 1e-6)
    assert [feed(0.10 + 0.01 * number) for number in range(3)] == [()] * 3
    (track,) = feed(0.13)
    assert track.id == 7
    # At the stamp, a quarter of a second after the middle of the last covariance.
    assert track.mean == pytest.approx([0.135, 0.02])
    # Four equal errors at -1.75, -1.25, -0.75, -0.25 s before it; and 1.75 s of acceleration.
    design = np.stack([np.ones(4), [-1.75, -1.25, -0.75, -0.25]], axis=1)
    expected = VARIANCE * np.linalg.inv(design.T @ design) + process_noise_matrix(1e-6, 1.75)
    assert track.covariance == pytest.approx(expected)
    assert feed.lengths == {}
    feed(0.5)
    assert feed.lengths == {8: 1}, "its name is not given again"


def test_as_many_start_as_are_missing(feed: Feed) -> None:
    """Five sources are looked for; three are seen by running tracks, and two may start."""
    for _ in range(3):
        feed(0.1, 0.3, 0.5, tracked=3)
    assert len(feed(0.1, 0.3, 0.5, tracked=3)) == 2
    assert list(feed.lengths.values()) == [4]
    # Tracks that run but see no source leave room for the sources that are seen.
    assert len(feed(0.1, 0.3, 0.5, tracked=3, n_seen=2)) == 1


def test_where_nothing_is_missing_nothing_is_remembered(feed: Feed) -> None:
    feed(0.1)
    assert feed(0.1, tracked=5) == ()
    assert feed.lengths == {}


def test_an_array_of_fifteen_follows_fourteen_at_most(monkeypatch: pytest.MonkeyPatch) -> None:
    feed = Feed(monkeypatch)
    for _ in range(4):
        started = feed(0.1, 0.3, tracked=13, n_seen=0)
    assert len(started) == 1


def test_covariances_with_common_snapshots_are_not_joined(feed: Feed) -> None:
    feed(0.1)
    feed(0.1, step=HALF - SECOND // 100)
    assert feed.lengths == {7: 1}
    feed(0.1, step=SECOND // 100)
    assert feed.lengths == {7: 2}


def test_bearings_go_to_the_tracks_with_the_least_sum_of_distances(feed: Feed) -> None:
    feed(0.100, 0.120)
    feed(0.121, 0.141)
    assert [track.angles for track in feed.start.tentative] == [(0.100, 0.121), (0.120, 0.141)]


def test_without_a_covariance_nothing_changes(feed: Feed) -> None:
    feed(0.1)
    before = feed.start
    empty = replace(estimates(feed.stamp + HALF), covariance=None)
    assert feed.start.update(empty, NOTHING) == (before, ())
