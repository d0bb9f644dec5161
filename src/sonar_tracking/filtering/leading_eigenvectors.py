"""Leading eigenvectors of Hermitian matrices, without computing the others where that is dearer."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from sonar_tracking.records.arrays import ComplexArray, FloatArray

_SMALL = 48
"""Up to this size all eigenvectors cost no more than a few of them."""

_LARGE = 160
"""From this size on a few of them are found sooner by Lanczos steps than by a tridiagonal form."""

_SHARE_OF_LANCZOS = 16
"""The few: at most one in so many."""

_ROUNDING = 1e-13
"""Largest residual of an eigenvector that Lanczos steps have found, over the largest eigenvalue."""


def leading_eigenvectors(matrix: ComplexArray, count: int) -> tuple[FloatArray, ComplexArray]:
    """Return the largest eigenvalues and their eigenvectors.

    Parameters
    ----------
    matrix : ndarray, shape (..., n, n), complex
        Hermitian, in any unit: linear power, pure numbers.
    count : int
        How many, from 1 to n.

    Returns
    -------
    values : ndarray, shape (..., count)
        In the unit of the matrix, descending.
    vectors : ndarray, shape (..., n, count), complex
        Orthonormal columns, pure numbers.

    Raises
    ------
    numpy.linalg.LinAlgError
        If the matrix is not finite.
    """
    size = matrix.shape[-1]
    if size <= _SMALL:
        values, vectors = np.linalg.eigh(matrix)
        return values[..., : -count - 1 : -1], vectors[..., :, : -count - 1 : -1]
    if matrix.ndim > 2:
        each_by_itself = [
            leading_eigenvectors(each, count) for each in matrix.reshape(-1, size, size)
        ]
        values, vectors = (np.array(each) for each in zip(*each_by_itself, strict=True))
        batch = matrix.shape[:-2]
        return values.reshape(*batch, count), vectors.reshape(*batch, size, count)
    if not np.isfinite(matrix).all():
        raise np.linalg.LinAlgError("The matrix holds values that are no finite numbers.")
    if size >= _LARGE and count * _SHARE_OF_LANCZOS <= size:
        found = _by_lanczos_steps(matrix, count)
        if found is not None:
            return found
    return _by_tridiagonal_form(matrix, count)


def leading_left_vectors(columns: ComplexArray, count: int) -> ComplexArray:
    """Return the left singular vectors of the largest singular values: eigenvectors of X X^H.

    Of X X^H and X^H X, which have the same eigenvalues, the smaller one is taken.

    Parameters
    ----------
    columns : ndarray, shape (..., n, n_columns), complex
        X, in any unit.
    count : int
        How many, from 1 to the smaller of n and n_columns.

    Returns
    -------
    ndarray, shape (..., n, count), complex
        Orthonormal columns, largest singular value first; pure numbers.
    """
    n, n_columns = columns.shape[-2:]
    adjoint = np.swapaxes(columns, -1, -2).conj()
    if n <= n_columns:
        return leading_eigenvectors(columns @ adjoint, count)[1]
    values, vectors = leading_eigenvectors(adjoint @ columns, count)
    lengths = np.sqrt(np.maximum(values, np.finfo(float).tiny))
    return np.asarray(columns @ vectors / lengths[..., None, :])


def _by_tridiagonal_form(matrix: ComplexArray, count: int) -> tuple[FloatArray, ComplexArray]:
    """Return eigenvalues and eigenvectors, those wanted only."""
    from scipy.linalg import lapack  # takes longer to load than a node of a small array to start

    size = len(matrix)
    lwork, lrwork, liwork = _work_space(size)
    values, vectors, found, _, failed = lapack.zheevr(
        matrix,
        range="I",
        il=size - count + 1,
        iu=size,
        lower=1,
        lwork=lwork,
        lrwork=lrwork,
        liwork=liwork,
    )
    if failed or found != count:
        raise np.linalg.LinAlgError("The eigenvectors of the matrix were not found.")
    return values[count - 1 :: -1], np.asarray(vectors[:, ::-1], dtype=np.complex128)


@lru_cache(maxsize=16)
def _work_space(size: int) -> tuple[int, int, int]:
    from scipy.linalg import lapack  # likewise

    lwork, lrwork, liwork, _ = lapack.zheevr_lwork(size, lower=1)
    return int(lwork.real), int(lrwork), int(liwork)


def _by_lanczos_steps(matrix: ComplexArray, count: int) -> tuple[FloatArray, ComplexArray] | None:
    """Return eigenvalues and eigenvectors, None if they are not exact to rounding."""
    from scipy.sparse.linalg import ArpackError, eigsh  # likewise

    # A fixed start makes the result a function of the matrix; of noise, so that it leaves no
    # source out.
    start = np.random.default_rng(0).standard_normal((2, len(matrix)))
    try:
        _, found = eigsh(matrix, count, v0=start[0] + 1j * start[1])
    except ArpackError:
        return None
    # What was found need not be at right angles where eigenvalues are close to each other.
    basis = np.linalg.qr(found).Q
    values, turn = np.linalg.eigh(basis.conj().T @ matrix @ basis)
    values, vectors = values[::-1], np.asarray(basis @ turn[:, ::-1], dtype=np.complex128)
    residual = np.abs(matrix @ vectors - vectors * values).max()
    return (values, vectors) if residual <= _ROUNDING * values[0] else None
