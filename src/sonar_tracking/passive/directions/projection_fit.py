"""Arrival angles of sources of any coherence: a damped Gauss-Newton fit of the steering vectors.

The vectors b_m = C_v e_m (:mod:`sonar_tracking.passive.directions.signal_subspace`) lie in the span
of the steering vectors S at the true angles, whatever the coherence of the sources. The angles
minimise the projection error sum_m ||P_S b_m||^2, starting from the predictions of the tracks:

    y_m = S^+ b_m,  r_m = P_S b_m,  C_m = [y_1m P_S L(theta_1), ..., y_Qm P_S L(theta_Q)],
    A = Re sum_m C_m^H C_m,  a = Re sum_m C_m^H r_m,  theta <- theta + alpha A^-1 a,

with alpha halved until the error drops. The term of dP_S/dtheta with S^+H is left out of C_m
(Kaufman), which leaves the gradient -2 a exact. Steps are few and capped: to converge fully swaps
targets at crossings.

References
----------
Hwang, Kim, Kim, Park, Nam (2005), eqs. 14-21.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.geometry import steering_pair, steering_vectors
from sonar_tracking.passive.directions.steering_span import steering_span
from sonar_tracking.records.arrays import BoolArray, ComplexArray, FloatArray

STEPS = 3
LARGEST_STEP = float(np.deg2rad(0.5))

_HALVINGS = 8
_DAMPING = 1e-12
"""Share of the mean curvature added to the diagonal: equal predictions stay solvable."""


@dataclass(frozen=True)
class ProjectionProblem:
    """Fit of steering vectors to vectors in their span.

    Attributes
    ----------
    combinations : ndarray, shape (..., n_elements, rank), complex
        b_m = C_v e_m with e_m^H C_v e_m = 1, pure numbers.
    positions : ndarray, shape (n_elements, 3)
        Element positions, m.
    wavenumber : float
        rad/m.
    """

    combinations: ComplexArray
    positions: FloatArray
    wavenumber: float

    def error(self, angles: FloatArray) -> FloatArray:
        """Return what of the combinations the steering vectors do not explain, sum_m ||P_S b_m||^2.

        Parameters
        ----------
        angles : ndarray, shape (..., n_targets)
            rad.

        Returns
        -------
        ndarray, shape (...)
            Pure numbers.
        """
        vectors = steering_vectors(self.positions, angles, self.wavenumber)
        residuals = steering_span(vectors).outside(self.combinations)
        return np.asarray((residuals.real**2 + residuals.imag**2).sum(axis=(-2, -1)))

    def curvature_and_slope(self, angles: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the Gauss-Newton matrix A and the downhill slope a; the gradient is -2 a.

        Parameters
        ----------
        angles : ndarray, shape (..., n_targets)
            rad.

        Returns
        -------
        curvature : ndarray, shape (..., n_targets, n_targets)
            1/rad^2.
        slope : ndarray, shape (..., n_targets)
            1/rad.
        """
        vectors, derivatives = steering_pair(self.positions, angles, self.wavenumber)
        span = steering_span(vectors)
        amplitudes = span.inverse @ self.combinations
        residuals = span.outside(self.combinations)
        outside = span.outside(derivatives)
        adjoint = np.swapaxes(outside, -1, -2).conj()
        powers = amplitudes.conj() @ np.swapaxes(amplitudes, -1, -2)
        curvature = ((adjoint @ outside) * powers).real
        slope = (amplitudes.conj() * (adjoint @ residuals)).real.sum(axis=-1)
        return curvature, slope

    def step(self, angles: FloatArray) -> FloatArray:
        """Return the full Gauss-Newton step A^-1 a at angles of shape (..., n_targets), rad."""
        curvature, slope = self.curvature_and_slope(angles)
        n_targets = angles.shape[-1]
        mean = np.trace(curvature, axis1=-2, axis2=-1)[..., None, None] / n_targets
        damping = _DAMPING * mean + np.finfo(float).tiny
        damped = curvature + damping * np.eye(n_targets)
        return np.asarray(np.linalg.solve(damped, slope[..., None])[..., 0])


def projection_fit(
    problem: ProjectionProblem,
    angles: FloatArray,
    steps: int = STEPS,
    largest_step: float = LARGEST_STEP,
) -> FloatArray:
    """Return the angles after some Gauss-Newton steps.

    Parameters
    ----------
    problem : ProjectionProblem
        What is fitted.
    angles : ndarray, shape (..., n_targets)
        Predictions, rad.
    steps : int
        Gauss-Newton steps at most; each is taken only if the error drops within eight halvings.
    largest_step : float
        Largest change of an angle in one step, rad; the whole step is scaled down to it.

    Returns
    -------
    ndarray, shape (..., n_targets)
        rad.

    References
    ----------
    Hwang, Kim, Kim, Park, Nam (2005), eqs. 18-21.
    """
    error = problem.error(angles)
    for _ in range(steps):
        angles, lower = _descent(
            problem, angles, error, _capped_step(problem, angles, largest_step)
        )
        if not (lower < error).any():
            break
        error = lower
    return angles


def fits_below(
    problem: ProjectionProblem, starts: FloatArray, largest_errors: FloatArray, steps: int = STEPS
) -> BoolArray:
    """Return whether one of several fits to each of some sets of combinations leaves little.

    The first fit that leaves less than the largest error ends the search in that set.

    Parameters
    ----------
    problem : ProjectionProblem
        What is fitted, combinations of shape (n_sets, n_elements, rank).
    starts : ndarray, shape (n_sets, n_starts, n_targets)
        Where the fits begin, rad.
    largest_errors : ndarray, shape (n_sets,)
        As :meth:`ProjectionProblem.error`, pure numbers.
    steps : int
        As of :func:`projection_fit`.

    Returns
    -------
    ndarray of bool, shape (n_sets,)
        One a set.
    """
    n_sets, n_starts, n_targets = starts.shape
    found = np.zeros(n_sets, dtype=bool)
    owner, angles = np.repeat(np.arange(n_sets), n_starts), starts.reshape(-1, n_targets)
    own = replace(problem, combinations=problem.combinations[owner])
    error = own.error(angles)
    for _ in range(steps):
        found[owner[error < largest_errors[owner]]] = True
        going = ~found[owner]
        if not going.any():
            return found
        owner, angles, error = owner[going], angles[going], error[going]
        own = replace(problem, combinations=problem.combinations[owner])
        trial, lower = _descent(own, angles, error, _capped_step(own, angles, LARGEST_STEP))
        # A fit that does not descend has come to its end.
        moved = lower < error
        owner, angles, error = owner[moved], trial[moved], lower[moved]
    found[owner[error < largest_errors[owner]]] = True
    return found


def _capped_step(problem: ProjectionProblem, angles: FloatArray, largest_step: float) -> FloatArray:
    """Return the Gauss-Newton step, scaled down so that no angle changes more than that, rad."""
    step = problem.step(angles)
    largest = np.abs(step).max(axis=-1, keepdims=True)
    return step * np.minimum(1.0, largest_step / np.maximum(largest, largest_step))


def _descent(
    problem: ProjectionProblem, angles: FloatArray, error: FloatArray, step: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Halve the step until the error drops strictly; keep the angles where it never does."""
    found, lowest = angles, error
    searching = np.ones(error.shape, dtype=bool)
    for halving in range(_HALVINGS + 1):
        trial = angles + 0.5**halving * step
        trial_error = problem.error(trial)
        better = searching & (trial_error < error)
        found = np.where(better[..., None], trial, found)
        lowest = np.where(better, trial_error, lowest)
        searching &= ~better
        if not searching.any():
            break
    return found, lowest
