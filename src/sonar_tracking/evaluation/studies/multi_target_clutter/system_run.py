"""What one tracker did in one run, against the truth; all pings of the run are compared at once."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sonar_tracking.evaluation.metrics.identity_score import (
    IdentityScore,
    ScoredPeriod,
    score_identities,
)
from sonar_tracking.evaluation.metrics.ospa_gospa import Assignment, assign, gospa, ospa
from sonar_tracking.evaluation.studies.multi_target_clutter.scene import PING_INTERVAL
from sonar_tracking.records.arrays import FloatArray, IndexArray
from sonar_tracking.records.contacts import ContactTrackerUpdate
from sonar_tracking.records.time import seconds
from sonar_tracking.simulation.sensors.contact_simulation import SimulatedPing

CUTOFF = 200.0
ORDER = 2.0

SETTLED_PINGS = 20
"""Age from which an error counts as settled."""


@dataclass(frozen=True)
class SystemRun:
    """What one tracker did in one run.

    Attributes
    ----------
    count : ndarray, shape (n_pings,)
        Count of targets it believes in; the mass of a density.
    n_estimates : ndarray, shape (n_pings,)
        Count of confirmed tracks.
    ospa, gospa : ndarray, shape (n_pings,)
        m, cut-off 200 m, order 2.
    square_error : ndarray, shape (n_held,)
        Of all assigned pairs, m^2.
    settled_square_error : ndarray, shape (n_settled,)
        Of tracks older than 20 pings, m^2.
    identities : IdentityScore
        Of no meaning for trackers without identities.
    seconds : float
        Processor time a ping of a tracker by itself, s; NaN = not measured.
    estimates : tuple of ndarray, shape (n_estimates, 3)
        Identity, x and y at each ping, m.
    """

    count: FloatArray
    n_estimates: FloatArray
    ospa: FloatArray
    gospa: FloatArray
    square_error: FloatArray
    settled_square_error: FloatArray
    identities: IdentityScore
    seconds: float
    estimates: tuple[FloatArray, ...]


def scored_run(
    pings: Sequence[SimulatedPing], updates: Sequence[ContactTrackerUpdate], seconds: float
) -> SystemRun:
    """Return the score of one tracker in one run.

    Parameters
    ----------
    pings : sequence of SimulatedPing
        The run.
    updates : sequence of ContactTrackerUpdate
        What the tracker made of it, one a ping.
    seconds : float
        Processor time a ping, s.
    """
    truths = _Rows.of([ping.target_id for ping in pings], [ping.state for ping in pings])
    estimates, age = _estimates(updates)
    pairs = _paired(truths, estimates)
    square = pairs.distance[pairs.assigned] ** 2
    settled = age[pairs.estimate[pairs.assigned]] >= SETTLED_PINGS
    assignments = _assignments(pairs, truths, estimates)
    stamps = [update.tracks.stamp for update in updates]
    periods = _periods(pairs, truths, estimates, stamps)
    shown = identified(estimates.id, estimates.state)
    return SystemRun(
        count=np.array([update.target_count for update in updates]),
        n_estimates=np.diff(estimates.bounds).astype(np.float64),
        ospa=np.array([ospa(each, CUTOFF, ORDER) for each in assignments]),
        gospa=np.array([gospa(each, CUTOFF, ORDER) for each in assignments]),
        square_error=square,
        settled_square_error=square[settled],
        identities=score_identities(periods, PING_INTERVAL, _first_seen(pings)),
        seconds=seconds,
        estimates=tuple(np.split(shown, estimates.bounds[1:-1])),
    )


def identified(identity: NDArray[Any], state: FloatArray) -> FloatArray:
    """Return identity, x and y, shape (n, 3), of states, shape (n, 4), m."""
    return np.column_stack([identity.astype(np.float64), state[:, :2]])


@dataclass(frozen=True)
class _Rows:
    """Truths or estimates of all pings, shape (n,) and (n, 4), those of a ping together."""

    id: NDArray[Any]
    state: FloatArray
    bounds: IndexArray

    @classmethod
    def of(cls, ids: Sequence[NDArray[Any]], states: Sequence[FloatArray]) -> _Rows:
        """Return the table of some rows each ping."""
        ends = np.cumsum([len(own) for own in ids])
        return cls(np.concatenate(ids), np.concatenate(states), np.append(0, ends))


def _estimates(updates: Sequence[ContactTrackerUpdate]) -> tuple[_Rows, FloatArray]:
    """Return the established tracks of all pings and their ages, shape (n,), in pings."""
    tracks = [update.tracks for update in updates]
    shown = [np.flatnonzero(own.established) for own in tracks]
    chosen = list(zip(tracks, shown, strict=True))
    found = _Rows.of([own.id[rows] for own, rows in chosen], [own.state[r] for own, r in chosen])
    initiated = np.concatenate([own.initiated[rows] for own, rows in chosen])
    now = np.array([seconds(own.stamp) for own in tracks]).repeat(np.diff(found.bounds))
    # Stamps in seconds are rounded to a fraction of a microsecond; pings are whole numbers.
    return found, np.round((now - initiated) / PING_INTERVAL, 3)


@dataclass(frozen=True)
class _Pairs:
    """Each truth with each estimate of its ping: rows of both and distance, m, shape (n_pairs,).

    Besides, where the pairs of each ping begin, and which pairs are assigned.
    """

    truth: IndexArray
    estimate: IndexArray
    bounds: IndexArray
    distance: FloatArray
    assigned: IndexArray


def _paired(truths: _Rows, estimates: _Rows) -> _Pairs:
    """Return all pairs, and which of them are assigned."""
    n_truths, n_estimates = np.diff(truths.bounds), np.diff(estimates.bounds)
    each = n_estimates.repeat(n_truths)
    truth = np.arange(len(each)).repeat(each)
    before = estimates.bounds[:-1].repeat(n_truths) - (np.cumsum(each) - each)
    estimate = np.arange(len(truth)) + before.repeat(each)
    bounds = np.append(0, np.cumsum(n_truths * n_estimates))
    apart = truths.state[truth, :2] - estimates.state[estimate, :2]
    distance = np.hypot(apart[:, 0], apart[:, 1])
    near = np.flatnonzero(distance < CUTOFF)
    # Where nobody is near two others, those that are near each other are the pairs.
    contested = np.bincount(truth[near], minlength=len(each))[truth[near]] > 1
    contested |= np.bincount(estimate[near], minlength=len(estimates.id))[estimate[near]] > 1
    assigned = np.zeros(len(distance), dtype=bool)
    assigned[near] = True
    for ping in np.unique(bounds.searchsorted(near[contested], side="right") - 1).tolist():
        own = slice(bounds[ping], bounds[ping + 1])
        shape = (n_truths[ping], n_estimates[ping])
        found = assign(distance[own].reshape(shape), CUTOFF, ORDER)
        assigned[own] = False
        assigned[own].reshape(shape)[found.truths, found.estimates] = True
    return _Pairs(truth, estimate, bounds, distance, np.flatnonzero(assigned))


def _assignments(pairs: _Pairs, truths: _Rows, estimates: _Rows) -> list[Assignment]:
    """Return the assignment of each ping, by the rows of both there."""
    rows, n_pings = pairs.assigned, len(pairs.bounds) - 1
    ends = rows.searchsorted(pairs.bounds)
    ping = np.arange(n_pings).repeat(np.diff(ends))
    costs = np.bincount(ping, pairs.distance[rows] ** ORDER, n_pings)
    return [
        Assignment(truth, estimate, *rest)
        for truth, estimate, *rest in zip(
            np.split(pairs.truth[rows] - truths.bounds[ping], ends[1:-1]),
            np.split(pairs.estimate[rows] - estimates.bounds[ping], ends[1:-1]),
            costs.tolist(),
            np.diff(truths.bounds).tolist(),
            np.diff(estimates.bounds).tolist(),
            strict=True,
        )
    ]


def _periods(
    pairs: _Pairs, truths: _Rows, estimates: _Rows, stamps: Sequence[int]
) -> list[ScoredPeriod]:
    """Return who was assigned to whom at each ping, of a stamp, ns."""
    rows, near = pairs.assigned, np.flatnonzero(pairs.distance < CUTOFF)
    holders = truths.id[pairs.truth[rows]].tolist()
    held = list(zip(holders, estimates.id[pairs.estimate[rows]].tolist(), strict=True))
    columns = (
        (truths.id.tolist(), truths.bounds),
        (estimates.id.tolist(), estimates.bounds),
        (held, rows.searchsorted(pairs.bounds)),
        (estimates.id[pairs.estimate[near]].tolist(), near.searchsorted(pairs.bounds)),
    )
    return [
        ScoredPeriod(stamp, tuple(targets), tuple(tracks), dict(own), frozenset(close))
        for stamp, targets, tracks, own, close in zip(
            stamps, *[_of_pings(column, bounds) for column, bounds in columns], strict=True
        )
    ]


def _of_pings(column: list[Any], bounds: IndexArray) -> list[list[Any]]:
    """Return what of a column belongs to each ping."""
    return [column[begin:end] for begin, end in itertools.pairwise(bounds.tolist())]


def _first_seen(pings: Sequence[SimulatedPing]) -> dict[int, int]:
    """Return the stamp of the first ping of each target, ns."""
    first_seen: dict[int, int] = {}
    for ping in pings:
        for target in ping.target_id.tolist():
            first_seen.setdefault(target, ping.contacts.stamp)
    return first_seen
