"""Narrowband snapshots of moving sources in noise.

    x(t) = sum_n a(theta_n(t)) s_n(t) + v(t)

with the steering vectors a of the array, source signals s_n and noise v; bearings move from
snapshot to snapshot. The model of Ryu, Park, Choi 2003, eq. 1, and of Hwang et al. 2005, eq. 1.
"""

from __future__ import annotations

import math

import numpy as np

from sonar_tracking.geometry import steering_vectors
from sonar_tracking.records.arrays import ComplexArray, FloatArray

ENTRIES_AT_ONCE = 1 << 16
"""Entries that are computed at a time (1 MB): what is added to the data stays in the cache."""


def circular_gaussian(generator: np.random.Generator, shape: tuple[int, ...]) -> ComplexArray:
    """Return independent circular complex Gaussian numbers of power 1 (linear), in any shape."""
    pairs = generator.standard_normal((*shape, 2))
    pairs *= np.sqrt(0.5)
    return pairs.view(np.complex128)[..., 0]


def synthesize_snapshots(
    element_positions: FloatArray,
    wavenumber: float,
    arrival_angles: FloatArray,
    signals: ComplexArray,
    noise: ComplexArray,
) -> ComplexArray:
    """Return the snapshots an array receives.

    Parameters
    ----------
    element_positions : ndarray, shape (n_elements, 3)
        In the frame of the array, m.
    wavenumber : float
        rad/m.
    arrival_angles : ndarray, shape (n_snapshots, n_sources)
        At each snapshot, rad from broadside; the same for all batch entries.
    signals : ndarray, shape (..., n_snapshots, n_sources), complex
        Source signals at the first element, linear amplitude.
    noise : ndarray, shape (..., n_snapshots, n_elements), complex
        Added to the sum, linear amplitude; leading dimensions as in ``signals``.

    Returns
    -------
    ndarray, shape (..., n_snapshots, n_elements), complex
        Snapshots, linear amplitude.
    """
    n_snapshots, n_sources = arrival_angles.shape
    if signals.shape[-2:] != (n_snapshots, n_sources):
        raise ValueError(
            f"signals have shape {signals.shape}; for arrival_angles of shape "
            f"{arrival_angles.shape} they must end in ({n_snapshots}, {n_sources})."
        )
    data = np.array(noise, dtype=np.complex128)
    n_entries = len(element_positions) * max(1, n_sources, math.prod(data.shape[:-2]))
    step = max(1, ENTRIES_AT_ONCE // n_entries)
    for first in range(0, n_snapshots, step):
        part = slice(first, first + step)
        steering = steering_vectors(element_positions, arrival_angles[part], wavenumber)
        for source, wave in enumerate(np.moveaxis(steering, -1, 0).copy()):
            data[..., part, :] += wave * signals[..., part, source, None]
    return data


def rounded_to_single(data: ComplexArray) -> ComplexArray:
    """Return data, shape (...) and any unit, as they are after single precision messages."""
    return data.astype(np.complex64).astype(np.complex128)
