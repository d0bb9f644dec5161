"""Clouds of particles and the contacts in their gates: how well each explains the other.

References
----------
Kim, Song (2007), equations 13-16.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.active.contacts.contact_positions import PlacedContacts
from sonar_tracking.active.tracks.contact_gating import SensorGeometry
from sonar_tracking.active.tracks.particle_cloud import ParticleCloud
from sonar_tracking.active.tracks.particle_densities import particle_densities
from sonar_tracking.records.arrays import FloatArray, IndexArray

SMALLEST_DENSITY = 1e-30
"""1/m^2; what no particle explains has some density, too."""


@dataclass(frozen=True)
class CloudPairs:
    """Contacts in the gates of clouds, and how well each particle explains them.

    Attributes
    ----------
    cloud : ndarray of int, shape (n,)
        Of the clouds, ascending.
    density : ndarray, shape (n, n_particles)
        1/m^2.
    mean : ndarray, shape (n,)
        Of the particles by their weights, 1/m^2; above zero.
    """

    cloud: IndexArray
    density: FloatArray
    mean: FloatArray


def cloud_pairs(
    clouds: ParticleCloud,
    cloud: IndexArray,
    contacts: PlacedContacts,
    sensor: SensorGeometry,
) -> CloudPairs:
    """Return how well clouds explain contacts.

    Parameters
    ----------
    clouds : ParticleCloud
        Several.
    cloud : ndarray of int, shape (n,)
        Of the clouds, ascending.
    contacts : PlacedContacts
        One a pair.
    sensor : SensorGeometry
        Where the ping came from.
    """
    density = particle_densities(clouds.state, cloud, contacts, sensor)
    mean = (density * clouds.share[cloud]).sum(axis=-1)
    return CloudPairs(cloud, density, np.maximum(mean, SMALLEST_DENSITY))


def weigh_cloud(clouds: ParticleCloud, pairs: CloudPairs, beta: FloatArray) -> ParticleCloud:
    """Return clouds weighed by contacts.

    Parameters
    ----------
    clouds : ParticleCloud
        Several.
    pairs : CloudPairs
        Contacts in their gates.
    beta : ndarray, shape (n_pairs,)
        Probabilities of association.
    """
    factor = np.ones(clouds.weight.shape)
    relative = pairs.density / pairs.mean[:, None]
    relative -= 1.0
    relative *= beta[:, None]
    if len(pairs.cloud):
        others = pairs.cloud[1:] != pairs.cloud[:-1]
        begins = np.concatenate(([0], others.nonzero()[0] + 1))
        factor[pairs.cloud[begins]] += np.add.reduceat(relative, begins, axis=0)
    return ParticleCloud(clouds.state, clouds.mode, clouds.share * factor)
