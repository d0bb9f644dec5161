"""The model of the noise fitted to covariances by Fisher scoring, c <- c + I^-1 g, from starts.

The likelihood has more than one maximum, as a broad peak may be noise or sources. So the fit starts
from white noise with as many sources as MDL sees there, and with few of them; of its results the
one is taken that gives the shortest description. The starts of all covariances go on side by side.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.passive.array_fit.noise_evidence import NoiseEvidence, noise_evidence
from sonar_tracking.passive.array_fit.noise_models import NoiseModel
from sonar_tracking.records.arrays import ComplexArray, FloatArray, IntArray

_STEPS = 8
_LEAST_GAIN_OF_A_STEP = 0.01
"""Nats that a step is expected to gain; the fits are told apart by tens."""

_ALL = 1 << 30
_STARTS = (_ALL, 0, 2)
"""Of the starts of the fit: as many as MDL sees, or few of them for half of the steps."""


@dataclass(frozen=True)
class NoiseFits:
    """The model fitted to each of several covariances.

    Attributes
    ----------
    parameters : ndarray, shape (n, n_parameters)
        Pure numbers.
    evidence : NoiseEvidence
        Of each covariance at its parameters.
    gains : ndarray, shape (n,)
        By how much they shorten the description beside white noise, nats, pure numbers.
    """

    parameters: FloatArray
    evidence: NoiseEvidence
    gains: FloatArray


def noise_fits(covariances: ComplexArray, n_snapshots: int, model: NoiseModel) -> NoiseFits:
    """Return the parameters that describe each of several covariances most briefly.

    A start goes on only as long as a step is expected to raise the likelihood.

    Parameters
    ----------
    covariances : ndarray, shape (n, n_elements, n_elements), complex
        Sample covariances, linear power.
    n_snapshots : int
        Snapshots in each.
    model : NoiseModel
        Of the same elements.
    """
    white = noise_evidence(covariances, n_snapshots, model, np.zeros(model.n_parameters))
    n, n_starts = len(covariances), len(_STARTS)
    started = np.repeat(covariances, n_starts, axis=0)
    parameters = _from_starts(started, n_snapshots, model, np.tile(_STARTS, n))
    evidence = noise_evidence(started, n_snapshots, model, parameters)
    shortest = evidence.description.reshape(n, n_starts).argmin(axis=-1)
    best = evidence.of(rows := n_starts * np.arange(n) + shortest)
    return NoiseFits(parameters[rows], best, white.description - best.description)


def _from_starts(
    covariances: ComplexArray, n_snapshots: int, model: NoiseModel, most_sources: IntArray
) -> FloatArray:
    """Return where the scoring of each covariance ends that begins with so many sources at most."""
    parameters = np.zeros((len(covariances), model.n_parameters))
    left = np.where(most_sources == _ALL, _STEPS, _STEPS // 2)
    going = np.arange(len(covariances))
    while len(going):
        before, most = parameters[going], most_sources[going]
        evidence = noise_evidence(covariances[going], n_snapshots, model, before, most)
        parameters[going] = after = evidence.improved(model, before)
        gain = 0.5 * (evidence.score * (after - before)).sum(axis=-1)
        left[going] -= 1
        over = (gain < _LEAST_GAIN_OF_A_STEP) | (left[going] == 0)
        # Where few sources were let in, all that MDL sees follow.
        begun = going[over & (most != _ALL)]
        most_sources[begun], left[begun] = _ALL, _STEPS // 2
        going = going[~over | (most != _ALL)]
    return parameters
