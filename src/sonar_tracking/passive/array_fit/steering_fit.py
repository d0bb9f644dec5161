"""How well the steering vectors of an array fit strong sources: the error of its elements.

Each floor of a null spectrum that the noise does not explain is e^2, the relative variance of the
gain and phase errors (:mod:`sonar_tracking.passive.array_fit.strong_sources`). Its mean over some
twenty covariances is what :mod:`sonar_tracking.passive.sources.steering_error` is to put under the
noise. Echoes that arrive with the source are no error: where more steering vectors explain the
eigenvectors, as many as the smoothed covariance counts, the covariance says nothing.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from sonar_tracking.geometry import beamwidth, is_uniform_line, steering_vectors
from sonar_tracking.passive.array_fit.judged_covariance import JudgedCovariance
from sonar_tracking.passive.array_fit.strong_sources import StrongSources
from sonar_tracking.passive.directions.projection_fit import (
    ProjectionProblem,
    any_fit_below,
    projection_fit,
)
from sonar_tracking.passive.directions.steering_span import steering_span
from sonar_tracking.passive.sources.mdl import (
    forward_backward_smoothed,
    smoothed_size,
    source_count,
)
from sonar_tracking.passive.sources.music import music_bearings
from sonar_tracking.records.arrays import FloatArray

LEAST_ERROR = 0.02
"""Relative rms error that is told and used; less brings no source that is none."""

_MARGIN = 2.0
"""Of the power put under the noise, over the mean of what the errors bring."""

_MEMORY = 20
_SURE = 2
"""Covariances that must show the error."""

_MORE_SOURCES = 2
"""Coherent ones, beside those that the rank shows."""

_EXPLAINED = 0.3
"""Share of the floors that coherent sources may leave."""

_PAIR, _PAIR_STEPS = 0.15, 8
"""Where a pair of sources is sought, of the beamwidth to either side of a valley."""


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

    def update(self, strong: StrongSources, judged: JudgedCovariance) -> SteeringFit:
        """Return the error after one more covariance.

        Parameters
        ----------
        strong : StrongSources
            In the covariance.
        judged : JudgedCovariance
            The covariance.
        """
        over_noise = strong.over_noise
        # Coherent sources first: to tell them takes one fit, and a pair several.
        if over_noise and (_coherent(strong, judged) or _unresolved_pair(strong)):
            return self
        if not strong.resolved:
            alone = over_noise and bool((strong.floors >= strong.shallow).all())
            return replace(self, n_unfit=self.n_unfit + 1 if alone else 0)
        n_elements, n_strong = strong.vectors.shape
        excess = max(strong.floor - strong.noise_floor, 0.0) / n_strong
        squared = excess * n_elements / (n_elements - 1)
        seen = min(self.n_seen + 1, _MEMORY)
        errors = _errors_of_elements(strong)
        before = self.of_elements if len(self.of_elements) == n_elements else errors
        return SteeringFit(
            squared=self.squared + (squared - self.squared) / seen,
            of_elements=before + (errors - before) / seen,
            n_shown=self.n_shown + 1 if over_noise else max(self.n_shown - 1, 0),
            n_seen=seen,
        )


def _errors_of_elements(strong: StrongSources) -> FloatArray:
    """Return the squared residual of each element, over the mean of all, shape (n_elements,)."""
    span = steering_span(steering_vectors(strong.positions, strong.angles, strong.wavenumber))
    residuals = span.outside(strong.vectors)
    squared = (residuals.real**2 + residuals.imag**2).sum(axis=-1)
    return np.asarray(squared / max(float(squared.mean()), float(np.finfo(float).tiny)))


def _unresolved_pair(strong: StrongSources) -> bool:
    """Return whether a pair of sources, nearer than MUSIC resolves, is what is seen.

    It takes the place of a valley, and that of the worst one if its sources are not coherent.
    """
    angles, number = strong.angles, strong.wavenumber
    problem = ProjectionProblem(strong.vectors, strong.positions, number)
    worst = int(np.argmax(strong.floors))
    apart = _PAIR * beamwidth(strong.positions, number)
    step = apart / np.maximum(np.cos(angles), apart)
    pairs = np.stack([angles - step, angles + step], axis=-1)
    coherent, others = list[FloatArray](), list[FloatArray]()
    for each, pair in enumerate(pairs):
        coherent.append(np.concatenate([np.delete(angles, each), pair]))
        if each != worst:
            others.append(np.concatenate([np.delete(angles, [each, worst]), pair]))
    most = _EXPLAINED * strong.floor
    return any(
        any_fit_below(problem, np.stack(starts), most, _PAIR_STEPS)
        for starts in (coherent, others)
        if starts
    )


def _coherent(strong: StrongSources, judged: JudgedCovariance) -> bool:
    """Return whether coherent sources explain what plane waves of the rank do not."""
    positions, n_strong = judged.positions, strong.vectors.shape[-1]
    if judged.covariance is None or not is_uniform_line(positions):
        return False
    count = source_count(judged.covariance, judged.n_snapshots)
    size = smoothed_size(len(positions), judged.n_snapshots)
    if not n_strong < count <= min(n_strong + _MORE_SOURCES, size - 1, len(positions) // 3):
        return False
    smoothed = forward_backward_smoothed(judged.covariance, size)
    angles = music_bearings(smoothed, count, positions[:size], judged.wavenumber)
    problem = ProjectionProblem(strong.vectors, positions, judged.wavenumber)
    angles = projection_fit(problem, angles)
    return bool(problem.error(angles) < _EXPLAINED * strong.floor)
