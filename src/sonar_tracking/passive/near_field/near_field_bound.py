"""Cramer-Rao bound of bearing and range of sources in the near field of an array.

Gaussian sources of unknown covariance P in white noise of unknown power sigma^2: the information of
the bearings alone (:mod:`sonar_tracking.passive.performance.fisher_information`) with two
derivatives a source, D = [dA/dtheta, dA/dr] of shape (M, 2 n):

    J = (2 N / sigma^2) Re[(D^H P_A D) o (W^T (x) 1)],  W = P A^H R^-1 A P,

(x) 1 repeating W for the four pairs of parameters. An array tells the range only from the
curvature u = 1 / r, so that the standard deviation of r grows like r^2.

References
----------
P. Stoica, A. Nehorai, "Performance study of conditional and unconditional direction-of-arrival
estimation", IEEE Trans. ASSP 38(10), 1990, eq. 3.1, for several parameters a source; M. N. El
Korso, R. Boyer, A. Renaux, S. Marcos, "Conditional and unconditional Cramer-Rao bounds for
near-field source localization", IEEE Trans. Signal Processing 58(5), 2010.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.passive.near_field.spherical_steering import spherical_derivatives
from sonar_tracking.records.arrays import ComplexArray, FloatArray


def near_field_information(
    positions: FloatArray,
    angles: FloatArray,
    ranges: FloatArray,
    wavenumber: float,
    source_covariance: ComplexArray,
    noise_power: float,
    snapshots: float,
) -> FloatArray:
    """Return the Fisher information of bearings and ranges, nuisance parameters unknown.

    Parameters
    ----------
    positions : ndarray, shape (n_elements, 3)
        m.
    angles, ranges : ndarray, shape (n_sources,)
        At the centre of the array, rad and m.
    wavenumber : float
        rad/m.
    source_covariance : ndarray, shape (n_sources, n_sources), complex
        P, linear power at the centre of the array.
    noise_power : float
        sigma^2, linear power.
    snapshots : float
        N, independent snapshots.

    Returns
    -------
    ndarray, shape (2 n_sources, 2 n_sources)
        J of [angles, ranges]; 1/rad^2, 1/(rad m), 1/m^2.
    """
    curvatures = 1.0 / ranges
    vectors, by_angle, by_curvature = spherical_derivatives(
        positions, angles, curvatures, wavenumber
    )
    derivatives = np.concatenate([by_angle, -(curvatures**2) * by_curvature], axis=-1)
    basis = np.linalg.qr(vectors).Q
    outside = derivatives - basis @ (basis.conj().T @ derivatives)
    product = source_covariance @ (vectors.conj().T @ vectors)
    full = product + noise_power * np.eye(len(product))
    signal = product @ np.linalg.solve(full, source_covariance)
    curvature = outside.conj().T @ outside
    information = (curvature * np.kron(np.ones((2, 2)), signal.T)).real
    return np.asarray(2.0 * snapshots / noise_power * information, dtype=np.float64)


def near_field_bound(information: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the least standard deviations of bearings and ranges.

    Parameters
    ----------
    information : ndarray, shape (2 n_sources, 2 n_sources)
        From :func:`near_field_information`: 1/rad^2, 1/(rad m), 1/m^2.

    Returns
    -------
    angle, range : ndarray, shape (n_sources,)
        rad, m.
    """
    scale = np.sqrt(np.diagonal(information))
    inverse = np.linalg.inv(information / np.outer(scale, scale))
    deviations = np.sqrt(np.diagonal(inverse)) / scale
    angle, distance = np.split(deviations, 2)
    return angle, distance
