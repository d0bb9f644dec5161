"""States of the targets in a cloud of all targets: weighted k-means on position.

References
----------
Vo, Singh, Doucet (2005), section 3.4; Arthur, Vassilvitskii (2007) for the seeding.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.active.tracks.particle_cloud import ParticleCloud
from sonar_tracking.records.arrays import FloatArray, IndexArray

ITERATIONS = 10

SMALLEST_WEIGHT = 1e-12
"""Particles of less are left out."""


@dataclass(frozen=True)
class Peaks:
    """Clusters of a cloud.

    Attributes
    ----------
    state : ndarray, shape (n, 4)
        x, y, vx, vy, their weighted medians, m and m/s.
    covariance : ndarray, shape (n, 4, 4)
        Of their particles, m^2, m^2/s, m^2/s^2.
    mass : ndarray, shape (n,)
        Sum of their weights: the count of targets there.
    """

    state: FloatArray
    covariance: FloatArray
    mass: FloatArray


def extract_states(cloud: ParticleCloud, count: int, generator: np.random.Generator) -> Peaks:
    """Return ``count`` clusters, or fewer: empty ones are left out.

    Parameters
    ----------
    cloud : ParticleCloud
        Weighted particles of all targets.
    count : int
        Targets; 0 gives empty arrays.
    generator : numpy.random.Generator
        Of the seeding.
    """
    counts = cloud.weight > SMALLEST_WEIGHT
    if not counts.all():
        cloud = _selected(cloud, np.flatnonzero(counts))
    if count <= 0 or not len(cloud.weight):
        return Peaks(np.zeros((0, 4)), np.zeros((0, 4, 4)), np.zeros(0))
    position = np.ascontiguousarray(cloud.state[:, :2].T)
    label = _clustered(position, cloud.weight, _seeds(position, cloud.weight, count, generator))
    clusters = [np.flatnonzero(label == index) for index in range(count)]
    parts = [_selected(cloud, rows) for rows in clusters if len(rows)]
    return Peaks(
        state=np.array([_weighted_median(part) for part in parts]),
        covariance=np.array([part.moments()[1] for part in parts]),
        mass=np.array([float(np.sum(part.weight)) for part in parts]),
    )


def _selected(cloud: ParticleCloud, rows: IndexArray) -> ParticleCloud:
    return ParticleCloud(
        cloud.state.take(rows, axis=0), cloud.mode.take(rows), cloud.weight.take(rows)
    )


def _seeds(
    position: FloatArray, weight: FloatArray, count: int, generator: np.random.Generator
) -> FloatArray:
    """Return the first centres, shape (2, count)."""
    rows = [_draw(weight, generator)]
    square = np.full(len(weight), np.inf)
    for _ in range(count - 1):
        away = position - position[:, rows[-1], None]
        square = np.minimum(square, away[0] ** 2 + away[1] ** 2)
        rows.append(_draw(weight * square + 1e-300, generator))
    return position[:, rows]


def _draw(weight: FloatArray, generator: np.random.Generator) -> int:
    edges = np.cumsum(weight)
    return int(min(np.searchsorted(edges, generator.random() * edges[-1]), len(weight) - 1))


def _clustered(position: FloatArray, weight: FloatArray, centres: FloatArray) -> IndexArray:
    """Return the cluster of each particle; no step changes any more once the labels do not."""
    count = centres.shape[1]
    # From the middle of the centres, for the digits.
    middle = np.mean(centres, axis=1, keepdims=True)
    position, centres = position - middle, centres - middle
    weighted = weight * position
    label = _labels(position, centres)
    for _ in range(ITERATIONS):
        mass = np.bincount(label, weight, count)
        sums = np.stack([np.bincount(label, row, count) for row in weighted])
        centres = np.where(mass > 0.0, sums / np.maximum(mass, 1e-300), centres)
        before, label = label, _labels(position, centres)
        if np.array_equal(before, label):
            break
    return label


def _labels(position: FloatArray, centres: FloatArray) -> IndexArray:
    """Return the nearest of the centres, shape (2, count), for positions, shape (2, n)."""
    # |x - c|^2 without |x|^2, which is the same for all centres.
    square = (-2.0 * centres).T @ position
    square += np.sum(centres**2, axis=0)[:, None]
    label = np.zeros(position.shape[1], dtype=np.intp)
    nearest = square[0]
    for index, row in enumerate(square[1:], start=1):
        np.copyto(label, index, where=row < nearest)
        np.minimum(nearest, row, out=nearest)
    return label


def _weighted_median(cloud: ParticleCloud) -> FloatArray:
    values = np.ascontiguousarray(cloud.state.T)
    order = values.argsort(axis=1)
    edges = cloud.weight.take(order).cumsum(axis=1)
    middle = (edges < 0.5 * edges[:, -1:]).sum(axis=1)
    columns = np.arange(len(values))
    return np.asarray(values[columns, order[columns, middle]])
