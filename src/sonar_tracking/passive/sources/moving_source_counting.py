"""Counting sources that may move: on as many snapshots as their motion allows.

A strong source that turns during the snapshots looks like two (see
:func:`~sonar_tracking.passive.sources.mdl.counting_snapshots`), while a weak one needs many
snapshots to be seen at all. So the strong ones are counted first, on so few snapshots that even
the fastest bearing stands still; their bearings in both halves of the data then tell how fast
they really turn, and with that how many snapshots may be used to find the weak ones too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.geometry import wavenumber
from sonar_tracking.passive.sources.mdl import (
    LEAST_COUNTING_SNAPSHOTS,
    counting_snapshots,
    source_counts,
)
from sonar_tracking.passive.sources.music import bearings_in_snapshots
from sonar_tracking.passive.sources.noise_of_windows import of_windows
from sonar_tracking.passive.sources.steering_error import with_steering_error
from sonar_tracking.records.arrays import ComplexArray, FloatArray, IndexArray, IntArray
from sonar_tracking.records.bearings import ArraySnapshots


def count_moving_sources(
    snapshots: ComplexArray,
    covariance: ComplexArray,
    eigenvalues: FloatArray,
    header: ArraySnapshots,
    maximum_rate: float,
    thorough: bool,
    steering_error: float | FloatArray = 0.0,
) -> IntArray:
    """Return the number of sources seen by a uniform line array, -1 with too few snapshots.

    Parameters
    ----------
    snapshots : ndarray, shape (..., n_snapshots, n_elements), complex
        Linear amplitude, not whitened; of any number of windows.
    covariance : ndarray, shape (..., n_elements, n_elements), complex
        Of all of them, linear power.
    eigenvalues : ndarray, shape (..., n_elements)
        Of their covariance, with the floor of the steering errors, linear power, descending.
    header : ArraySnapshots
        Array and frequency; its noise covariance is that of all windows, or of each.
    maximum_rate : float
        Fastest bearing that must not be counted twice, rad/s.
    thorough : bool
        Also find out how fast the strong sources really turn, to see weak ones beside them.
    steering_error : float or ndarray, shape (...)
        Relative rms error of the steering vectors, pure number.

    Returns
    -------
    ndarray of int, shape (...)
        One a window.
    """
    n_snapshots, n_elements = snapshots.shape[-2:]
    batch = snapshots.shape[:-2]
    if n_snapshots < LEAST_COUNTING_SNAPSHOTS:
        return np.full(batch, -1)
    windows = _Windows(
        snapshots.reshape(-1, n_snapshots, n_elements),
        covariance.reshape(-1, n_elements, n_elements),
        header,
        np.broadcast_to(steering_error, batch).reshape(-1),
    )
    values = eigenvalues.reshape(-1, n_elements)
    fastest = maximum_rate * header.sample_period
    rows = np.arange(len(values))
    used = windows.allowed(values, fastest)
    count = windows.count(rows, used)
    while (rows := np.flatnonzero((count == 0) & (used < n_snapshots))).size:
        used[rows] = np.minimum(2 * used[rows], n_snapshots)
        count[rows] = windows.count(rows, used[rows])
    rows = np.flatnonzero((count > 0) & (used < n_snapshots))
    if thorough and rows.size:
        turn = windows.largest_turn(rows, count[rows])
        allowed = windows.allowed(values[rows], np.minimum(turn, fastest))
        more = allowed > used[rows]
        rows, allowed = rows[more], allowed[more]
        count[rows] = np.maximum(count[rows], windows.count(rows, allowed))
    return count.reshape(batch)


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
    products = np.swapaxes(snapshots, -1, -2) @ snapshots.conj()
    products /= snapshots.shape[-2]
    return products


@dataclass(frozen=True)
class _Windows:
    """Equally long windows of snapshots of one array, (n_windows, n_snapshots, n_elements)."""

    snapshots: ComplexArray
    covariance: ComplexArray
    header: ArraySnapshots
    steering_error: FloatArray

    @property
    def number(self) -> float:
        """Wavenumber, rad/m."""
        return wavenumber(self.header.center_frequency, self.header.sound_speed)

    def allowed(self, eigenvalues: FloatArray, turn: FloatArray | float) -> IntArray:
        """Return how many snapshots of some windows to count on, by the turn a snapshot, rad."""
        n_snapshots, positions = self.snapshots.shape[-2], self.header.element_positions
        return counting_snapshots(eigenvalues, n_snapshots, positions, self.number, turn)

    def count(self, rows: IndexArray, n_newest: IntArray) -> IntArray:
        """Return the number of sources in the newest snapshots of some windows."""
        noise, counts = self.header.noise_covariance, np.zeros_like(n_newest)
        kinds = set(n_newest.tolist())
        for n in kinds:
            together = n_newest == n if len(kinds) > 1 else slice(None)
            if n == self.snapshots.shape[-2]:
                newest = self.covariance[rows[together]]
            else:
                newest = sample_covariance(self.snapshots[rows[together], -n:])
            own = of_windows(noise, rows[together])
            loaded = with_steering_error(newest, self.steering_error[rows[together]], own)
            counts[together] = source_counts(loaded, n, own)
        return counts

    def largest_turn(self, rows: IndexArray, counts: IntArray) -> FloatArray:
        """Return the largest change of the strong bearings a snapshot, rad; inf = not known."""
        positions, noise = self.header.element_positions, self.header.noise_covariance
        turn = np.empty(len(rows))
        for count in set(counts.tolist()):
            together = counts == count
            own = self.snapshots[rows[together]]
            own_noise = of_windows(noise, rows[together])
            turn[together] = _largest_turn(own, count, positions, self.number, own_noise)
        return turn


def _largest_turn(
    snapshots: ComplexArray,
    count: int,
    positions: FloatArray,
    number: float,
    noise: ComplexArray | None,
) -> FloatArray:
    """Return the largest change of the strong bearings per snapshot, rad; inf = not known."""
    n_snapshots, n_elements = snapshots.shape[-2:]
    half, batch = n_snapshots // 2, snapshots.shape[:-2]
    if count >= min(half, n_elements):
        return np.full(batch, np.inf)
    halves = np.stack([snapshots[..., :half, :], snapshots[..., -half:, :]])
    windows = halves.reshape(-1, half, n_elements)
    if noise is not None and noise.ndim > 2:
        noise = np.concatenate([noise, noise])
    early, late = bearings_in_snapshots(windows, count, positions, number, noise).reshape(
        2, *batch, count
    )
    turn = np.abs(late - early).max(axis=-1) / (n_snapshots - half)
    return np.where(np.isnan(turn), np.inf, turn)
