"""The probability of detection of each target, found from how often it is detected.

Nobody knows it: it depends on the target's strength and aspect. For each track a few values are
weighed, given that the target exists. The likelihood ratio of a ping is linear in P_D,

    Lambda(P_D) = 1 + P_D P_G (X - 1),    X = sum_j A_j / omega_j,

so that the existence of a target of unknown P_D follows from its mean, and the weights from
Lambda at each value. New candidates take what the confirmed tracks have shown, and what was told.

References
----------
Musicki, Evans, Stankovic (1994) for Lambda; Bayes' rule for its average over values of P_D.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from sonar_tracking.active.detection.gate_association import PROBABILITY_IN_GATE
from sonar_tracking.errors import Notice, Severity
from sonar_tracking.filtering.few_terms import sum_of_few
from sonar_tracking.records.arrays import BoolArray, FloatArray

LEVELS = np.array([0.1, 0.3, 0.5, 0.7, 0.85, 0.95])
"""Values of P_D that are weighed."""

UNTOLD = np.array([0.05, 0.1, 0.2, 0.25, 0.2, 0.2])
"""Their prior weights where nothing is known."""

TOLD_SHARE = 0.7
"""Of what is told in the prior; the rest stays for the case that it is wrong."""

TOLD_DEVIATION = 0.1
"""Of a value that is told."""

PRIOR_TRACKS = 2.0
"""Confirmed tracks that the prior counts as much as."""

FORGOTTEN_SHARE = 0.01
"""Of the weights of a track, at each ping: aspects change."""

CLEAR_DIFFERENCE, CLEAR_DEVIATIONS = 0.15, 3.0
"""From both on what is found contradicts what is told."""

TYPICAL = float(UNTOLD @ LEVELS)
"""P_D where a method needs one number and nothing is known."""


@lru_cache(maxsize=64)
def prior_weights(told: float) -> FloatArray:
    """Return the weights of the levels before any track is seen; read only, since they are kept.

    Parameters
    ----------
    told : float
        P_D that the detector or the user claims; NaN = nothing is known.

    Returns
    -------
    ndarray, shape (n_levels,)
        Probabilities, sum 1.
    """
    if np.isnan(told):
        return UNTOLD
    near = np.exp(-0.5 * ((LEVELS - told) / TOLD_DEVIATION) ** 2)
    weights = np.asarray(TOLD_SHARE * near / np.sum(near) + (1.0 - TOLD_SHARE) * UNTOLD)
    weights.setflags(write=False)
    return weights


def scene_weights(weights: FloatArray, confirmed: BoolArray, told: float) -> FloatArray:
    """Return what a new target's P_D may be: the prior and the confirmed tracks, averaged.

    Parameters
    ----------
    weights : ndarray, shape (n, n_levels)
        Of all tracks, probabilities.
    confirmed : ndarray of bool, shape (n,)
        Which of them exist.
    told : float
        P_D that is claimed; NaN = nothing is known.

    Returns
    -------
    ndarray, shape (n_levels,)
        Probabilities, sum 1.
    """
    return averaged(prior_weights(told), PRIOR_TRACKS, weights[confirmed])


def averaged(prior: FloatArray, prior_tracks: float, known: FloatArray) -> FloatArray:
    """Return the mean of probabilities of tracks and of a prior that counts as several tracks.

    Parameters
    ----------
    prior : ndarray, shape (n_values,)
        Probabilities, sum 1.
    prior_tracks : float
        Tracks that it counts as much as.
    known : ndarray, shape (n_tracks, n_values)
        Probabilities, sums 1.

    Returns
    -------
    ndarray, shape (n_values,)
        Probabilities, sum 1.
    """
    total = prior_tracks * prior + known.sum(axis=0)
    return np.asarray(total / (prior_tracks + len(known)))


def contradiction(weights: FloatArray, confirmed: BoolArray, told: float) -> tuple[Notice, ...]:
    """Return a notice if the confirmed tracks are detected at another rate than is told.

    Parameters
    ----------
    weights : ndarray, shape (n, n_levels)
        Of all tracks, probabilities.
    confirmed : ndarray of bool, shape (n,)
        Which of them exist.
    told : float
        P_D that is claimed; NaN = nothing is known.
    """
    known = weights[confirmed]
    if np.isnan(told) or len(known) < PRIOR_TRACKS:
        return ()
    mean = mean_probability(known)
    found = float(np.mean(mean))
    if abs(found - told) < CLEAR_DIFFERENCE:
        return ()
    variance = np.sum(np.sum(known * LEVELS**2, axis=1) - mean**2) / len(known) ** 2
    if abs(found - told) < CLEAR_DEVIATIONS * float(np.sqrt(variance)):
        return ()
    text = (
        f"Tracks are detected in {100.0 * found:.0f} % of the pings, not in {100.0 * told:.0f} % "
        "as told; the tracker goes by what it finds. Correct detection_probability, or leave it "
        "out."
    )
    return (Notice(Severity.WARN, "detection_probability", text),)


def forget(weights: FloatArray, scene: FloatArray) -> FloatArray:
    """Return the weights of tracks before a ping, a little nearer to those of the scene.

    Parameters
    ----------
    weights : ndarray, shape (n, n_levels)
        After the ping before, probabilities.
    scene : ndarray, shape (n_levels,)
        Of a new target, probabilities.

    Returns
    -------
    ndarray, shape (n, n_levels)
        Probabilities.
    """
    return np.asarray((1.0 - FORGOTTEN_SHARE) * weights + FORGOTTEN_SHARE * scene)


def mean_probability(weights: FloatArray) -> FloatArray:
    """Return P_D, averaged over its levels.

    Parameters
    ----------
    weights : ndarray, shape (..., n_levels)
        Probabilities of the levels.

    Returns
    -------
    ndarray, shape (...)
        Probabilities.
    """
    return np.asarray(weights @ LEVELS)


def weigh(weights: FloatArray, mean: FloatArray, likelihood_ratio: FloatArray) -> FloatArray:
    """Return the weights after a ping.

    Parameters
    ----------
    weights : ndarray, shape (n, n_levels)
        Before it, probabilities.
    mean : ndarray, shape (n,)
        P_D averaged over them, probabilities.
    likelihood_ratio : ndarray, shape (n,)
        Lambda at the mean P_D, pure numbers.

    Returns
    -------
    ndarray, shape (n, n_levels)
        Probabilities, sums 1.
    """
    slope = (likelihood_ratio - 1.0) / mean
    # Rounding must not turn what is impossible into less than that.
    least = 1.0 - PROBABILITY_IN_GATE
    likelihood = np.maximum(1.0 + LEVELS * slope[:, None], least)
    product = weights * likelihood
    return np.asarray(product / sum_of_few(product, axis=1)[:, None])
