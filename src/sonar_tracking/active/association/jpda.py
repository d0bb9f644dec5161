"""JPDA, joint probabilistic data association, by enumeration of all joint events.

An event assigns each track at most one contact and each contact to at most one track. Its weight
is the product of 1 - P_D P_G over tracks without and P_D l_tj / lambda over tracks with a contact.
Tracks without a common contact are independent, so that each connected cluster is enumerated on
its own; a cluster with too many events falls back to independent PDA.

References
----------
T. E. Fortmann, Y. Bar-Shalom, M. Scheffe, "Sonar tracking of multiple targets using joint
probabilistic data association", IEEE J. Oceanic Engineering 8(3), 1983; W. Ng, J. Li, S. Godsill,
J. Vermaak, "A hybrid approach for online joint detection and tracking for multiple targets", IEEE
Aerospace Conference, 2005.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sonar_tracking.records.arrays import BoolArray, FloatArray, IndexArray

MAXIMUM_EVENTS = 20_000
"""Upper bound of the number of joint events of a cluster."""


def associate_jointly(ratios: FloatArray, missed: float) -> FloatArray:
    """Return the probability that contact j is track t's.

    Parameters
    ----------
    ratios : ndarray, shape (n_tracks, n_contacts)
        P_D l_tj / lambda, pure numbers; 0 outside the gate.
    missed : float
        1 - P_D P_G.

    Returns
    -------
    ndarray, shape (n_tracks, n_contacts)
        Probabilities; rows sum to the probability of detection given the contacts.
    """
    n_tracks, n_contacts = ratios.shape
    probabilities = np.zeros_like(ratios)
    if not n_tracks or not n_contacts:
        return probabilities
    wanted = ratios != 0.0
    shared = np.count_nonzero(wanted, axis=0) > 1
    alone = ~np.any(wanted[:, shared], axis=1)
    probabilities[alone] = _independently(ratios[alone], missed)
    if not np.all(alone):
        together = np.flatnonzero(~alone)
        for rows, contacts in _clusters(wanted[together]):
            place = np.ix_(together[rows], contacts)
            probabilities[place] = _cluster(ratios[place], missed)
    return probabilities


def _clusters(wanted: BoolArray) -> Iterator[tuple[IndexArray, IndexArray]]:
    """Yield rows and columns that are connected, of a matrix of shape (n_tracks, n_contacts)."""
    left = np.ones(len(wanted), bool)
    while np.any(left):
        rows, contacts = np.zeros(len(wanted), bool), np.zeros(wanted.shape[1], bool)
        new = np.arange(len(wanted)) == np.argmax(left)
        while np.any(new):
            rows |= new
            reached = np.any(wanted[new], axis=0) & ~contacts
            contacts |= reached
            new = np.any(wanted[:, reached], axis=1) & ~rows
        left &= ~rows
        yield np.flatnonzero(rows), np.flatnonzero(contacts)


def _independently(ratios: FloatArray, missed: float) -> FloatArray:
    return np.asarray(ratios / (missed + np.sum(ratios, axis=1))[:, None])


def _cluster(ratios: FloatArray, missed: float) -> FloatArray:
    events = float(np.prod(1.0 + np.count_nonzero(ratios, axis=1)))
    if len(ratios) == 1 or events > MAXIMUM_EVENTS:
        return _independently(ratios, missed)
    choices = [
        [(-1, missed), *((int(j), float(row[j])) for j in np.flatnonzero(row))] for row in ratios
    ]
    marginal = np.zeros_like(ratios)
    chosen = [-1] * len(ratios)

    def descend(track: int, used: int, weight: float) -> float:
        if track == len(choices):
            for row, column in enumerate(chosen):
                if column >= 0:
                    marginal[row, column] += weight
            return weight
        total = 0.0
        for column, factor in choices[track]:
            if column >= 0 and used >> column & 1:
                continue
            chosen[track] = column
            mark = used | 1 << column if column >= 0 else used
            total += descend(track + 1, mark, weight * factor)
        return total

    return np.asarray(marginal / descend(0, 0, 1.0))
