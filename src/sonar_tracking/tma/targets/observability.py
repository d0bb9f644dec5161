"""How much the data say about the motion, beyond what was assumed at the start.

    D = P0^(1/2) J P0^(1/2),   observability = lambda_min(D) / (1 + lambda_min(D)),

with J the Fisher information of all measurements on the initial motion (source frequencies
eliminated, no process noise, along the estimated track) and P0 the prior. In the worst direction
the posterior variance is 1 / (1 + lambda_min) of the prior's: below 0.5 the data say less than the
prior, and the position along the line of sight is what was assumed, not what was measured.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.records.arrays import FloatArray

OBSERVABLE = 0.5
"""Below this the solution follows its prior."""


@dataclass(frozen=True)
class MeasurementHistory:
    """Who measured what, how well, and when; values do not matter, only which there are.

    Attributes
    ----------
    times : ndarray, shape (n_frames,)
        s, from any origin; the first one is that of the prior.
    position, velocity : ndarray, shape (n_frames, 2)
        Of the sensor, m and m/s.
    azimuth_information, elevation_information : ndarray, shape (n_frames,)
        1 / variance, rad^-2; 0 = none.
    height : ndarray, shape (n_frames,)
        Of the target above the sensor, m.
    line_information : ndarray, shape (n_frames, n_lines)
        1 / variance, Hz^-2; 0 = absent.
    sound_speed : float
        m/s.
    """

    times: FloatArray
    position: FloatArray
    velocity: FloatArray
    azimuth_information: FloatArray
    elevation_information: FloatArray
    height: FloatArray
    line_information: FloatArray
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
        Hz; of lines with information only.
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
        Hz; of lines with information only.
    history : MeasurementHistory
        All measurements.

    Returns
    -------
    ndarray, shape (4, 4)
        1/m^2, s/m^2, s^2/m^2.
    """
    before = (history.times - history.times[-1])[:, None]
    offset = mean[:2] + mean[2:] * before - history.position
    distance = np.maximum(np.hypot(offset[:, 0], offset[:, 1]), 1.0)[:, None]
    direction = offset / distance
    normal = np.stack([-direction[:, 1], direction[:, 0]], axis=1)
    since = history.times[:, None]

    information = _weighted(_on_first(normal / distance, since), history.azimuth_information)
    if history.elevation_information.any():
        slope = -history.height / (distance[:, 0] ** 2 + history.height**2)
        elevation = _on_first(slope[:, None] * direction, since)
        information += _weighted(elevation, history.elevation_information)
    if not history.line_information.any():
        return information
    relative = mean[2:] - history.velocity
    rate = np.sum(direction * relative, axis=1)
    doppler = _on_first((relative - rate[:, None] * direction) / distance, since)
    doppler[:, 2:] += direction
    factor = 1.0 - rate / history.sound_speed
    weight = np.ascontiguousarray(history.line_information.T)
    own = (weight * factor**2).sum(axis=1)
    heard = own > 0.0
    weight, own = weight[heard], own[heard]
    # What is left of each line when its source frequency has to be found from it, too.
    common = ((weight * factor)[:, None] @ doppler) / own[:, None, None]
    left = doppler - factor[:, None] * common
    scale = (source_frequency[heard] / history.sound_speed) ** 2
    for line in scale[:, None, None] * _weighted(left, weight):
        information += line
    return information


def _on_first(by_position: FloatArray, since: FloatArray) -> FloatArray:
    """Refer derivatives by the position at each time to the motion at the first time."""
    return np.concatenate([by_position, by_position * since], axis=1)


def _weighted(rows: FloatArray, weight: FloatArray) -> FloatArray:
    return np.asarray(np.swapaxes(rows * weight[..., None], -1, -2) @ rows)
