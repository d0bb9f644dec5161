"""What sample covariances say of a model of the noise: score, information, length of description.

With C_v = L L^H of some parameters c, the eigenpairs (lambda_m, e_m) of L^-1 C L^-H, the first R of
which belong to sources, and sigma^2 the mean of the others,

    D = L^-H E_n (Lambda_n / sigma^2 - I) E_n^H L^-1,  Q = L^-H E_n E_n^H L^-1,
    score_k = N tr(D B_k),  information_kl = N [tr(Q B_k Q B_l) - tr(Q B_k) tr(Q B_l) / (M - R)],

B_k the derivatives of C_v: the likelihood of the part that holds no source, whose power is unknown.
R is the number that gives the shortest description by MDL.

References
----------
M. Wax, T. Kailath (1985) for the description; P. Stoica, A. Nehorai (1990) for the likelihood.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.filtering.eigenpairs import Eigenpairs
from sonar_tracking.filtering.eigenpairs import eigenpairs as all_eigenpairs
from sonar_tracking.passive.array_fit.noise_models import NoiseModel
from sonar_tracking.passive.sources.angle_grid import adjoint
from sonar_tracking.passive.sources.mdl import signal_counts
from sonar_tracking.records.arrays import ComplexArray, FloatArray, IntArray

_LEAST_SHARE = 1e-9
"""Least eigenvalue over the largest one: below it there is no noise to judge."""

LARGEST_STEP = 0.5
"""Of a parameter, by one covariance."""


@dataclass(frozen=True)
class NoiseEvidence:
    """What each of several covariances says of the parameters of a noise model.

    Attributes
    ----------
    ranks : ndarray of int, shape (n,)
        R, eigenvectors that belong to sources.
    score : ndarray, shape (n, n_parameters)
        Derivative of the log-likelihood, pure numbers.
    information : ndarray, shape (n, n_parameters, n_parameters)
        Of the parameters, pure numbers.
    description : ndarray, shape (n,)
        Length of the description of the snapshots in nats, pure numbers.
    """

    ranks: IntArray
    score: FloatArray
    information: FloatArray
    description: FloatArray

    def of(self, rows: int | IntArray) -> NoiseEvidence:
        """Return what some of the covariances say.

        Parameters
        ----------
        rows : int or ndarray of int, shape (n_chosen,)
            Which of them; of a single one all arrays are without the first dimension.
        """
        return NoiseEvidence(
            self.ranks[rows], self.score[rows], self.information[rows], self.description[rows]
        )

    def improved(self, model: NoiseModel, parameters: FloatArray) -> FloatArray:
        """Return parameters that suit each of the covariances better.

        Parameters
        ----------
        model : NoiseModel
            Of the noise.
        parameters : ndarray, shape (n, n_parameters)
            Those the evidence was computed at, pure numbers.

        Returns
        -------
        ndarray, shape (n, n_parameters)
            Pure numbers.
        """
        change = solved(self.information, self.score)
        return model.bounded(parameters + np.clip(change, -LARGEST_STEP, LARGEST_STEP))


def noise_evidence(
    covariances: ComplexArray,
    n_snapshots: int,
    model: NoiseModel,
    parameters: FloatArray,
    most_sources: int | IntArray | None = None,
    eigenpairs: Eigenpairs | None = None,
) -> NoiseEvidence:
    """Return what covariances say of the parameters.

    Parameters
    ----------
    covariances : ndarray, shape (n, n_elements, n_elements), complex
        Sample covariances, linear power.
    n_snapshots : int
        N, snapshots in each.
    model : NoiseModel
        Of the same elements.
    parameters : ndarray, shape (n_parameters,) or (n, n_parameters)
        c of all or of each, pure numbers; zero = white noise.
    most_sources : int or ndarray of int, shape (n,), optional
        R is not more than this; if not given, what MDL says.
    eigenpairs : Eigenpairs, optional
        Of the covariances, if they are known already and the noise is white.
    """
    n_elements = covariances.shape[-1]
    derivatives = model.derivatives(parameters)
    whitening = np.eye(n_elements, dtype=np.complex128)
    length = np.zeros(len(covariances))
    if parameters.any():
        factor = np.linalg.cholesky(model.covariance(parameters))
        whitening = np.asarray(np.linalg.inv(factor), dtype=np.complex128)
        covariances = whitening @ covariances @ adjoint(whitening)
        diagonal = np.diagonal(factor, axis1=-2, axis2=-1).real
        length = length + 2.0 * n_snapshots * np.log(diagonal).sum(axis=-1)
    pairs = eigenpairs or all_eigenpairs(covariances)
    usable = pairs.values[:, -1] > _LEAST_SHARE * pairs.values[:, 0]
    least = _LEAST_SHARE * pairs.values[:, :1] + np.finfo(float).tiny
    values = np.maximum(pairs.values, least)
    ranks = np.minimum(signal_counts(values, n_snapshots), n_elements - 2) * usable
    if most_sources is not None:
        ranks = np.minimum(ranks, most_sources)
    noise = np.arange(n_elements) >= ranks[:, None]
    n_noise = n_elements - ranks
    power = (values * noise).sum(axis=-1) / n_noise
    excess = np.where(noise, values / power[:, None] - 1.0, 0.0)
    across = adjoint(whitening) @ pairs.vectors
    beyond = (across * excess[:, None, :]) @ adjoint(across)
    within = (across * noise[:, None, :]) @ adjoint(across)
    slopes, means, squares = _traces(beyond, within, derivatives)
    removed = means[:, :, None] * means[:, None, :] / n_noise[:, None, None]
    logs = np.where(noise, np.log(power)[:, None], np.log(values)).sum(axis=-1)
    penalty = 0.5 * ranks * (2 * n_elements - ranks) * np.log(n_snapshots)
    return NoiseEvidence(
        ranks=ranks,
        score=n_snapshots * slopes * usable[:, None],
        information=n_snapshots * (squares - removed) * usable[:, None, None],
        description=length + n_snapshots * logs + penalty,
    )


def _traces(
    beyond: ComplexArray, within: ComplexArray, derivatives: ComplexArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return tr(D B_k), tr(Q B_k) and tr(Q B_k Q B_l) of D and Q, (n, n_elements, n_elements).

    One covariance at a time, so that each has the same bits however many are judged together.
    """
    n, n_parameters = len(beyond), derivatives.shape[-3]
    flat = np.swapaxes(derivatives, -1, -2).reshape(*derivatives.shape[:-2], -1)
    columns = np.swapaxes(flat, -1, -2)
    slopes = (beyond.reshape(n, 1, -1) @ columns)[:, 0].real
    means = (within.reshape(n, 1, -1) @ columns)[:, 0].real
    products = within[:, None] @ derivatives
    transposed = np.swapaxes(products, -1, -2).reshape(n, n_parameters, -1)
    squares = products.reshape(n, n_parameters, -1) @ np.swapaxes(transposed, -1, -2)
    return slopes, means, squares.real


def solved(information: FloatArray, score: FloatArray) -> FloatArray:
    """Return information^-1 score, held back where little is known.

    Parameters
    ----------
    information : ndarray, shape (..., n_parameters, n_parameters)
        Pure numbers.
    score : ndarray, shape (..., n_parameters)
        Pure numbers.

    Returns
    -------
    ndarray, shape (..., n_parameters)
        Pure numbers.
    """
    size = information.shape[-1]
    trace = np.trace(information, axis1=-2, axis2=-1)[..., None, None]
    damping = 1e-3 * trace / size + np.finfo(float).tiny
    damped = information + damping * np.eye(size)
    return np.asarray(np.linalg.solve(damped, score[..., None])[..., 0])
