"""The Kalman update of every track by every contact in its gate, and their mixture.

Each contact has its own noise and its own reflection time, hence its own gain. All is computed for
all pairs and motion modes at once; sums over the contacts of a track are sums over consecutive
pairs.

References
----------
Bar-Shalom, Fortmann (1988), section 6.4; Kim, Song (2007), equations 13-16.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.active.contacts.contact_positions import PlacedContacts
from sonar_tracking.active.tracks.contact_gating import GatePairs, determinant, inverse
from sonar_tracking.active.tracks.scene_rows import joined_tables
from sonar_tracking.active.tracks.track_bank import TrackBank
from sonar_tracking.filtering.few_terms import sum_of_few
from sonar_tracking.filtering.kalman import symmetrised
from sonar_tracking.records.arrays import FloatArray, IndexArray

PAIRS_AT_ONCE = 1000
"""What is computed of more does not stay near the processor."""


@dataclass(frozen=True)
class PairUpdates:
    """One Kalman update a pair and mode.

    Attributes
    ----------
    density : ndarray, shape (n_pairs, n_modes)
        N(nu; 0, S), 1/m^2.
    correction : ndarray, shape (n_pairs, n_modes, 4)
        K nu, m and m/s.
    reduction : ndarray, shape (n_pairs, n_modes, 4, 4)
        K S K^T, m^2, m^2/s, m^2/s^2.
    """

    density: FloatArray
    correction: FloatArray
    reduction: FloatArray

    def select(self, rows: slice) -> PairUpdates:
        """Return some of the updates, next to each other."""
        return PairUpdates(self.density[rows], self.correction[rows], self.reduction[rows])


def update_pairs(bank: TrackBank, contacts: PlacedContacts, pairs: GatePairs) -> PairUpdates:
    """Return the updates of all pairs.

    Parameters
    ----------
    bank : TrackBank
        Predicted tracks.
    contacts : PlacedContacts
        Contacts of the ping.
    pairs : GatePairs
        Who may belong to whom.
    """
    if len(pairs.track) > PAIRS_AT_ONCE:
        portions = [
            update_pairs(bank, contacts, pairs.keep(slice(first, first + PAIRS_AT_ONCE)))
            for first in range(0, len(pairs.track), PAIRS_AT_ONCE)
        ]
        return joined_tables(portions)
    mean, covariance = (each.take(pairs.track, axis=0) for each in (bank.mean, bank.covariance))
    contacts = contacts.select(pairs.contact)
    delay = contacts.delay[:, None, None]
    innovation = contacts.position[:, None] - mean[..., :2] - delay * mean[..., 2:]
    step = delay[..., None]
    cross = covariance[..., :2] + step * covariance[..., 2:]
    spread = cross[..., :2, :] + step * cross[..., 2:, :]
    spread = spread + contacts.covariance[:, None]
    area = determinant(spread)
    weighted = inverse(spread, area)
    gain = np.matmul(cross, weighted)
    scaled = np.matmul(weighted, innovation[..., None])[..., 0]
    square = sum_of_few(innovation * scaled, axis=-1)
    density = np.exp(-0.5 * square) / (2.0 * np.pi * np.sqrt(area))
    return PairUpdates(
        density=density,
        correction=np.matmul(gain, innovation[..., None])[..., 0],
        reduction=np.matmul(gain, cross.swapaxes(-1, -2)),
    )


def mix_updates(
    bank: TrackBank, pairs: GatePairs, updates: PairUpdates, weights: FloatArray
) -> TrackBank:
    """Return the tracks as mixtures over their contacts and over having none.

    Parameters
    ----------
    bank : TrackBank
        Predicted tracks.
    pairs : GatePairs
        Who may belong to whom.
    updates : PairUpdates
        Their Kalman updates.
    weights : ndarray, shape (n_pairs, n_modes)
        Probabilities of association in each mode.
    """
    if not len(pairs.track):
        return bank
    starts = pairs.first_of_each_track()
    ends = np.append(starts[1:], len(pairs.track))
    mean, covariance = bank.mean.copy(), bank.covariance.copy()
    first = 0
    while first < len(starts):
        last = max(first + 1, int(ends.searchsorted(starts[first] + PAIRS_AT_ONCE, side="right")))
        own = slice(int(starts[first]), int(ends[last - 1]))
        begins = starts[first:last] - own.start
        combined, change = _changes(updates.select(own), weights[own], begins)
        rows = pairs.track[starts[first:last]]
        mean[rows] += combined
        covariance[rows] = symmetrised(covariance[rows] + change)
        first = last
    return replace(bank, mean=mean, covariance=covariance)


def _changes(
    updates: PairUpdates, weights: FloatArray, starts: IndexArray
) -> tuple[FloatArray, FloatArray]:
    """Return by what the contacts of each track change its mean and its covariance."""
    weighted = weights[..., None] * updates.correction
    combined = np.add.reduceat(weighted, starts, axis=0)
    spread = weighted[..., :, None] * updates.correction[..., None, :]
    spread -= weights[..., None, None] * updates.reduction
    change = np.add.reduceat(spread, starts, axis=0)
    return combined, change - combined[..., :, None] * combined[..., None, :]
