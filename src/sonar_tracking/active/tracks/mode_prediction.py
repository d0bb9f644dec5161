"""Motion modes of many tracks mixed, and moved over an interval: compiled, or in numpy.

Mixed: m_j = sum_i w_ji m_i, S_j = sum_i w_ji (S_i + (m_i - m_j)(m_i - m_j)^T). Moved: F m and
F S F^T with

    F = [I B; 0 D],    S = [A P; P^T V],    X = P + B V,
    F S F^T = [A + X B^T + B P^T, X D^T; D X^T, D V D^T].

``compiled_modes`` is there if a compiler was when the package was installed. All sums are taken in
the same order in both, and in no library of linear algebra: the bits are the same everywhere.

References
----------
Y. Bar-Shalom, X. R. Li, T. Kirubarajan, *Estimation with Applications to Tracking and Navigation*,
2001, section 11.6.6 (interacting models).
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.compiled_modules import compiled_module
from sonar_tracking.records.arrays import FloatArray

COMPILED = compiled_module("active.tracks.compiled_modes")
"""The compiled functions, None where there are none."""


def mixed_states(
    weight: FloatArray, mean: FloatArray, covariance: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the modes of tracks mixed.

    Parameters
    ----------
    weight : ndarray, shape (n, n_modes, n_modes)
        Of the mode that is mixed into (row) and the one before (column), probabilities.
    mean : ndarray, shape (n, n_modes, 4)
        x, y, vx, vy, m and m/s.
    covariance : ndarray, shape (n, n_modes, 4, 4)
        m^2, m^2/s, m^2/s^2.

    Returns
    -------
    mean : ndarray, shape (n, n_modes, 4)
        m and m/s.
    covariance : ndarray, shape (n, n_modes, 4, 4)
        m^2, m^2/s, m^2/s^2.
    """
    if COMPILED is None:
        return _mixed_in_numpy(weight, mean, covariance)
    given = (weight, mean, covariance)
    result = np.empty(mean.shape), np.empty(covariance.shape)
    COMPILED.mix(*map(np.ascontiguousarray, given), *result, mean.shape[:2])
    return result


def _mixed_in_numpy(
    weight: FloatArray, mean: FloatArray, covariance: FloatArray
) -> tuple[FloatArray, FloatArray]:
    n_modes = mean.shape[1]
    mixed = weight[:, :, 0, None] * mean[:, None, 0]
    for mode in range(1, n_modes):
        mixed += weight[:, :, mode, None] * mean[:, None, mode]
    total = np.zeros((0,))
    for mode in range(n_modes):
        away = mean[:, None, mode] - mixed
        term = away[..., :, None] * away[..., None, :]
        term += covariance[:, None, mode]
        term *= weight[:, :, mode, None, None]
        total = total + term if mode else term
    return mixed, total


def moved_states(
    matrices: FloatArray, mean: FloatArray, covariance: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return states and covariances after an interval without noise.

    Parameters
    ----------
    matrices : ndarray, shape (n, n_modes, 4, 4), (n_modes, 4, 4) or (1, 4, 4)
        F: places stay but for what velocities add; pure numbers, s and 1/s.
    mean : ndarray, shape (n, n_modes, 4)
        x, y, vx, vy, m and m/s.
    covariance : ndarray, shape (n, n_modes, 4, 4)
        Symmetric, m^2, m^2/s, m^2/s^2.

    Returns
    -------
    mean : ndarray, shape (n, n_modes, 4)
        m and m/s.
    covariance : ndarray, shape (n, n_modes, 4, 4)
        Symmetric, m^2, m^2/s, m^2/s^2.
    """
    if COMPILED is None:
        return _moved_in_numpy(matrices, mean, covariance)
    given = (matrices, mean, covariance)
    result = np.empty(mean.shape), np.empty(covariance.shape)
    shape = (mean.size // 4, matrices.size // 16)
    COMPILED.move(*map(np.ascontiguousarray, given), *result, shape)
    return result


def _moved_in_numpy(
    matrices: FloatArray, mean: FloatArray, covariance: FloatArray
) -> tuple[FloatArray, FloatArray]:
    b, d = _entries(matrices[..., :2, 2:]), _entries(matrices[..., 2:, 2:])
    a, p = _entries(covariance[..., :2, :2]), _entries(covariance[..., :2, 2:])
    v = _entries(covariance[..., 2:, 2:])
    v[1, 0] = v[0, 1]
    bv, bp, dv = _product(b, v), _product(b, _transposed(p)), _product(d, v)
    x = {entry: p[entry] + bv[entry] for entry in p}
    xb, xd = _product(x, _transposed(b)), _product(x, _transposed(d))
    dvd = _product(dv, _transposed(d))
    moved = np.empty(covariance.shape)
    for row, column in ((0, 0), (0, 1), (1, 1)):
        entry = row, column
        moved[..., row, column] = a[entry] + (xb[entry] + bp[entry])
        moved[..., 2 + row, 2 + column] = dvd[entry]
    for row, column in p:
        moved[..., row, 2 + column] = moved[..., 2 + column, row] = xd[row, column]
    moved[..., 1, 0], moved[..., 3, 2] = moved[..., 0, 1], moved[..., 2, 3]
    u, w = mean[..., 2], mean[..., 3]
    result = np.empty(mean.shape)
    for row in (0, 1):
        result[..., row] = mean[..., row] + (b[row, 0] * u + b[row, 1] * w)
        result[..., 2 + row] = d[row, 0] * u + d[row, 1] * w
    return result, moved


_Block = dict[tuple[int, int], FloatArray]
"""Entries of matrices of two rows and columns, each of all matrices."""


def _entries(matrices: FloatArray) -> _Block:
    return {(i, j): np.ascontiguousarray(matrices[..., i, j]) for i in (0, 1) for j in (0, 1)}


def _transposed(block: _Block) -> _Block:
    return {(j, i): entry for (i, j), entry in block.items()}


def _product(left: _Block, right: _Block) -> _Block:
    return {(i, j): left[i, 0] * right[0, j] + left[i, 1] * right[1, j] for i, j in left}
