"""Signal eigenvectors of a block covariance: any coherence of the sources, any noise colour.

With C = S C_f S^H + sigma^2 C_v the generalised eigenvectors C e = lambda C_v e of the R largest
eigenvalues, R the rank of the source covariance C_f, give C_v e_m in the span of the steering
vectors S, whether the sources are coherent or not (Hwang et al. 2005, eq. 9). With C_v = L L^H they
are the ordinary eigenvectors v of L^-1 C L^-H: e = L^-H v, C_v e = L v, e^H C_v e = 1. The ordinary
eigenvectors of C itself do not have this property in coloured noise.

References
----------
Hwang, Kim, Kim, Park, Nam (2005), eqs. 3-9.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from sonar_tracking.errors import InputError
from sonar_tracking.filtering.eigenpairs import Eigenpairs
from sonar_tracking.filtering.eigenpairs import eigenpairs as all_eigenpairs
from sonar_tracking.filtering.leading_eigenvectors import leading_eigenvectors
from sonar_tracking.records.arrays import ComplexArray, FloatArray
from sonar_tracking.records.bearings import SubspaceEstimates

_LEAST_NOISE_SHARE = 1e-12
"""Least noise power as a share of the mean eigenvalue: data without noise stay finite."""

_HERMITIAN_TOLERANCE = 1e-9

_WHOLLY_KNOWN = 64
"""Elements up to which estimates of the same process bring all eigenvectors in white noise: those
that come in messages, without, are to give the same bits."""

_TINY = float(np.finfo(float).tiny)


@dataclass(frozen=True)
class SignalSubspace:
    """Signal part of a block covariance.

    Attributes
    ----------
    vectors : ndarray, shape (..., n_elements, rank), complex
        Orthonormal eigenvectors v of the whitened covariance, largest eigenvalue first;
        pure numbers.
    eigenvalues : ndarray, shape (..., rank)
        lambda, linear power, descending.
    noise_power : ndarray, shape (...)
        sigma^2, linear power, mean of the other eigenvalues.
    factor : ndarray, shape (..., n_elements, n_elements), complex, or None
        Cholesky factor L of the noise covariance, of all runs or of each, pure numbers; None =
        white.
    """

    vectors: ComplexArray
    eigenvalues: FloatArray
    noise_power: FloatArray
    factor: ComplexArray | None

    def whitened(self, columns: ComplexArray) -> ComplexArray:
        """Return L^-1 times some columns.

        Parameters
        ----------
        columns : ndarray, shape (..., n_elements, n), complex
            In any unit.

        Returns
        -------
        ndarray, shape (..., n_elements, n), complex
            In units of the columns.
        """
        if self.factor is None:
            return columns
        return np.asarray(np.linalg.solve(self.factor, columns), dtype=np.complex128)

    def steering_combinations(self) -> ComplexArray:
        """Return C_v e_m = L v_m, combinations of steering vectors.

        Returns
        -------
        ndarray, shape (..., n_elements, rank), complex
            Pure numbers.
        """
        return self.vectors if self.factor is None else self.factor @ self.vectors


def signal_subspace(
    covariance: ComplexArray,
    rank: int,
    noise_covariance: ComplexArray | None = None,
    eigenpairs: Eigenpairs | None = None,
) -> SignalSubspace:
    """Return the signal eigenvectors of a block covariance.

    Parameters
    ----------
    covariance : ndarray, shape (..., n_elements, n_elements), complex
        C, Hermitian, linear power.
    rank : int
        R, rank of the source covariance, at least 1 and below n_elements.
    noise_covariance : ndarray, shape (..., n_elements, n_elements), complex, optional
        C_v with trace n_elements, of all runs or of each; None = white. Pure numbers.
    eigenpairs : Eigenpairs, optional
        Of C, if they are known already and the noise is white.

    Returns
    -------
    SignalSubspace
        Of the whitened covariance.

    Raises
    ------
    InputError
        If the rank does not fit the array or the noise covariance is not positive definite.

    References
    ----------
    Hwang, Kim, Kim, Park, Nam (2005), eqs. 3-9.
    """
    n_elements = covariance.shape[-1]
    if not 0 < rank < n_elements:
        raise InputError(
            f"The rank is {rank} but the array has {n_elements} elements; it must be between 1 "
            f"and {n_elements - 1}."
        )
    factor = None if noise_covariance is None else noise_factor(noise_covariance)
    white = covariance if factor is None else whitened_covariance(covariance, factor)
    if factor is None and n_elements <= _WHOLLY_KNOWN:
        pairs = eigenpairs or all_eigenpairs(covariance)
        values, vectors = pairs.values[..., :rank], pairs.vectors[..., :rank]
    else:
        values, vectors = leading_eigenvectors(white, rank)
    mean = np.trace(white, axis1=-2, axis2=-1).real / n_elements
    # The mean of the other eigenvalues, which need not be known singly.
    others = (n_elements * mean - values.sum(axis=-1)) / (n_elements - rank)
    least = np.maximum(_LEAST_NOISE_SHARE * mean, _TINY)
    return SignalSubspace(
        vectors=vectors,
        eigenvalues=values,
        noise_power=np.maximum(others, least),
        factor=factor,
    )


def signal_subspace_of(estimates: SubspaceEstimates, rank: int) -> SignalSubspace:
    """Return the signal eigenvectors of the covariance of an estimate.

    Parameters
    ----------
    estimates : SubspaceEstimates
        With a covariance; of one run or of several.
    rank : int
        R, rank of the source covariance, at least 1 and below n_elements.

    Raises
    ------
    InputError
        If there is no covariance, and as :func:`signal_subspace`.
    """
    if estimates.covariance is None:
        raise InputError("The estimate has no covariance; set covariance_snapshots above zero.")
    pairs = None
    if estimates.eigenvectors is not None:
        pairs = Eigenpairs(estimates.eigenvalues, estimates.eigenvectors)
    return signal_subspace(estimates.covariance, rank, estimates.noise_covariance, pairs)


def whitened_covariance(covariance: ComplexArray, factor: ComplexArray) -> ComplexArray:
    """Return L^-1 C L^-H.

    Parameters
    ----------
    covariance : ndarray, shape (..., n_elements, n_elements), complex
        C, Hermitian, linear power.
    factor : ndarray, shape (..., n_elements, n_elements), complex
        Cholesky factor L of the noise covariance, of all or of each, pure numbers.

    Returns
    -------
    ndarray, shape (..., n_elements, n_elements), complex
        Linear power.
    """
    half = np.linalg.solve(factor, covariance)
    adjoint = np.swapaxes(half, -1, -2).conj()
    return np.asarray(np.linalg.solve(factor, adjoint), dtype=np.complex128)


def noise_factor(noise_covariance: ComplexArray) -> ComplexArray:
    """Return the lower Cholesky factor of a noise covariance, or of several.

    Parameters
    ----------
    noise_covariance : ndarray, shape (..., n_elements, n_elements), complex
        C_v with trace n_elements, pure numbers.

    Returns
    -------
    ndarray, shape (..., n_elements, n_elements), complex
        L, pure numbers; C_v = L L^H.

    Raises
    ------
    InputError
        If it is not Hermitian or not positive definite.
    """
    matrix = np.ascontiguousarray(noise_covariance, dtype=np.complex128)
    return _kept_factor(matrix.tobytes(), matrix.shape)


@lru_cache(maxsize=8)
def _kept_factor(covariance_bytes: bytes, shape: tuple[int, ...]) -> ComplexArray:
    """Return the factor of covariances by their bytes: many steps of an estimate ask for it."""
    covariance = np.frombuffer(covariance_bytes, np.complex128).reshape(shape)
    skew = np.abs(covariance - np.swapaxes(covariance, -1, -2).conj()).max()
    if not skew <= _HERMITIAN_TOLERANCE * np.abs(covariance).max():
        raise InputError(
            "The noise covariance is not Hermitian; give one that equals its conjugate transpose."
        )
    try:
        factor = np.asarray(np.linalg.cholesky(covariance), dtype=np.complex128)
    except np.linalg.LinAlgError:
        raise InputError(
            "The noise covariance is not positive definite; measure it with more snapshots than "
            "elements."
        ) from None
    factor.setflags(write=False)
    return factor
