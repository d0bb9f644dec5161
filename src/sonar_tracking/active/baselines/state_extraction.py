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
    useful = cloud.weight > 1e-12
    cloud = ParticleCloud(cloud.state[useful], cloud.mode[useful], cloud.weight[useful])
    if count <= 0 or not len(cloud.weight):
        return Peaks(np.zeros((0, 4)), np.zeros((0, 4, 4)), np.zeros(0))
    centres = _seeds(cloud, count, generator)
    for _ in range(ITERATIONS):
        label = _labels(cloud, centres)
        mass = np.bincount(label, cloud.weight, count)
        sums = np.stack(
            [np.bincount(label, cloud.weight * cloud.state[:, k], count) for k in (0, 1)], axis=1
        )
        centres = np.where(mass[:, None] > 0.0, sums / np.maximum(mass, 1e-300)[:, None], centres)
    label = _labels(cloud, centres)
    clusters = [label == index for index in range(count) if np.any(label == index)]
    parts = [
        ParticleCloud(cloud.state[rows], cloud.mode[rows], cloud.weight[rows]) for rows in clusters
    ]
    return Peaks(
        state=np.array([_weighted_median(part) for part in parts]),
        covariance=np.array([part.moments()[1] for part in parts]),
        mass=np.array([float(np.sum(part.weight)) for part in parts]),
    )


def _seeds(cloud: ParticleCloud, count: int, generator: np.random.Generator) -> FloatArray:
    position = cloud.state[:, :2]
    rows = [_draw(cloud.weight, generator)]
    square = np.full(len(position), np.inf)
    for _ in range(count - 1):
        square = np.minimum(square, np.sum((position - position[rows[-1]]) ** 2, axis=1))
        rows.append(_draw(cloud.weight * square + 1e-300, generator))
    return position[rows]


def _draw(weight: FloatArray, generator: np.random.Generator) -> int:
    edges = np.cumsum(weight)
    return int(min(np.searchsorted(edges, generator.random() * edges[-1]), len(weight) - 1))


def _labels(cloud: ParticleCloud, centres: FloatArray) -> IndexArray:
    # |x - c|^2 without |x|^2, which is the same for all centres; from their mean for the digits.
    middle = np.mean(centres, axis=0)
    away = centres - middle
    square = np.sum(away**2, axis=1)[:, None] - 2.0 * away @ (cloud.state[:, :2] - middle).T
    return np.argmin(square, axis=0)


def _weighted_median(cloud: ParticleCloud) -> FloatArray:
    result = np.empty(4)
    for column in range(4):
        order = np.argsort(cloud.state[:, column], kind="stable")
        edges = np.cumsum(cloud.weight[order])
        row = order[np.searchsorted(edges, 0.5 * edges[-1])]
        result[column] = cloud.state[row, column]
    return result
