"""Conventional beamformer: received power as a function of arrival angle.

Each steering vector is one beam, b(theta) = |a(theta)^H x|^2 / M^2: a plane wave of power p on
every element gives p in its own direction. It resolves nothing closer than a beamwidth and
assumes nothing: what an operator looks at.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.geometry import steering_vectors
from sonar_tracking.records.arrays import ComplexArray, FloatArray


def beam_powers(
    snapshots: ComplexArray, positions: FloatArray, angles: FloatArray, wavenumber: float
) -> FloatArray:
    """Return the mean power of each beam.

    Parameters
    ----------
    snapshots : ndarray, shape (n_snapshots, n_elements), complex
        Linear amplitude; averaged over.
    positions : ndarray, shape (n_elements, 3)
        Element positions, m.
    angles : ndarray, shape (n_angles,)
        Arrival angles of the beams, rad.
    wavenumber : float
        rad/m.

    Returns
    -------
    ndarray, shape (n_angles,)
        Linear.
    """
    vectors = steering_vectors(positions, angles, wavenumber)
    beams = snapshots @ vectors.conj() / len(positions)
    return np.asarray(np.mean(beams.real**2 + beams.imag**2, axis=0))
