"""Forward-backward spatial smoothing of covariances of uniform lines: compiled, or in numpy.

``compiled_smoothing`` is there if a compiler was when the package was installed; the bits are those
of the coding in numpy.

References
----------
S. U. Pillai, B. H. Kwon, "Forward/backward spatial smoothing techniques for coherent signal
identification", IEEE Trans. ASSP 37(1), 1989.
"""

from __future__ import annotations

import math

import numpy as np

from sonar_tracking.compiled_modules import compiled_module
from sonar_tracking.records.arrays import ComplexArray

COMPILED = compiled_module("passive.sources.compiled_smoothing")
"""The compiled function, None where there is none."""


def forward_backward_smoothed(covariance: ComplexArray, n_smoothed: int) -> ComplexArray:
    """Return the spatially smoothed forward-backward covariance of a uniform line array.

    Parameters
    ----------
    covariance : ndarray, shape (..., n_elements, n_elements), complex
        Sample covariance, linear power.
    n_smoothed : int
        Elements of each sub-array.

    Returns
    -------
    ndarray, shape (..., n_smoothed, n_smoothed), complex
        (C_s + J conj(C_s) J) / 2 with C_s the mean over the sub-arrays, linear power.
    """
    if COMPILED is None:
        return _smoothed_in_numpy(covariance, n_smoothed)
    *batch, n_elements, _ = covariance.shape
    given = np.ascontiguousarray(covariance, dtype=np.complex128)
    smoothed = np.empty((*batch, n_smoothed, n_smoothed), dtype=np.complex128)
    COMPILED.smooth(given, smoothed, (math.prod(batch), n_elements, n_smoothed))
    return smoothed


def _smoothed_in_numpy(covariance: ComplexArray, n_smoothed: int) -> ComplexArray:
    n_elements = covariance.shape[-1]
    n_arrays = n_elements - n_smoothed + 1
    # Running sums along the diagonals: entry (i, j) of the sum over the sub-arrays is the
    # difference of two of them.
    running = np.array(covariance, dtype=np.complex128)
    for row in range(1, n_elements):
        running[..., row, 1:] += running[..., row - 1, :-1]
    smoothed = running[..., n_arrays - 1 :, n_arrays - 1 :].copy()
    smoothed[..., 1:, 1:] -= running[..., : n_smoothed - 1, : n_smoothed - 1]
    smoothed /= n_arrays
    return np.asarray(0.5 * (smoothed + smoothed[..., ::-1, ::-1].conj()))
