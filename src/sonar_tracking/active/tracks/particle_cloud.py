"""A target as a cloud of weighted particles that go straight, turn left or turn right.

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
from sonar_tracking.active.tracks.motion_modes import (
    SMALLEST_SPEED,
    TURN_DIRECTIONS,
    turn_coefficients,
)
from sonar_tracking.records.arrays import FloatArray, IndexArray, IntArray

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
    """Particles of one target, or of all targets together.

    Attributes
    ----------
    state : ndarray, shape (n, 4)
        x, y, vx, vy, m and m/s.
    mode : ndarray of int, shape (n,)
        0 straight, 1 left, 2 right.
    weight : ndarray, shape (n,)
        Pure numbers, not negative.
    """

    state: FloatArray
    mode: IntArray
    weight: FloatArray

    def moments(self) -> tuple[FloatArray, FloatArray]:
        """Return mean and covariance of the particles.

        Returns
        -------
        mean : ndarray, shape (4,)
            m and m/s.
        covariance : ndarray, shape (4, 4)
            m^2, m^2/s, m^2/s^2.
        """
        return self._moments

    @cached_property
    def _moments(self) -> tuple[FloatArray, FloatArray]:
        share = self.weight / np.sum(self.weight)
        mean = share @ self.state
        deviation = self.state - mean
        return mean, (share[:, None] * deviation).T @ deviation


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
    cloud: ParticleCloud, motion: ParticleMotion, interval: float, generator: np.random.Generator
) -> ParticleCloud:
    """Return the particles after an interval (s), each with its own mode and noise."""
    count = len(cloud.weight)
    changed = generator.random(count) >= motion.stay_probability
    mode = cloud.mode + np.where(changed, generator.integers(1, 3, count), 0)
    mode -= 3 * (mode > 2)
    x, y, vx, vy = np.ascontiguousarray(cloud.state.T)
    speed = np.maximum(np.hypot(vx, vy), SMALLEST_SPEED)
    rates = TURN_DIRECTIONS.take(mode) * motion.lateral_acceleration / speed
    sine_over, versine_over, cosine, sine = turn_coefficients(rates, interval)
    noise = motion.acceleration_deviation * generator.standard_normal((count, 2))
    noise_x, noise_y = np.ascontiguousarray(noise.T)
    half = 0.5 * interval**2
    state = np.empty_like(cloud.state)
    state[:, 0] = x + sine_over * vx - versine_over * vy + half * noise_x
    state[:, 1] = y + versine_over * vx + sine_over * vy + half * noise_y
    state[:, 2] = cosine * vx - sine * vy + interval * noise_x
    state[:, 3] = sine * vx + cosine * vy + interval * noise_y
    return ParticleCloud(state, mode, cloud.weight)


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
    points = (np.arange(count) + generator.random()) / count * edges[-1]
    return np.minimum(np.searchsorted(edges, points), len(weight) - 1)


def resample_cloud(cloud: ParticleCloud, generator: np.random.Generator) -> ParticleCloud:
    """Return the cloud with equal weights if fewer than half of its particles count."""
    count = len(cloud.weight)
    share = cloud.weight / np.sum(cloud.weight)
    if 1.0 / np.sum(share**2) >= 0.5 * count:
        return ParticleCloud(cloud.state, cloud.mode, share)
    mean, covariance = cloud.moments()
    rows = systematic_rows(share, count, generator)
    width = KERNEL_WIDTH * (4.0 / 6.0) ** (1.0 / 8.0) * count ** (-1.0 / 8.0)
    floor = np.diag([1e-6, 1e-6, 1e-10, 1e-10])
    kernel = width * _root(covariance + floor)
    shrunk = mean + np.sqrt(1.0 - width**2) * (cloud.state.take(rows, axis=0) - mean)
    state = shrunk + generator.standard_normal((count, 4)) @ kernel.T
    return ParticleCloud(state, cloud.mode.take(rows), np.full(count, 1.0 / count))


def _root(covariance: FloatArray) -> FloatArray:
    """Return A with A A^T = covariance; one that rounding has made indefinite is mended."""
    try:
        return np.asarray(np.linalg.cholesky(covariance))
    except np.linalg.LinAlgError:
        values, vectors = np.linalg.eigh(covariance)
        return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)))
