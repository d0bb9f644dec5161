"""Do the tracks keep their identities? Swaps, losses, false tracks, continuity, delay.

Works on who was assigned to whom in each period, so that it serves bearings and positions alike.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.evaluation.metrics.ospa_gospa import Assignment
from sonar_tracking.records.arrays import BoolArray, IdArray
from sonar_tracking.records.time import seconds

LOST_PERIODS = 5
"""A target without identity for so many periods is lost; a swap that stays so long is lasting."""


@dataclass(frozen=True)
class ScoredPeriod:
    """Assignment of tracks to truths at one instant.

    Attributes
    ----------
    stamp : int
        ns.
    truth_ids, track_ids : tuple of int
        Who is there.
    held : mapping of int to int
        Track assigned to each truth that has one within the cut-off.
    near : frozenset of int
        Tracks within the cut-off of any truth.
    """

    stamp: int
    truth_ids: tuple[int, ...]
    track_ids: tuple[int, ...]
    held: Mapping[int, int]
    near: frozenset[int]


def scored_period(
    stamp: int,
    truth_ids: IdArray,
    track_ids: IdArray,
    assignment: Assignment,
    near: BoolArray,
) -> ScoredPeriod:
    """Return one scored period.

    Parameters
    ----------
    stamp : int
        ns.
    truth_ids, track_ids : ndarray, shape (n_truths,) and (n_tracks,)
        Who is there.
    assignment : Assignment
        Of the rows of one to the rows of the other.
    near : ndarray of bool, shape (n_truths, n_tracks)
        Which are closer than the cut-off.
    """
    truths = tuple(int(identifier) for identifier in truth_ids)
    tracks = tuple(int(identifier) for identifier in track_ids)
    return ScoredPeriod(
        stamp=stamp,
        truth_ids=truths,
        track_ids=tracks,
        held={
            truths[row]: tracks[column]
            for row, column in zip(assignment.truths, assignment.estimates, strict=True)
        },
        near=frozenset(tracks[column] for column in np.flatnonzero(near.any(axis=0))),
    )


@dataclass(frozen=True)
class IdentityScore:
    """How well identities were maintained.

    Attributes
    ----------
    identity_swaps : int
        Times a target's assigned identity differed from its previous one.
    lasting_identity_swaps : int
        Those after which the new identity stayed for ``LOST_PERIODS`` periods; the others are
        exchanges for a moment where two targets are closer than the errors.
    lost_tracks : int
        Times a target that had an identity had none for ``LOST_PERIODS`` periods.
    targets_never_held : int
        Targets that never had an identity.
    held_share : float
        Share of all periods of all targets with an identity.
    continuity, smallest_continuity : float
        Share of a target's life with the identity it has longest: mean and least over targets.
    false_tracks : int
        Identities within the cut-off of a truth for less than half of their life.
    false_tracks_per_hour : float
        Per hour of data.
    confirmation_delay_periods, confirmation_delay : float
        From a target's first appearance to its first identity, inclusive, mean over the targets
        ever tracked; periods and s.
    largest_confirmation_delay : float
        The same of the slowest target, s.
    """

    identity_swaps: int
    lasting_identity_swaps: int
    lost_tracks: int
    targets_never_held: int
    held_share: float
    continuity: float
    smallest_continuity: float
    false_tracks: int
    false_tracks_per_hour: float
    confirmation_delay_periods: float
    confirmation_delay: float
    largest_confirmation_delay: float


def score_identities(
    periods: Sequence[ScoredPeriod], period: float, first_seen: Mapping[int, int]
) -> IdentityScore:
    """Return the identity score.

    Parameters
    ----------
    periods : sequence of ScoredPeriod
        In order of time.
    period : float
        Between them, s.
    first_seen : mapping of int to int
        Stamp of the first appearance of each target, ns.
    """
    tally = IdentityTally()
    for entry in periods:
        tally.add(entry)
    return tally.score(period, first_seen)


class IdentityTally:
    """Counts identities period by period, and keeps nothing of the periods."""

    def __init__(self) -> None:
        self.periods = 0
        self._lives: dict[int, _Life] = {}
        self._track_lives: Counter[int] = Counter()
        self._track_near: Counter[int] = Counter()

    @property
    def targets(self) -> int:
        """Number of different targets."""
        return len(self._lives)

    def add(self, entry: ScoredPeriod) -> None:
        """Count one period, after those before it in time."""
        for target in entry.truth_ids:
            life = self._lives.setdefault(target, _Life())
            life.add(self.periods, entry.stamp, entry.held.get(target))
        self._track_lives.update(entry.track_ids)
        self._track_near.update(entry.near)
        self.periods += 1

    def score(self, period: float, first_seen: Mapping[int, int]) -> IdentityScore:
        """Return the score of the periods so far; see :func:`score_identities`."""
        lives = [self._lives[target] for target in sorted(self._lives)]
        continuities = [life.continuity for life in lives]
        delays = [
            self._lives[target].delay_periods(first_seen[target], period)
            for target in sorted(self._lives)
            if self._lives[target].n_held
        ]
        n_false = self._false_tracks()
        hours = self.periods * period / 3600.0
        return IdentityScore(
            identity_swaps=sum(life.changes for life in lives),
            lasting_identity_swaps=sum(life.lasting_changes for life in lives),
            lost_tracks=sum(life.losses for life in lives),
            targets_never_held=sum(not life.n_held for life in lives),
            held_share=_ratio(
                sum(life.n_held for life in lives), sum(life.n_present for life in lives)
            ),
            continuity=float(np.mean(continuities)) if continuities else np.nan,
            smallest_continuity=min(continuities, default=np.nan),
            false_tracks=n_false,
            false_tracks_per_hour=_ratio(n_false, hours),
            confirmation_delay_periods=float(np.mean(delays)) if delays else np.nan,
            confirmation_delay=float(np.mean(delays)) * period if delays else np.nan,
            largest_confirmation_delay=max(delays, default=np.nan) * period,
        )

    def _false_tracks(self) -> int:
        near, lives = self._track_near, self._track_lives
        return sum(near[track] < 0.5 * lives[track] for track in lives)


class _Life:
    """What became of one target in the periods in which it was there."""

    def __init__(self) -> None:
        self.n_present = self.n_held = self.changes = self.lasting_changes = self.losses = 0
        self._identities: Counter[int] = Counter()
        self._first_held = 0
        self._latest: int | None = None
        self._settled: int | None = None
        self._run = 0
        self._missing = 0
        self._index = -1

    def add(self, index: int, stamp: int, identity: int | None) -> None:
        """Take the identity in the period of an index and a stamp, ns; None = it has none."""
        if index != self._index + 1:
            self._missing = 0  # the target was away: no track could have been maintained
        self._index = index
        self.n_present += 1
        if identity is not None:
            self._missing = 0
            self._hold(stamp, identity)
            return
        self._missing += 1
        self.losses += self.n_held > 0 and self._missing == LOST_PERIODS

    def _hold(self, stamp: int, identity: int) -> None:
        if not self.n_held:
            self._first_held = stamp
        self.n_held += 1
        self._identities[identity] += 1
        if identity != self._latest:
            self.changes += self._latest is not None
            self._latest, self._run = identity, 0
        self._run += 1
        if self._run == LOST_PERIODS:
            self.lasting_changes += self._settled is not None and self._settled != identity
            self._settled = identity

    @property
    def continuity(self) -> float:
        """Share of its life with the identity it has longest."""
        return max(self._identities.values(), default=0) / self.n_present

    def delay_periods(self, first_seen: int, period: float) -> int:
        """Return the periods from its first appearance (stamp, ns) to its first identity."""
        elapsed = seconds(self._first_held - first_seen)
        return int(np.floor(elapsed / period + 1e-6)) + 1 if period > 0.0 else 1


def _ratio(numerator: float, denominator: float) -> float:
    return numerator / denominator if denominator > 0 else np.nan
