"""Which track each target has at each instant, from a table of true states.

The identity score tells means over the targets; this tells who, so that single targets, the first
periods or targets at rest can be looked at on their own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.evaluation.metrics.ospa_gospa import assign
from sonar_tracking.evaluation.metrics.score_statistics import mean
from sonar_tracking.records.arrays import BoolArray, FloatArray, IntArray
from sonar_tracking.records.positions import PositionTracks

ORDER = 2.0


@dataclass(frozen=True)
class HeldIdentities:
    """Tracks assigned to each target.

    Attributes
    ----------
    present : ndarray of bool, shape (n_periods, n_targets)
        Whether the target is there.
    identity : ndarray of int, shape (n_periods, n_targets)
        Of its confirmed track within the cut-off; -1 = it has none.
    speed : ndarray, shape (n_periods, n_targets)
        That the track claims, m/s; NaN = there is none.
    confirmed : frozenset of int
        All identities that were ever confirmed, whoever had them.
    """

    present: BoolArray
    identity: IntArray
    speed: FloatArray
    confirmed: frozenset[int]

    @property
    def held(self) -> BoolArray:
        """Whether each target has a track; shape (n_periods, n_targets)."""
        return self.identity >= 0

    def share_held_from(self, period: int) -> float:
        """Return the share of periods with a track, from that period (0 = all) of each life on."""
        age = np.cumsum(self.present, axis=0) - 1
        return mean(self.held[self.present & (age >= period)].astype(float))

    def continuities(self) -> FloatArray:
        """Return the longest-held identity's share of each life.

        Returns
        -------
        ndarray, shape (n_targets,)
            Pure numbers, 0 to 1.
        """
        return np.array(
            [
                _most_frequent(identity[identity >= 0]) / max(int(np.count_nonzero(present)), 1)
                for identity, present in zip(self.identity.T, self.present.T, strict=True)
            ]
        )


def held_identities(
    true_state: FloatArray, tracks: Sequence[PositionTracks], cutoff_m: float
) -> HeldIdentities:
    """Return which track each target has.

    Parameters
    ----------
    true_state : ndarray, shape (n_periods, n_targets, 4)
        x, y, vx, vy at the stamps of the tracks, m and m/s; NaN = the target is not there.
    tracks : sequence of PositionTracks
        One list a period.
    cutoff_m : float
        Distance from which on a track is none of a target, m.
    """
    present = np.isfinite(true_state[..., 0])
    identity = np.full(present.shape, -1, np.int64)
    speed = np.full(present.shape, np.nan)
    confirmed: set[int] = set()
    for period, entry in enumerate(tracks):
        shown = entry.established
        identities, states = entry.id[shown].astype(np.int64), entry.state[shown]
        confirmed.update(identities.tolist())
        there = np.flatnonzero(present[period])
        apart = true_state[period, there, None, :2] - states[:, :2]
        pairs = assign(np.hypot(apart[..., 0], apart[..., 1]), cutoff_m, ORDER)
        identity[period, there[pairs.truths]] = identities[pairs.estimates]
        velocity = states[pairs.estimates, 2:]
        speed[period, there[pairs.truths]] = np.hypot(velocity[:, 0], velocity[:, 1])
    return HeldIdentities(present, identity, speed, frozenset(confirmed))


def _most_frequent(identities: IntArray) -> int:
    """Return how often the most frequent of identities, shape (n,), occurs."""
    return int(np.max(np.unique(identities, return_counts=True)[1], initial=0))
