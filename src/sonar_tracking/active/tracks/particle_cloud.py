"""A target as a cloud of weighted particles that go straight, turn left or turn right.

The clouds of several targets are computed together; random numbers are drawn cloud by cloud.

Regularised resampling: when fewer than half of the particles count, they are drawn anew by their
weights and spread by a Gaussian kernel of the cloud's own covariance, shrunk so that the
covariance stays what it was.

References
----------
Kim, Song (2007), equations 1-3; Musso, Oudjane, Le Gland (2001) for the kernel.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.tracks.cloud_steps import (
    begun_turns,
    cloud_moments,
    finished_turns,
    spread_particles,
)
from sonar_tracking.active.tracks.motion_modes import TURN_DIRECTIONS
from sonar_tracking.records.arrays import BoolArray, FloatArray, IndexArray, IntArray

KERNEL_WIDTH = 0.3
"""Relative to the kernel that is best for a Gaussian cloud."""


@dataclass(frozen=True)
class ParticleMotion:
    """How particles move.

    Attributes
    ----------
    acceleration_deviation, lateral_acceleration : float
        m/s^2.
    stay_probability : float
        Of a motion mode until the next ping.
    """

    acceleration_deviation: float
    lateral_acceleration: float
    stay_probability: float

    @classmethod
    def configured(cls, configuration: ContactTrackerConfiguration) -> ParticleMotion:
        """Return the motion a tracker is configured for."""
        return cls(
            configuration.acceleration_deviation,
            configuration.lateral_acceleration,
            configuration.stay_probability,
        )


@dataclass(frozen=True)
class ParticleCloud:
    """Particles of one target, or of all targets together; or several such clouds.

    Attributes
    ----------
    state : ndarray, shape (..., n, 4)
        x, y, vx, vy, m and m/s.
    mode : ndarray of int, shape (..., n)
        0 straight, 1 left, 2 right.
    weight : ndarray, shape (..., n)
        Pure numbers, not negative.
    """

    state: FloatArray
    mode: IntArray
    weight: FloatArray

    def __len__(self) -> int:
        """Return the number of clouds."""
        return len(self.weight)

    def select(self, rows: int | BoolArray | IndexArray | slice) -> ParticleCloud:
        """Return one or some of several clouds.

        Parameters
        ----------
        rows : int, slice, or ndarray of bool, shape (n_clouds,), or of int, shape (n_kept,)
            A row, a mask or rows.
        """
        return ParticleCloud(self.state[rows], self.mode[rows], self.weight[rows])

    @cached_property
    def share(self) -> FloatArray:
        """Weights with the sum 1, shape (..., n), pure numbers."""
        return np.asarray(self.weight / self.weight.sum(axis=-1, keepdims=True))

    def moments(self) -> tuple[FloatArray, FloatArray]:
        """Return mean and covariance of the particles.

        Returns
        -------
        mean : ndarray, shape (..., 4)
            m and m/s.
        covariance : ndarray, shape (..., 4, 4)
            m^2, m^2/s, m^2/s^2.
        """
        return self._moments

    @cached_property
    def _moments(self) -> tuple[FloatArray, FloatArray]:
        return cloud_moments(self.share, self.state)


def no_clouds(count: int) -> ParticleCloud:
    """Return the table of clouds of so many particles before there is one."""
    return ParticleCloud(np.zeros((0, count, 4)), np.zeros((0, count), int), np.zeros((0, count)))


def stacked(cloud: ParticleCloud) -> ParticleCloud:
    """Return one cloud as a table of clouds."""
    return ParticleCloud(cloud.state[None], cloud.mode[None], cloud.weight[None])


def gaussian_cloud(
    mean: FloatArray, covariance: FloatArray, count: int, generator: np.random.Generator
) -> ParticleCloud:
    """Return particles of a Gaussian, all modes equally likely.

    Parameters
    ----------
    mean : ndarray, shape (4,)
        x, y, vx, vy, m and m/s.
    covariance : ndarray, shape (4, 4)
        m^2, m^2/s, m^2/s^2.
    count : int
        Particles.
    generator : numpy.random.Generator
        Source of randomness.
    """
    root = _root(covariance + 1e-9 * np.eye(4))
    state = mean + generator.standard_normal((count, 4)) @ root.T
    mode = generator.integers(0, len(TURN_DIRECTIONS), count)
    return ParticleCloud(state, mode, np.full(count, 1.0 / count))


def predict_cloud(
    cloud: ParticleCloud,
    motion: ParticleMotion,
    interval: float,
    generator: np.random.Generator,
) -> ParticleCloud:
    """Return the particles after an interval, each with its own mode and noise.

    Parameters
    ----------
    cloud : ParticleCloud
        One or several.
    motion : ParticleMotion
        Of the particles.
    interval : float
        s.
    generator : numpy.random.Generator
        Source of randomness.
    """
    other, noise = _changes(cloud.weight.shape, motion, generator)
    mode, half = begun_turns(cloud.state, cloud.mode, other, motion.lateral_acceleration, interval)
    scale = motion.acceleration_deviation * interval
    state = finished_turns(cloud.state, half, noise, scale, interval)
    return ParticleCloud(state, mode, cloud.weight)


def _changes(
    shape: tuple[int, ...], motion: ParticleMotion, generator: np.random.Generator
) -> tuple[IntArray, FloatArray]:
    """Return how many modes on each particle goes, and its noise, drawn cloud by cloud."""
    luck, other, noise = np.empty(shape), np.empty(shape, int), np.empty((*shape, 2))
    for row in np.ndindex(shape[:-1]):
        generator.random(out=luck[row])
        other[row] = generator.integers(1, 3, shape[-1])
        generator.standard_normal(out=noise[row])
    other *= luck >= motion.stay_probability
    return other, noise


def systematic_rows(weight: FloatArray, count: int, generator: np.random.Generator) -> IndexArray:
    """Return the rows of particles drawn in proportion to their weights.

    Parameters
    ----------
    weight : ndarray, shape (n,)
        Pure numbers, not negative.
    count : int
        How many to draw.
    generator : numpy.random.Generator
        Source of randomness.

    Returns
    -------
    ndarray of int, shape (count,)
        Ascending.
    """
    edges = np.cumsum(weight)
    # The points (k + offset) / count up to each edge are counted instead of being looked for.
    reached = np.floor(edges * (count / edges[-1]) - generator.random()).astype(np.intp)
    np.minimum(reached + 1, count, out=reached)
    reached[-1] = count
    reached[1:] -= reached[:-1].copy()
    return np.arange(len(weight)).repeat(reached)


def resample_cloud(cloud: ParticleCloud, generator: np.random.Generator) -> ParticleCloud:
    """Return clouds, those with equal weights of which fewer than half of the particles counted.

    Parameters
    ----------
    cloud : ParticleCloud
        Several.
    generator : numpy.random.Generator
        Source of randomness.
    """
    count = cloud.weight.shape[-1]
    share = cloud.share
    few = (1.0 / (share**2).sum(axis=-1) < 0.5 * count).nonzero()[0]
    if not len(few):
        return ParticleCloud(cloud.state, cloud.mode, share)
    weighed = ParticleCloud(cloud.state[few], cloud.mode[few], share[few])
    drawn = _redrawn(weighed, generator)
    if len(few) == len(cloud):
        return drawn
    state, mode, share = cloud.state.copy(), cloud.mode.copy(), share.copy()
    state[few], mode[few], share[few] = drawn.state, drawn.mode, drawn.weight
    return ParticleCloud(state, mode, share)


def _redrawn(cloud: ParticleCloud, generator: np.random.Generator) -> ParticleCloud:
    """Return clouds drawn by their weights and spread by their kernels."""
    count = cloud.weight.shape[-1]
    drawn, mode = np.empty(cloud.weight.shape, dtype=np.int64), np.empty_like(cloud.mode)
    noise = np.empty_like(cloud.state)
    for row, weight in enumerate(cloud.weight):
        drawn[row] = systematic_rows(weight, count, generator)
        generator.standard_normal(out=noise[row])
        cloud.mode[row].take(drawn[row], out=mode[row])
    mean, covariance = cloud.moments()
    width = KERNEL_WIDTH * (4.0 / 6.0) ** (1.0 / 8.0) * count ** (-1.0 / 8.0)
    kernel = width * _root(covariance + np.diag([1e-6, 1e-6, 1e-10, 1e-10]))
    shrink = float(np.sqrt(1.0 - width**2))
    state = spread_particles(cloud.state, drawn, noise, (mean, kernel), shrink)
    return ParticleCloud(state, mode, np.full(mode.shape, 1.0 / count))


def _root(covariance: FloatArray) -> FloatArray:
    """Return A with A A^T = covariance; one that rounding has made indefinite is mended."""
    try:
        return np.asarray(np.linalg.cholesky(covariance))
    except np.linalg.LinAlgError:
        values, vectors = np.linalg.eigh(covariance)
        return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0))[..., None, :])
