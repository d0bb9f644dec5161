"""How well the steering vectors of an array fit strong sources: the error of its elements.

Each floor of a null spectrum that the noise does not explain is e^2, the relative variance of the
gain and phase errors (:mod:`sonar_tracking.passive.array_fit.strong_sources`). Its mean over some
twenty covariances is what :mod:`sonar_tracking.passive.sources.steering_error` is to put under the
noise. Echoes that arrive with the source are no error: where more steering vectors explain the
eigenvectors, as many as the smoothed covariance counts, the covariance says nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from sonar_tracking.geometry import steering_vectors
from sonar_tracking.passive.array_fit.alike_cases import alike
from sonar_tracking.passive.array_fit.judged_covariance import JudgedCovariance
from sonar_tracking.passive.array_fit.other_explanations import otherwise_explained
from sonar_tracking.passive.array_fit.strong_sources import StrongSources, stacked_vectors
from sonar_tracking.passive.directions.steering_span import steering_span
from sonar_tracking.records.arrays import FloatArray

LEAST_ERROR = 0.02
"""Relative rms error that is told and used; less brings no source that is none."""

_MARGIN = 2.0
"""Of the power put under the noise, over the mean of what the errors bring."""

_MEMORY = 20
_SURE = 2
"""Covariances that must show the error."""


@dataclass(frozen=True)
class SteeringFit:
    """Running error of the elements.

    Attributes
    ----------
    squared : float
        Mean of e^2, pure number.
    of_elements : ndarray, shape (n_elements,), or empty
        Mean squared error of each element, over the mean of all, pure numbers.
    n_shown : int
        Covariances that have shown an error.
    n_seen : int
        Covariances in the mean.
    n_unfit : int
        Covariances in a row that no plane wave fits at all.
    """

    squared: float = 0.0
    of_elements: FloatArray = field(default_factory=lambda: np.empty(0))
    n_shown: int = 0
    n_seen: int = 0
    n_unfit: int = 0

    @property
    def error(self) -> float:
        """Relative rms error e of the elements, 0 = none that is sure, pure number."""
        known = self.n_shown >= _SURE and self.squared > LEAST_ERROR**2
        return float(np.sqrt(self.squared)) if known else 0.0

    @property
    def error_to_hide(self) -> float:
        """What is put under the noise, pure number: more than the mean, which half the errors pass.

        What an error brings in one direction has an exponential distribution about its mean.
        """
        return float(np.sqrt(_MARGIN)) * self.error

    @property
    def fits(self) -> bool:
        """Whether plane waves fit the array at all."""
        return self.n_unfit < _SURE

    def after(self, strong: StrongSources, errors: FloatArray) -> SteeringFit:
        """Return the error after one more covariance whose floors nothing else explains.

        Parameters
        ----------
        strong : StrongSources
            In the covariance.
        errors : ndarray, shape (n_elements,)
            Squared residual of each element, over the mean of all, pure numbers.
        """
        over_noise = strong.over_noise
        if not strong.resolved:
            alone = over_noise and bool((strong.floors >= strong.shallow).all())
            return replace(self, n_unfit=self.n_unfit + 1 if alone else 0)
        n_elements, n_strong = strong.vectors.shape
        excess = max(strong.floor - strong.noise_floor, 0.0) / n_strong
        squared = excess * n_elements / (n_elements - 1)
        seen = min(self.n_seen + 1, _MEMORY)
        before = self.of_elements if len(self.of_elements) == n_elements else errors
        return SteeringFit(
            squared=self.squared + (squared - self.squared) / seen,
            of_elements=before + (errors - before) / seen,
            n_shown=self.n_shown + 1 if over_noise else max(self.n_shown - 1, 0),
            n_seen=seen,
        )


def updated_steering(
    before: Sequence[tuple[SteeringFit, StrongSources, JudgedCovariance]],
) -> list[SteeringFit]:
    """Return the errors of the elements of several runs after one more covariance of each.

    Parameters
    ----------
    before : sequence of (SteeringFit, StrongSources, JudgedCovariance)
        The errors so far, the strong sources in the covariance, and the covariance.
    """
    doubtful = [run for run, (_, strong, _) in enumerate(before) if strong.over_noise]
    others = otherwise_explained([before[run][1:] for run in doubtful])
    explained = {run for run, other in zip(doubtful, others, strict=True) if other}
    errors = _errors_of_elements([strong for _, strong, _ in before])
    return [
        fit if run in explained else fit.after(strong, errors[run])
        for run, (fit, strong, _) in enumerate(before)
    ]


def _errors_of_elements(found: Sequence[StrongSources]) -> list[FloatArray]:
    """Return the squared residual of each element, over the mean of all, shape (n_elements,)."""
    errors = [np.empty(0)] * len(found)
    for rows in alike({row: each.kind for row, each in enumerate(found)}):
        first = found[rows[0]]
        angles = np.stack([found[row].angles for row in rows])
        span = steering_span(steering_vectors(first.positions, angles, first.wavenumber))
        residuals = span.outside(stacked_vectors([found[row] for row in rows]))
        squared = (residuals.real**2 + residuals.imag**2).sum(axis=-1)
        mean = np.maximum(squared.mean(axis=-1, keepdims=True), np.finfo(float).tiny)
        for row, own in zip(rows, squared / mean, strict=True):
            errors[row] = own
    return errors
