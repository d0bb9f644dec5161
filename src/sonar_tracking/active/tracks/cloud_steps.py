"""What is computed of each particle of a cloud, and its moments: compiled, or in numpy.

``compiled_clouds`` is there if a compiler was when the package was installed. All sums are taken in
the same order in both, and in no library of linear algebra: the bits are the same everywhere.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sonar_tracking.active.tracks.motion_modes import SMALLEST_SPEED, TURN_DIRECTIONS
from sonar_tracking.compiled_modules import compiled_module
from sonar_tracking.records.arrays import FloatArray, IntArray

NEXT_MODES = np.array([0, 1, 2, 0, 1])
"""Mode by the old one and how many further it is."""

_UPPER = np.triu_indices(4)


COMPILED = compiled_module("active.tracks.compiled_clouds")
"""The compiled functions, None where there are none."""


def begun_turns(
    state: FloatArray,
    mode: IntArray,
    other: IntArray,
    lateral_acceleration: float,
    interval: float,
) -> tuple[IntArray, FloatArray]:
    """Return the next mode of each particle and half of the turn it makes in it.

    Parameters
    ----------
    state : ndarray, shape (..., 4)
        x, y, vx, vy, m and m/s.
    mode, other : ndarray of int, shape (...)
        Mode before, and how many modes on the next one is, 0 to 2.
    lateral_acceleration : float
        m/s^2.
    interval : float
        s.

    Returns
    -------
    mode : ndarray of int, shape (...)
        0 straight, 1 left, 2 right.
    half : ndarray, shape (...)
        rad.
    """
    lateral = lateral_acceleration * TURN_DIRECTIONS
    if COMPILED is None:
        after = NEXT_MODES.take(mode + other)
        vx, vy = np.ascontiguousarray(np.moveaxis(state[..., 2:], -1, 0))
        speed = np.maximum(np.sqrt(vx * vx + vy * vy), SMALLEST_SPEED)
        return after, 0.5 * interval * (lateral.take(after) / speed)
    after, half = np.empty(mode.shape, dtype=np.int64), np.empty(mode.shape)
    given = _contiguous(state, mode, other, lateral)
    COMPILED.begin((*given, after, half), mode.size, SMALLEST_SPEED, 0.5 * interval)
    return after, half


def finished_turns(
    state: FloatArray, half: FloatArray, noise: FloatArray, scale: float, interval: float
) -> FloatArray:
    """Return the particles after their turns: half of it, along the chord, the other half.

    Parameters
    ----------
    state : ndarray, shape (..., 4)
        x, y, vx, vy, m and m/s.
    half : ndarray, shape (...)
        Of the turns, rad.
    noise : ndarray, shape (..., 2)
        By which velocities change, in units of the scale.
    scale : float
        m/s.
    interval : float
        s.

    Returns
    -------
    ndarray, shape (..., 4)
        m and m/s.
    """
    sine, cosine = np.sin(half), np.cos(half)
    moved = np.empty(state.shape)
    if COMPILED is not None:
        given = _contiguous(state, half, sine, cosine, noise)
        COMPILED.finish((*given, moved), half.size, scale, interval)
        return moved
    x, y, vx, vy = np.ascontiguousarray(np.moveaxis(state, -1, 0))
    chord = np.ones(half.shape)
    np.divide(sine, half, out=chord, where=half != 0.0)
    chord *= interval
    push_x, push_y = np.moveaxis(noise * scale, -1, 0)
    mean_x, mean_y = cosine * vx - sine * vy, sine * vx + cosine * vy
    np.add(x, chord * mean_x + 0.5 * interval * push_x, out=moved[..., 0])
    np.add(y, chord * mean_y + 0.5 * interval * push_y, out=moved[..., 1])
    np.add(cosine * mean_x - sine * mean_y, push_x, out=moved[..., 2])
    np.add(sine * mean_x + cosine * mean_y, push_y, out=moved[..., 3])
    return moved


def cloud_moments(share: FloatArray, state: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return mean and covariance of clouds.

    Parameters
    ----------
    share : ndarray, shape (..., n)
        Weights with the sum 1, pure numbers.
    state : ndarray, shape (..., n, 4)
        x, y, vx, vy, m and m/s.

    Returns
    -------
    mean : ndarray, shape (..., 4)
        m and m/s.
    covariance : ndarray, shape (..., 4, 4)
        m^2, m^2/s, m^2/s^2.
    """
    *clouds, n_particles = share.shape
    mean, covariance = np.zeros((*clouds, 4)), np.zeros((*clouds, 4, 4))
    if COMPILED is not None:
        given = _contiguous(share, state)
        COMPILED.moments((*given, mean, covariance), math.prod(clouds), n_particles)
        return mean, covariance
    if not n_particles:
        return mean, covariance
    # One particle after the other: the sums of numpy take another order.
    mean[:] = np.cumsum(share[..., None] * state, axis=-2)[..., -1, :]
    away = state - mean[..., None, :]
    rows, columns = _UPPER
    terms = (share[..., None] * away)[..., rows] * away[..., columns]
    upper = np.cumsum(terms, axis=-2)[..., -1, :]
    covariance[..., rows, columns] = covariance[..., columns, rows] = upper
    return mean, covariance


def spread_particles(
    state: FloatArray,
    drawn: IntArray,
    noise: FloatArray,
    moments: tuple[FloatArray, FloatArray],
    shrink: float,
) -> FloatArray:
    """Return particles drawn from clouds, drawn together and spread by a kernel.

    Parameters
    ----------
    state : ndarray, shape (n_clouds, n, 4)
        x, y, vx, vy, m and m/s.
    drawn : ndarray of int, shape (n_clouds, n)
        Rows of the particles.
    noise : ndarray, shape (n_clouds, n, 4)
        Of unit variance.
    moments : tuple of ndarray, shape (n_clouds, 4) and (n_clouds, 4, 4)
        Means of the clouds, m and m/s; kernels A, A A^T their covariances, m and m/s.
    shrink : float
        By which the particles move towards the mean, a share.

    Returns
    -------
    ndarray, shape (n_clouds, n, 4)
        m and m/s.
    """
    mean, kernel = moments
    centre = (1.0 - shrink) * mean
    if COMPILED is not None:
        spread = np.empty(state.shape)
        given = _contiguous(state, drawn, noise, centre, kernel)
        COMPILED.spread((*given, spread), *drawn.shape, shrink)
        return spread
    spread = np.take_along_axis(state, drawn[..., None], axis=1)
    spread *= shrink
    spread += centre[:, None]
    push = noise[..., None, 0] * kernel[:, None, :, 0]
    for column in range(1, 4):
        push += noise[..., None, column] * kernel[:, None, :, column]
    spread += push
    return spread


def _contiguous(*columns: NDArray[Any]) -> tuple[NDArray[Any], ...]:
    return tuple(map(np.ascontiguousarray, columns))
