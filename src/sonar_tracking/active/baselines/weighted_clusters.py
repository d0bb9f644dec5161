"""Weighted k-means on position: compiled, or in numpy with the same bits.

``compiled_clusters`` is there if a compiler was when the package was installed.

References
----------
D. Arthur, S. Vassilvitskii, "k-means++: the advantages of careful seeding", ACM-SIAM Symposium on
Discrete Algorithms, 2007.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.compiled_modules import compiled_module
from sonar_tracking.records.arrays import FloatArray, IndexArray, IntArray

LEAST_MASS = 1e-300
"""So that nothing is divided by zero."""


COMPILED = compiled_module("active.baselines.compiled_clusters")
"""The compiled function, None where there is none."""


def weighted_clusters(
    position: FloatArray, weight: FloatArray, luck: FloatArray, iterations: int
) -> tuple[IntArray, IntArray]:
    """Return which points are in which cluster.

    Parameters
    ----------
    position : ndarray, shape (2, n)
        x and y of at least one point, m.
    weight : ndarray, shape (n,)
        Pure numbers, not negative.
    luck : ndarray, shape (n_clusters,)
        Pure numbers from 0 to 1, at random: where each of at least one cluster begins.
    iterations : int
        Largest number of steps; fewer are made when clusters stay as they are.

    Returns
    -------
    order : ndarray of int, shape (n,)
        Rows of the points of one cluster after the other, ascending in each.
    counts : ndarray of int, shape (n_clusters,)
        Points of each cluster.
    """
    x, y = np.ascontiguousarray(position)
    if COMPILED is None:
        label = _labels_in_numpy(np.stack([x, y]), weight, luck, iterations)
        return np.argsort(label, kind="stable"), np.bincount(label, minlength=len(luck))
    order, counts = np.empty(len(x), dtype=np.int64), np.empty(len(luck), dtype=np.int64)
    COMPILED.cluster(x, y, np.ascontiguousarray(weight), luck, order, counts, iterations)
    return order, counts


def _labels_in_numpy(
    position: FloatArray, weight: FloatArray, luck: FloatArray, iterations: int
) -> IndexArray:
    """Return the cluster of each point; no step changes any more once the labels do not."""
    count = len(luck)
    centres = _seeds(position, weight, luck)
    # From the middle of the centres, for the digits.
    middle = np.cumsum(centres, axis=1)[:, -1:] / count
    position, centres = position - middle, centres - middle
    weighted = weight * position
    label = _nearest(position, centres)
    for _ in range(iterations):
        mass = np.bincount(label, weight, count)
        sums = np.stack([np.bincount(label, row, count) for row in weighted])
        centres = np.where(mass > 0.0, sums / np.maximum(mass, LEAST_MASS), centres)
        before, label = label, _nearest(position, centres)
        if np.array_equal(before, label):
            break
    return label


def _seeds(position: FloatArray, weight: FloatArray, luck: FloatArray) -> FloatArray:
    """Return the first centres, shape (2, n_clusters): far from each other in the mean, heavy."""
    rows = [_drawn(weight, luck[0])]
    square = np.full(len(weight), np.inf)
    for each in luck[1:]:
        away = position - position[:, rows[-1], None]
        square = np.minimum(square, away[0] ** 2 + away[1] ** 2)
        rows.append(_drawn(weight * square + LEAST_MASS, each))
    return position[:, rows]


def _drawn(weight: FloatArray, luck: float) -> int:
    edges = np.cumsum(weight)
    return int(min(np.searchsorted(edges, luck * edges[-1]), len(weight) - 1))


def _nearest(position: FloatArray, centres: FloatArray) -> IndexArray:
    """Return the nearest of the centres, shape (2, count), for positions, shape (2, n)."""
    # |x - c|^2 without |x|^2, which is the same for all centres.
    twice = -2.0 * centres
    offset = centres[0] ** 2 + centres[1] ** 2
    square = twice[0, :, None] * position[0] + twice[1, :, None] * position[1]
    square += offset[:, None]
    label = np.zeros(position.shape[1], dtype=np.intp)
    nearest = square[0]
    for index, row in enumerate(square[1:], start=1):
        np.copyto(label, index, where=row < nearest)
        np.minimum(nearest, row, out=nearest)
    return label
