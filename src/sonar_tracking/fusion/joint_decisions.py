"""Which pairs of targets and bearing tracks are sure, all of one station being decided together.

Each pair has its evidence, the log of the odds that both are one against that they have nothing to
do with each other. A target has at most one bearing track of a station. The best choice of pairs is
that of the largest sum, and it is as sure of a pair as its sum is larger than that of the best
choice without it: two ships side by side are told apart as soon as both choices together say so,
and that both are heard may be sure long before it is who is who.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.filtering.assignment import least_cost_pairs
from sonar_tracking.records.arrays import FloatArray, IndexArray


def sure_pairs(evidence: FloatArray, least: float, margin: float) -> list[tuple[int, int]]:
    """Return the pairs that are sure.

    Parameters
    ----------
    evidence : ndarray, shape (n_targets, n_tracks)
        Logs of odds, pure numbers; -inf = not considered.
    least : float
        Evidence that a pair needs.
    margin : float
        By which the best choice must beat the best one without the pair.
    """
    gain = np.maximum(evidence, 0.0)
    if not np.any(gain >= least):
        return []
    rows, columns, total = _best(gain)
    found = []
    for row, column in zip(rows, columns, strict=True):
        without = gain.copy()
        without[row, column] = 0.0
        if gain[row, column] >= least and total - _best(without)[2] >= margin:
            found.append((int(row), int(column)))
    return found


def spoken_for(evidence: FloatArray, margin: float) -> IndexArray:
    """Return the bearing tracks that are surely of one of the targets, whichever; shape (n,).

    Parameters
    ----------
    evidence : ndarray, shape (n_targets, n_tracks)
        Logs of odds, pure numbers; -inf = not considered.
    margin : float
        By which the best choice must beat the best one without the bearing track.
    """
    gain = np.maximum(evidence, 0.0)
    likely = np.flatnonzero(np.any(gain >= margin, axis=0))
    total = _best(gain)[2] if likely.size else 0.0
    loss = [total - _best(np.delete(gain, column, axis=1))[2] for column in likely]
    return likely[np.array(loss) >= margin]


def _best(gain: FloatArray) -> tuple[IndexArray, IndexArray, float]:
    """Return the best choice of pairs, and its sum."""
    if not gain.size:
        return np.empty(0, np.intp), np.empty(0, np.intp), 0.0
    rows, columns = least_cost_pairs(-gain)
    return rows, columns, float(np.sum(gain[rows, columns]))
