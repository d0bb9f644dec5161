"""States of the targets in a cloud of all targets: weighted k-means on position.

References
----------
Vo, Singh, Doucet (2005), section 3.4.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from sonar_tracking.active.baselines.weighted_clusters import weighted_clusters
from sonar_tracking.active.baselines.weighted_medians import weighted_medians
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
    heavy = cloud.weight > SMALLEST_WEIGHT
    if not heavy.all():
        cloud = _selected(cloud, np.flatnonzero(heavy))
    if count <= 0 or not len(cloud.weight):
        return Peaks(np.zeros((0, 4)), np.zeros((0, 4, 4)), np.zeros(0))
    order, counts = weighted_clusters(
        cloud.state[:, :2].T, cloud.weight, generator.random(count), ITERATIONS
    )
    clusters, counts = _selected(cloud, order), counts[counts > 0]
    bounds = itertools.pairwise([0, *itertools.accumulate(counts.tolist())])
    parts = [clusters.select(slice(begin, end)) for begin, end in bounds]
    return Peaks(
        state=weighted_medians(clusters.state, clusters.weight, counts),
        covariance=np.array([part.moments()[1] for part in parts]),
        mass=np.array([float(np.sum(part.weight)) for part in parts]),
    )


def _selected(cloud: ParticleCloud, rows: IndexArray) -> ParticleCloud:
    return ParticleCloud(
        cloud.state.take(rows, axis=0), cloud.mode.take(rows), cloud.weight.take(rows)
    )
