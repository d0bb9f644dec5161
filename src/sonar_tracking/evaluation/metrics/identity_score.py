"""Do the tracks keep their identities? Swaps, losses, false tracks, continuity, delay.

Works on who was assigned to whom in each period, so that it serves bearings and positions alike.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise

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
    targets = sorted({target for entry in periods for target in entry.truth_ids})
    lives = {target: _life(periods, target) for target in targets}
    held = {target: [h for h in lives[target].values() if h is not None] for target in targets}
    continuities = [_continuity(lives[target], held[target]) for target in targets]
    delays = [
        _delay_periods(periods, lives[target], first_seen[target], period)
        for target in targets
        if held[target]
    ]
    n_false = _false_tracks(periods)
    hours = len(periods) * period / 3600.0
    n_present = sum(len(life) for life in lives.values())
    return IdentityScore(
        identity_swaps=sum(_changes(held[target]) for target in targets),
        lasting_identity_swaps=sum(_changes(_settled(held[target])) for target in targets),
        lost_tracks=sum(_losses(lives[target]) for target in targets),
        targets_never_held=sum(not held[target] for target in targets),
        held_share=_ratio(sum(len(entries) for entries in held.values()), n_present),
        continuity=float(np.mean(continuities)) if continuities else np.nan,
        smallest_continuity=min(continuities, default=np.nan),
        false_tracks=n_false,
        false_tracks_per_hour=_ratio(n_false, hours),
        confirmation_delay_periods=float(np.mean(delays)) if delays else np.nan,
        confirmation_delay=float(np.mean(delays)) * period if delays else np.nan,
        largest_confirmation_delay=max(delays, default=np.nan) * period,
    )


def _life(periods: Sequence[ScoredPeriod], target: int) -> dict[int, int | None]:
    """Return the identity (or None) in each period, by index, in which the target is there."""
    return {
        index: entry.held.get(target)
        for index, entry in enumerate(periods)
        if target in entry.truth_ids
    }


def _changes(identities: Iterable[int]) -> int:
    return sum(before != after for before, after in pairwise(identities))


def _settled(identities: Iterable[int]) -> list[int]:
    runs = ((identity, len(list(run))) for identity, run in groupby(identities))
    return [identity for identity, length in runs if length >= LOST_PERIODS]


def _losses(life: Mapping[int, int | None]) -> int:
    losses, missing, was_held, previous = 0, 0, False, None
    for index, identity in life.items():
        if previous is not None and index != previous + 1:
            missing = 0  # the target was away: no track could have been maintained
        previous = index
        missing = 0 if identity is not None else missing + 1
        was_held = was_held or identity is not None
        losses += was_held and missing == LOST_PERIODS
    return losses


def _continuity(life: Mapping[int, int | None], held: Sequence[int]) -> float:
    longest = max(Counter(held).values(), default=0)
    return longest / len(life)


def _delay_periods(
    periods: Sequence[ScoredPeriod],
    life: Mapping[int, int | None],
    first_seen: int,
    period: float,
) -> int:
    index = next(index for index, identity in life.items() if identity is not None)
    elapsed = seconds(periods[index].stamp - first_seen)
    return int(np.floor(elapsed / period + 1e-6)) + 1 if period > 0.0 else 1


def _false_tracks(periods: Sequence[ScoredPeriod]) -> int:
    life = Counter(track for entry in periods for track in entry.track_ids)
    near = Counter(track for entry in periods for track in entry.near)
    return sum(near[track] < 0.5 * life[track] for track in life)


def _ratio(numerator: float, denominator: float) -> float:
    return numerator / denominator if denominator > 0 else np.nan
