"""OSPA and GOSPA: the optimal subpattern assignment distance of two sets, and its generalisation.

With d_c = min(d, c), n truths, m estimates and k assigned pairs (d < c):

    OSPA    = [(min over assignments of sum d_c^p + c^p |n - m|) / max(n, m)]^(1/p)
    GOSPA^p = min over assignments of sum d^p + (c^p / 2) (n + m - 2 k)          (alpha = 2)

A pair at or beyond the cut-off costs GOSPA as much as a miss and a false estimate, so that the
assignment of least sum of d_c^p is the best one for both.

References
----------
D. Schuhmacher, B.-T. Vo, B.-N. Vo, "A consistent metric for performance evaluation of multi-object
filters", IEEE Trans. Signal Processing 56(8), 2008; A. S. Rahmathullah, A. F. Garcia-Fernandez,
L. Svensson, "Generalized optimal sub-pattern assignment metric", FUSION, 2017.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.filtering.assignment import least_cost_pairs, load_solver
from sonar_tracking.records.arrays import FloatArray, IndexArray


@dataclass(frozen=True)
class Assignment:
    """Truths and estimates that belong together.

    Attributes
    ----------
    truths, estimates : ndarray of int, shape (n_pairs,)
        Rows and columns of the assigned pairs, all closer than the cut-off.
    cost : float
        Sum of d^order over these pairs.
    n_truths, n_estimates : int
        Sizes of the sets.
    """

    truths: IndexArray
    estimates: IndexArray
    cost: float
    n_truths: int
    n_estimates: int


def assign(distances: FloatArray, cutoff: float, order: float) -> Assignment:
    """Return the assignment of least sum of min(d, cutoff)^order.

    Parameters
    ----------
    distances : ndarray, shape (n_truths, n_estimates)
        Between each truth and each estimate, in any unit.
    cutoff : float
        Pairs at or beyond it are not assigned; in the same unit.
    order : float
        Exponent p, at least 1.
    """
    near = distances < cutoff
    rows, columns = near.nonzero()
    if not _are_apart(rows, columns) or np.isnan(distances).any():
        load_solver()
        rows, columns = least_cost_pairs(np.minimum(distances, cutoff) ** order)
        kept = near[rows, columns]
        rows, columns = rows[kept], columns[kept]
    cost = float(np.sum(distances[rows, columns] ** order))
    return Assignment(rows, columns, cost, *distances.shape)


def _are_apart(rows: IndexArray, columns: IndexArray) -> bool:
    """Return whether nobody is near two others: then those near each other are the pairs."""
    n_pairs = len(rows)
    return len(set(rows.tolist())) == n_pairs == len(set(columns.tolist()))


def ospa(assignment: Assignment, cutoff: float, order: float) -> float:
    """Return the OSPA distance of an assignment made with the same cut-off and order.

    It is 0 if both sets are empty and ``cutoff`` if one is.
    """
    larger = max(assignment.n_truths, assignment.n_estimates)
    if larger == 0:
        return 0.0
    unassigned = larger - len(assignment.truths)
    return float(((assignment.cost + cutoff**order * unassigned) / larger) ** (1.0 / order))


def gospa(assignment: Assignment, cutoff: float, order: float) -> float:
    """Return the GOSPA distance (alpha = 2) of an assignment made with the same cut-off."""
    unassigned = assignment.n_truths + assignment.n_estimates - 2 * len(assignment.truths)
    return float((assignment.cost + 0.5 * cutoff**order * unassigned) ** (1.0 / order))
