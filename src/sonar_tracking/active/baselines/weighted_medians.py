"""Weighted medians of the particles of clusters: compiled, or in numpy with the same bits.

``compiled_medians`` is there if a compiler was when the package was installed; it selects where
numpy has to sort.
"""

from __future__ import annotations

import itertools

import numpy as np

from sonar_tracking.compiled_modules import compiled_module
from sonar_tracking.records.arrays import FloatArray, IntArray

COMPILED = compiled_module("active.baselines.compiled_medians")
"""The compiled function, None where there is none."""


def weighted_medians(state: FloatArray, weight: FloatArray, counts: IntArray) -> FloatArray:
    """Return the smallest values up to which half of the weight of a cluster lies.

    Parameters
    ----------
    state : ndarray, shape (n, 4)
        x, y, vx, vy of the particles of one cluster after the other, m and m/s.
    weight : ndarray, shape (n,)
        Pure numbers, not negative.
    counts : ndarray of int, shape (n_clusters,)
        Particles of each cluster, above 0.

    Returns
    -------
    ndarray, shape (n_clusters, 4)
        m and m/s.
    """
    medians = np.empty((len(counts), 4))
    if COMPILED is not None:
        COMPILED.medians(*map(np.ascontiguousarray, (state, weight, counts)), medians)
        return medians
    bounds = itertools.pairwise([0, *itertools.accumulate(counts.tolist())])
    for row, (begin, end) in enumerate(bounds):
        values = np.ascontiguousarray(state[begin:end].T)
        order = values.argsort(axis=1)
        edges = weight[begin:end].take(order).cumsum(axis=1)
        middle = (edges < 0.5 * edges[:, -1:]).sum(axis=1)
        columns = np.arange(4)
        medians[row] = values[columns, order[columns, middle]]
    return medians
