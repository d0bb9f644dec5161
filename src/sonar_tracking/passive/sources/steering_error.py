"""What a source brings beside its steering vector: a floor in proportion to the received power.

Gain and phase errors of the elements, reflections that arrive later than a snapshot lasts and
curved wavefronts make the wave of a source differ from its steering vector. With independent
errors of relative variance e^2 at the M elements, the array receives

    sum_n p_n (a_n + d_n)(a_n + d_n)^H + sigma^2 C_v  ->  A P A^H + (sigma^2 + e^2 p) C_v,

p = trace / M being the received power of an element. Only the expectation of the errors is known,
while the ones at hand are the same in every snapshot or fade slowly, so that a count of sources
takes them for sources. Adding e^2 p C_v to the sample covariance (diagonal loading) puts them
under the noise that everything downstream sees: counts, existence and variances.

References
----------
A. L. Swindlehurst, T. Kailath, "A performance analysis of subspace-based methods in the presence of
model errors, part I: the MUSIC algorithm", IEEE Trans. Signal Processing 40(7), 1992, for the model
of independent errors.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.records.arrays import ComplexArray, FloatArray


def with_steering_error(
    covariance: ComplexArray,
    steering_error: float | FloatArray,
    noise_covariance: ComplexArray | None = None,
) -> ComplexArray:
    """Return a covariance with the floor of the steering errors.

    Parameters
    ----------
    covariance : ndarray, shape (..., n_elements, n_elements), complex
        Sample covariance, linear power.
    steering_error : float or ndarray, shape (...)
        Relative rms error e of an element of the steering vectors, pure number.
    noise_covariance : ndarray, shape (..., n_elements, n_elements), complex, optional
        C_v, pure numbers with trace n_elements; None = white. The floor has its colour, so
        that it is white where the noise is.

    Returns
    -------
    ndarray, shape (..., n_elements, n_elements), complex
        Linear power.
    """
    if not np.any(steering_error):
        return covariance
    n_elements = covariance.shape[-1]
    shape = np.eye(n_elements) if noise_covariance is None else noise_covariance
    floor = steering_error_floor(covariance, steering_error)
    return np.asarray(covariance + floor[..., None, None] * shape, dtype=np.complex128)


def steering_error_floor(
    covariance: ComplexArray, steering_error: float | FloatArray
) -> FloatArray:
    """Return the power that the steering errors bring to an element, e^2 trace / M.

    Parameters
    ----------
    covariance : ndarray, shape (..., n_elements, n_elements), complex
        Sample covariance, linear power.
    steering_error : float or ndarray, shape (...)
        Relative rms error e of an element of the steering vectors, pure number.

    Returns
    -------
    ndarray, shape (...)
        Linear power.
    """
    power = np.trace(covariance, axis1=-2, axis2=-1).real / covariance.shape[-1]
    return np.asarray(steering_error**2 * power, dtype=np.float64)
