"""The path of a recorded track with hindsight, from what its filter said: where to start from.

Fixed-interval smoothing (Rauch, Tung and Striebel 1965) of the rows of a recorded track list: it
needs what a filter said after each measurement and how the target may have moved in between, not
the measurements. The rows of a bank of filters are the moments of a mixture; they are smoothed as
if they were those of one filter.

Where a filter has allowed for more motion than the process noise given, because the target turned,
its covariance says so: it is larger than it could be after a prediction with that noise. As much is
allowed for here.

References
----------
Rauch, Tung and Striebel, "Maximum likelihood estimates of linear dynamic systems", AIAA J. 3(8),
1965.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.filtering.constant_velocity import in_plane, process_noise_matrix
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.tma.estimators.sensor_frame import KINEMATIC


@dataclass(frozen=True)
class TrackPath:
    """States of one track in order of time.

    Attributes
    ----------
    times : ndarray, shape (n,)
        s, increasing.
    mean : ndarray, shape (n, 4)
        x, y, vx, vy, m and m/s.
    covariance : ndarray, shape (n, 4, 4)
        m^2, m^2/s, m^2/s^2.
    """

    times: FloatArray
    mean: FloatArray
    covariance: FloatArray


def smooth_path(path: TrackPath, acceleration: float) -> TrackPath:
    """Return the smoothed states of one track.

    Parameters
    ----------
    path : TrackPath
        As the filter gave them.
    acceleration : float
        Process noise, m/s^2.
    """
    mean, covariance = path.mean.copy(), path.covariance.copy()
    for index in range(len(path.times) - 2, -1, -1):
        interval = float(path.times[index + 1] - path.times[index])
        transition = np.eye(KINEMATIC)
        transition[0, 2] = transition[1, 3] = interval
        ahead = transition @ path.covariance[index] @ transition.T
        ahead += process_noise(ahead, path.covariance[index + 1], interval, acceleration)
        crossed = transition @ path.covariance[index]
        gain = np.linalg.solve(ahead, crossed).T
        mean[index] += gain @ (mean[index + 1] - transition @ path.mean[index])
        change = gain @ (covariance[index + 1] - ahead) @ gain.T
        covariance[index] += 0.5 * (change + change.T)
    return TrackPath(path.times, mean, covariance)


def process_noise(
    moved: FloatArray, after: FloatArray, interval: float, acceleration: float
) -> FloatArray:
    """Return the noise of an interval: that given, or as much as the filter allowed for.

    Parameters
    ----------
    moved, after : ndarray, shape (4, 4)
        Covariance after the interval without noise, and what the filter said there, m^2, m^2/s,
        m^2/s^2. A measurement can only have made that smaller.
    interval : float
        s.
    acceleration : float
        m/s^2.

    Returns
    -------
    ndarray, shape (4, 4)
        In the same units.
    """
    velocity = slice(2, KINEMATIC)
    grown = float(np.linalg.eigvalsh(after[velocity, velocity] - moved[velocity, velocity])[-1])
    density = max(acceleration**2, grown / interval)
    return in_plane(process_noise_matrix(density, interval))
