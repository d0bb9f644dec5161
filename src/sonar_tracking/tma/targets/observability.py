"""How much the data say about the motion, beyond what was assumed at the start.

    D = P0^(1/2) J P0^(1/2),   observability = lambda_min(D) / (1 + lambda_min(D)),

with J the Fisher information of all measurements on the initial motion (source frequencies
eliminated, no process noise, along the estimated track) and P0 the prior. In the worst direction
the posterior variance is 1 / (1 + lambda_min) of the prior's: below 0.5 the data say less than the
prior, and the position along the line of sight is what was assumed, not what was measured.

``compiled_information``, which is there if a compiler was when the package was installed, adds up
in the same order as numpy does here, and gives the same bits.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.compiled_modules import compiled_module
from sonar_tracking.records.arrays import FloatArray

COMPILED = compiled_module("tma.targets.compiled_information")

MOTION = 4
"""Components of a motion: x, y, vx, vy."""

_UPPER = np.triu_indices(MOTION)

OBSERVABLE = 0.5
"""Below this the solution follows its prior."""


TIME, POSITION, VELOCITY = 0, slice(1, 3), slice(3, 5)
AZIMUTH, ELEVATION, HEIGHT, LINES = 5, 6, 7, 8
"""Columns of a history; one a line from the last on."""


@dataclass(frozen=True)
class MeasurementHistory:
    """Who measured what, how well, and when; values do not matter, only which there are.

    Attributes
    ----------
    table : ndarray, shape (n_frames, 8 + n_lines)
        One row a frame, at least one: time in s from any origin (the first one is that of the
        prior); position and velocity of the sensor, m and m/s; 1 / variance of the azimuth and of
        the elevation, rad^-2, 0 = none; height of the target above the sensor, m; 1 / variance of
        each line, Hz^-2, 0 = absent.
    sound_speed : float
        m/s.
    """

    table: FloatArray
    sound_speed: float


def observability(
    mean: FloatArray, source_frequency: FloatArray, history: MeasurementHistory, root: FloatArray
) -> float:
    """Return the observability figure in [0, 1].

    Parameters
    ----------
    mean : ndarray, shape (4,)
        Estimated motion at the last time of the history, m and m/s; the track is prolonged
        backwards.
    source_frequency : ndarray, shape (n_lines,)
        Hz; any of a line without information, and of those that were forgotten none.
    history : MeasurementHistory
        All measurements.
    root : ndarray, shape (4, 4)
        Symmetric root of the prior covariance of the motion at the first time, m and m/s.
    """
    information = motion_information(mean, source_frequency, history)
    smallest = max(float(np.linalg.eigvalsh(root @ information @ root)[0]), 0.0)
    return smallest / (1.0 + smallest)


def root_of(prior: FloatArray) -> FloatArray:
    """Return the symmetric root of a covariance.

    Parameters
    ----------
    prior : ndarray, shape (n, n)
        m^2, m^2/s, m^2/s^2.

    Returns
    -------
    ndarray, shape (n, n)
        m and m/s.
    """
    values, vectors = np.linalg.eigh(prior)
    return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)) @ vectors.T)


def motion_information(
    mean: FloatArray, source_frequency: FloatArray, history: MeasurementHistory
) -> FloatArray:
    """Return the information on the motion at the first time, source frequencies eliminated.

    Parameters
    ----------
    mean : ndarray, shape (4,)
        Estimated motion at the last time of the history, m and m/s.
    source_frequency : ndarray, shape (n_lines,)
        Hz; any of a line without information, and of those that were forgotten none.
    history : MeasurementHistory
        All measurements.

    Returns
    -------
    ndarray, shape (4, 4)
        1/m^2, s/m^2, s^2/m^2.
    """
    scale = (source_frequency / history.sound_speed) ** 2
    if COMPILED is None:
        return _information(mean, scale, history)
    information = np.empty((MOTION, MOTION))
    table = np.ascontiguousarray(history.table)
    given = table, np.ascontiguousarray(mean), scale, information
    COMPILED.inform(*given, (*table.shape, len(scale)), history.sound_speed)
    return information


def _information(mean: FloatArray, scale: FloatArray, history: MeasurementHistory) -> FloatArray:
    """Return the same in numpy; scale is that of each line, shape (n_lines,), s^2/m^2 Hz^2."""
    table = history.table
    since, height = table[:, TIME], table[:, HEIGHT]
    offset = mean[:2] + mean[2:] * (since - since[-1])[:, None] - table[:, POSITION]
    distance = np.maximum(np.hypot(offset[:, 0], offset[:, 1]), 1.0)[:, None]
    direction = offset / distance
    normal = np.stack([-direction[:, 1], direction[:, 0]], axis=1)
    information = _weighted(_on_first(normal / distance, since), table[:, AZIMUTH])
    slope = -height / (distance[:, 0] * distance[:, 0] + height * height)
    elevation = np.where(table[:, ELEVATION] == 0.0, 0.0, slope)[:, None] * direction
    information += _weighted(_on_first(elevation, since), table[:, ELEVATION])
    if not len(scale):
        return information
    relative = mean[2:] - table[:, VELOCITY]
    rate = direction[:, :1] * relative[:, :1] + direction[:, 1:] * relative[:, 1:]
    doppler = _on_first((relative - rate * direction) / distance, since)
    doppler[:, 2:] += direction
    factor = 1.0 - rate / history.sound_speed
    for line, weight in zip(scale, table[:, LINES : LINES + len(scale)].T, strict=True):
        own = _sum(weight * (factor[:, 0] * factor[:, 0]))
        if own > 0.0:
            # What is left of the line when its source frequency has to be found from it, too.
            common = _sum(weight[:, None] * factor * doppler) / own
            information += line * _weighted(doppler - factor * common, weight)
    return information


def _on_first(by_position: FloatArray, since: FloatArray) -> FloatArray:
    """Refer derivatives by the position at each time to the motion at the first time."""
    return np.concatenate([by_position, by_position * since[:, None]], axis=1)


def _weighted(rows: FloatArray, weight: FloatArray) -> FloatArray:
    first, second = _UPPER
    information = np.empty((MOTION, MOTION))
    upper = _sum((rows * weight[:, None])[:, first] * rows[:, second])
    information[first, second] = information[second, first] = upper
    return information


def _sum(terms: FloatArray) -> FloatArray:
    """Return the sum over the frames, one after the other: that of numpy takes another order."""
    return np.asarray(np.add.accumulate(terms, axis=0)[-1])
