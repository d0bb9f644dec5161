"""Stochastic Fisher information of arrival angles: what the snapshots can tell at best.

The sources are Gaussian with unknown covariance P_s in noise of unknown power sigma^2:

    J = (2 N / sigma^2) Re[(D^H P_A D) o (P_s A^H R^-1 A P_s)^T],  R = A P_s A^H + sigma^2 I,

o elementwise, P_A the projector on the complement of the steering vectors. In coloured noise
everything is whitened first. J is singular where two sources coincide: add prior information
before inverting it.

References
----------
P. Stoica, A. Nehorai, "Performance study of conditional and unconditional direction-of-arrival
estimation", IEEE Trans. ASSP 38(10), 1990, eq. 3.1.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.geometry import steering_pair, steering_vectors
from sonar_tracking.records.arrays import ComplexArray, FloatArray

_LEAST_SEPARABLE = 0.03
"""Singular values of the steering matrix below this share of the largest are not inverted."""


def stochastic_fisher_information(
    positions: FloatArray,
    angles: FloatArray,
    wavenumber: float,
    source_covariance: ComplexArray,
    noise_power: FloatArray | float,
    snapshots: float,
    noise_covariance: ComplexArray | None = None,
) -> FloatArray:
    """Return the Fisher information of the arrival angles, nuisance parameters unknown.

    Parameters
    ----------
    positions : ndarray, shape (n_elements, 3)
        Element positions, m.
    angles : ndarray, shape (..., n_sources)
        rad.
    wavenumber : float
        rad/m.
    source_covariance : ndarray, shape (..., n_sources, n_sources), complex
        P_s, linear powers; any rank.
    noise_power : float or ndarray, shape (...)
        sigma^2, linear.
    snapshots : float
        N, independent snapshots.
    noise_covariance : ndarray, shape (n_elements, n_elements), complex, optional
        Pure numbers with trace n_elements; None = white.

    Returns
    -------
    ndarray, shape (..., n_sources, n_sources)
        J, 1/rad^2.
    """
    vectors, derivatives = steering_pair(positions, angles, wavenumber)
    if noise_covariance is not None:
        factor = np.linalg.cholesky(noise_covariance)
        vectors = np.asarray(np.linalg.solve(factor, vectors), dtype=np.complex128)
        derivatives = np.asarray(np.linalg.solve(factor, derivatives), dtype=np.complex128)
    power = np.asarray(noise_power, dtype=np.float64)[..., None, None]
    # Products of orthonormal columns stay accurate where two steering vectors nearly coincide.
    orthonormal = np.linalg.qr(vectors).Q
    outside = derivatives - orthonormal @ (_hermitian(orthonormal) @ derivatives)
    curvature = _hermitian(outside) @ outside
    # P_s A^H R^-1 A P_s = P_s G (sigma^2 I + P_s G)^-1 P_s with G = A^H A: small matrices only.
    product = source_covariance @ (_hermitian(vectors) @ vectors)
    full = product + power * np.eye(product.shape[-1])
    signal = product @ np.linalg.solve(full, np.broadcast_to(source_covariance, full.shape))
    information = (curvature * np.swapaxes(signal, -1, -2)).real
    information = 0.5 * (information + np.swapaxes(information, -1, -2))
    return np.asarray(2.0 * snapshots / power * information, dtype=np.float64)


def source_covariance(
    covariance: ComplexArray,
    positions: FloatArray,
    angles: FloatArray,
    wavenumber: float,
    noise_power: FloatArray,
    noise_covariance: ComplexArray | None = None,
) -> ComplexArray:
    """Return the covariance of the sources at known angles, S^+ (C - sigma^2 C_v) S^+H.

    Negative parts, which sampling noise brings, are set to zero; sources too close to be told
    apart share their power.

    Parameters
    ----------
    covariance : ndarray, shape (..., n_elements, n_elements), complex
        Sample covariance C, linear power.
    positions : ndarray, shape (n_elements, 3)
        m.
    angles : ndarray, shape (..., n_sources)
        rad.
    wavenumber : float
        rad/m.
    noise_power : ndarray, shape (...)
        sigma^2, linear.
    noise_covariance : ndarray, shape (n_elements, n_elements), complex, optional
        C_v, pure numbers with trace n_elements; None = identity.

    Returns
    -------
    ndarray, shape (..., n_sources, n_sources), complex
        P_s, linear power; Hermitian and not negative.
    """
    shape = np.eye(covariance.shape[-1]) if noise_covariance is None else noise_covariance
    power = np.asarray(noise_power, dtype=np.float64)[..., None, None]
    signal = covariance - power * shape
    vectors = steering_vectors(positions, angles, wavenumber)
    inverse = np.asarray(np.linalg.pinv(vectors, rcond=_LEAST_SEPARABLE), dtype=np.complex128)
    sources = inverse @ signal @ _hermitian(inverse)
    values, modes = np.linalg.eigh(0.5 * (sources + _hermitian(sources)))
    return np.asarray((modes * np.maximum(values, 0.0)[..., None, :]) @ _hermitian(modes))


def _hermitian(matrix: ComplexArray) -> ComplexArray:
    return np.swapaxes(matrix, -1, -2).conj()
