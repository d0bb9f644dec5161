"""Which tracks are nearer to each other than contacts tell apart.

A contact is of the target it is nearest to. Where two predicted contacts are d standard deviations
apart, the one of either is nearer to the other with the probability Q(d / 2): identities may be
exchanged from then on, and with them positions, by more than any covariance of one target says.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.active.contacts.contact_positions import position_covariance
from sonar_tracking.active.lasting_error import ClaimedError
from sonar_tracking.filtering.consistency import normalised_squared
from sonar_tracking.records.arrays import FloatArray, IndexArray
from sonar_tracking.records.positions import PositionTracks, TrackSource

TOLD_APART = 4.0
"""Standard deviations of a contact between two targets at which one in fifty is nearer to the
other one."""


def unresolved_tracks(tracks: PositionTracks, claimed: ClaimedError) -> dict[int, tuple[int, ...]]:
    """Return which confirmed tracks contacts do not tell apart.

    Parameters
    ----------
    tracks : PositionTracks
        The complete picture after a ping.
    claimed : ClaimedError
        Of the contacts of the ping, m and rad.

    Returns
    -------
    dict of int to tuple of int
        By identifier, those of the tracks it may be exchanged with; two that are fixed both are
        left out.
    """
    shown = tracks.selected(tracks.established)
    offset = shown.state[:, :2] - np.array(claimed.position)
    distance = np.maximum(np.hypot(offset[:, 0], offset[:, 1]), 1e-3)
    predicted = shown.covariance[:, :2, :2] + position_covariance(
        offset / distance[:, None],
        distance,
        claimed.range_standard_deviation,
        claimed.azimuth_standard_deviation,
    )
    first, second = _neighbours(shown.state[:, 0], TOLD_APART * _largest_deviation(predicted))
    moves = shown.source != TrackSource.STATIC
    apart = shown.state[first, :2] - shown.state[second, :2]
    squared = 2.0 * normalised_squared(apart, 0.5 * (predicted[first] + predicted[second]))
    near = (squared < TOLD_APART**2) & (moves[first] | moves[second])
    beside: dict[int, list[int]] = {}
    for one, other in shown.id[np.stack([first[near], second[near]], axis=1)].tolist():
        beside.setdefault(one, []).append(other)
        beside.setdefault(other, []).append(one)
    return {number: tuple(sorted(others)) for number, others in sorted(beside.items())}


def _largest_deviation(covariance: FloatArray) -> float:
    """Return what no deviation exceeds in any direction, m; covariance, shape (n, 2, 2), m^2."""
    return float(np.sqrt(np.max(np.trace(covariance, axis1=1, axis2=2), initial=0.0)))


def _neighbours(x: FloatArray, reach: float) -> tuple[IndexArray, IndexArray]:
    """Return all pairs of rows, each shape (n_pairs,), whose x, m, differ by a reach at most."""
    order = np.argsort(x)
    ends = x[order].searchsorted(x[order] + reach, side="right")
    counts = ends - np.arange(1, len(x) + 1)
    first = np.arange(len(x)).repeat(counts)
    second = first + 1 + np.arange(len(first)) - (np.cumsum(counts) - counts).repeat(counts)
    return order[first], order[second]
