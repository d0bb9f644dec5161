"""Counting sources that may move: on as many snapshots as their motion allows.

A strong source that turns during the snapshots looks like two (see
:func:`~sonar_tracking.passive.sources.mdl.counting_snapshots`), while a weak one needs many
snapshots to be seen at all. So the strong ones are counted first, on so few snapshots that even
the fastest bearing stands still; their bearings in both halves of the data then tell how fast
they really turn, and with that how many snapshots may be used to find the weak ones too.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.geometry import wavenumber
from sonar_tracking.passive.sources.mdl import (
    LEAST_COUNTING_SNAPSHOTS,
    counting_snapshots,
    source_count,
)
from sonar_tracking.passive.sources.music import music_bearings
from sonar_tracking.passive.sources.steering_error import with_steering_error
from sonar_tracking.records.arrays import ComplexArray, FloatArray
from sonar_tracking.records.bearings import ArraySnapshots


def count_moving_sources(
    snapshots: ComplexArray,
    covariance: ComplexArray,
    eigenvalues: FloatArray,
    header: ArraySnapshots,
    maximum_rate: float,
    thorough: bool,
    steering_error: float = 0.0,
) -> int:
    """Return the number of sources seen by a uniform line array, -1 with too few snapshots.

    Parameters
    ----------
    snapshots : ndarray, shape (n_snapshots, n_elements), complex
        Linear amplitude, not whitened.
    covariance : ndarray, shape (n_elements, n_elements), complex
        Of all of them, linear power.
    eigenvalues : ndarray, shape (n_elements,)
        Of their covariance, with the floor of the steering errors, linear power, descending.
    header : ArraySnapshots
        Array and frequency.
    maximum_rate : float
        Fastest bearing that must not be counted twice, rad/s.
    thorough : bool
        Also find out how fast the strong sources really turn, to see weak ones beside them.
    steering_error : float
        Relative rms error of the steering vectors.
    """
    n_snapshots = len(snapshots)
    if n_snapshots < LEAST_COUNTING_SNAPSHOTS:
        return -1
    number = wavenumber(header.center_frequency, header.sound_speed)
    positions, noise = header.element_positions, header.noise_covariance
    fastest = maximum_rate * header.sample_period
    used = counting_snapshots(eigenvalues, n_snapshots, positions, number, fastest)

    def count_on_newest(n_newest: int) -> int:
        whole = n_newest == n_snapshots
        newest = covariance if whole else sample_covariance(snapshots[-n_newest:])
        return source_count(with_steering_error(newest, steering_error, noise), n_newest, noise)

    count = count_on_newest(used)
    while count == 0 and used < n_snapshots:
        used = min(2 * used, n_snapshots)
        count = count_on_newest(used)
    if count == 0 or used == n_snapshots or not thorough:
        return count
    turn = _largest_turn(snapshots, count, positions, number, noise)
    allowed = counting_snapshots(eigenvalues, n_snapshots, positions, number, min(turn, fastest))
    return max(count, count_on_newest(allowed)) if allowed > used else count


def sample_covariance(snapshots: ComplexArray) -> ComplexArray:
    """Return the sample covariance X X^H / N.

    Parameters
    ----------
    snapshots : ndarray, shape (..., N, n_elements), complex
        Linear amplitude.

    Returns
    -------
    ndarray, shape (..., n_elements, n_elements), complex
        Linear power.
    """
    return np.swapaxes(snapshots, -1, -2) @ snapshots.conj() / snapshots.shape[-2]


def _largest_turn(
    snapshots: ComplexArray,
    count: int,
    positions: FloatArray,
    number: float,
    noise: ComplexArray | None,
) -> float:
    """Return the largest change of the strong bearings per snapshot, rad; inf = not known."""
    half = len(snapshots) // 2
    if count >= min(half, len(positions)):
        return np.inf
    early, late = (
        music_bearings(sample_covariance(part), count, positions, number, noise)
        for part in (snapshots[:half], snapshots[-half:])
    )
    if len(early) != count or len(late) != count:
        return np.inf
    return float(np.abs(late - early).max()) / (len(snapshots) - half)
