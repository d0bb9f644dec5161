"""Angular innovation: how far a target lies from its predicted arrival angle.

With P_r the projector on the complement of the signal subspace, y = P_r a(theta) and
u = P_r a'(theta) at the prediction, the steering vector of the true angle lies in the signal
subspace, so that y + u delta = 0 to first order:

    delta = -Re(u^H y) / |u|^2.

The published eq. 6 has one minus too many and diverges. The phase reference matters as soon as
the residual y is not zero: with the first element as reference |u|^2 grows with |y|^2 and the
innovation shrinks; with the array centre it does not.

References
----------
Ryu, Park, Choi (2003), eqs. 5-8.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.geometry import steering_pair
from sonar_tracking.records.arrays import ComplexArray, FloatArray

_RELATIVE_FLOOR = 1e-12
"""Least |u|^2 as a share of what the whole array would give at broadside."""


def angular_innovations(
    basis: ComplexArray,
    positions: FloatArray,
    predicted_angles: FloatArray,
    wavenumber: float,
    phase_reference: str = "first_element",
) -> FloatArray:
    """Return the angular innovation of each target in each subspace.

    Parameters
    ----------
    basis : ndarray, shape (..., n_subspaces, n_elements, n_columns), complex
        Bases of the signal subspace; columns need not be orthonormal. Pure numbers.
    positions : ndarray, shape (n_elements, 3)
        Element positions, m.
    predicted_angles : ndarray, shape (..., n_targets)
        Predictions, rad.
    wavenumber : float
        rad/m.
    phase_reference : {"first_element", "array_centre"}
        See :func:`sonar_tracking.geometry.steering_vectors`.

    Returns
    -------
    ndarray, shape (..., n_subspaces, n_targets)
        rad; the measurement is the prediction plus the innovation.

    References
    ----------
    Ryu, Park, Choi (2003), eq. 6 with the sign corrected.
    """
    vectors, derivatives = steering_pair(positions, predicted_angles, wavenumber, phase_reference)
    n_targets = vectors.shape[-1]
    both = np.concatenate([vectors, derivatives], axis=-1)[..., None, :, :]
    orthonormal = np.linalg.qr(basis).Q
    within = np.swapaxes(orthonormal, -1, -2).conj() @ both
    outside = both - orthonormal @ within
    y, u = outside[..., :n_targets], outside[..., n_targets:]
    numerator = (u.real * y.real + u.imag * y.imag).sum(axis=-2)
    squared = (u.real**2 + u.imag**2).sum(axis=-2)
    floor = _RELATIVE_FLOOR * wavenumber**2 * float(np.sum((positions - positions[0]) ** 2))
    return -numerator / np.maximum(squared, floor)
