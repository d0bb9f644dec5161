"""Measurement of sources so faint that the eigenvectors of a covariance do not show them.

The signal eigenvectors are those of the strong sources; a weak one has none of its own, or one that
is mostly noise. But with its power known from before, each covariance tells something of its
bearing. With b its steering vector orthogonal to those of all other sources and their slopes, c its
slope orthogonal to them and to b, e = s |b|^2 its power over that of the noise and N snapshots,
the score of the Gaussian likelihood and the information are

    g = 2 N e / (1 + e) Re(c^H C b) / (|b|^2 sigma^2),  J = 2 N e^2 / (1 + e) |c|^2 / |b|^2,

as of a split beam. Where there are more eigenvectors than strong sources, and what they hold is
not in the beam of a faint one, a source that has no track yet would pull it away: then the faint
sources are not measured.

References
----------
H. L. Van Trees, "Optimum array processing", Wiley, 2002, section 8.4, for the likelihood.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from sonar_tracking.geometry import steering_pair, wavenumber
from sonar_tracking.passive.directions.signal_subspace import (
    SignalSubspace,
    noise_factor,
    whitened_covariance,
)
from sonar_tracking.passive.directions.weighted_subspace_fit import SubspaceFit
from sonar_tracking.records.arrays import BoolArray, ComplexArray, FloatArray
from sonar_tracking.records.bearings import SubspaceEstimates

_OWN_SHARE = 0.5
"""Of the power of an eigenvector, that must be in the beam of a faint source."""

Fit = Callable[[FloatArray], SubspaceFit]


def fit_with_faint(
    fit: Fit | None,
    subspace: SignalSubspace | None,
    estimates: SubspaceEstimates,
    covariance: ComplexArray,
    excess: FloatArray,
) -> Fit:
    """Return the fit of all sources, of which some are faint.

    Parameters
    ----------
    fit : callable or None
        Score and information of the angles of strong sources; None = no eigenvector is theirs.
    subspace : SignalSubspace or None
        What it rests on.
    estimates : SubspaceEstimates
        Array, frequency and noise.
    covariance : ndarray, shape (..., n_elements, n_elements), complex
        Theirs, linear power.
    excess : ndarray, shape (..., n)
        Power of each faint source in its beam, over that of the noise, pure numbers; NaN = not
        faint, in the same places in all runs.
    """
    faint = np.isfinite(excess).reshape(-1, excess.shape[-1])[0]
    strong = np.flatnonzero(~faint)
    beyond = np.zeros(excess.shape[:-1])
    if subspace is not None and subspace.eigenvalues.shape[-1] > len(strong):
        beyond = subspace.eigenvalues[..., len(strong)] / subspace.noise_power - 1.0
    if estimates.noise_covariance is not None:
        covariance = whitened_covariance(covariance, noise_factor(estimates.noise_covariance))
    return partial(
        _fit_of_all, fit if len(strong) else None, estimates, covariance, excess, faint, beyond
    )


def _fit_of_all(
    fit: Fit | None,
    estimates: SubspaceEstimates,
    covariance: ComplexArray,
    excess: FloatArray,
    faint: BoolArray,
    beyond: FloatArray,
    angles: FloatArray,
) -> SubspaceFit:
    n_targets, strong = angles.shape[-1], np.flatnonzero(~faint)
    likelihood, score = np.zeros(angles.shape[:-1]), np.zeros(angles.shape)
    information = np.zeros((*angles.shape, n_targets))
    if fit is not None:
        part = fit(angles[..., strong])
        likelihood = part.log_likelihood
        score[..., strong] = part.score
        information[..., strong[:, None], strong] = part.information
    vectors = _vectors(estimates, angles)
    noise = estimates.noise_power
    for row in np.flatnonzero(faint):
        score[..., row], information[..., row, row] = _beam_score(
            vectors, covariance, noise, excess[..., row], beyond, int(row)
        )
    factor = float(estimates.covariance_snapshots)
    score[..., faint] *= factor
    information[..., faint, :] *= factor
    return SubspaceFit(likelihood, score, information)


def _vectors(estimates: SubspaceEstimates, angles: FloatArray) -> tuple[ComplexArray, ComplexArray]:
    """Return whitened steering vectors and slopes, both (..., n_elements, n)."""
    number = wavenumber(estimates.center_frequency, estimates.sound_speed)
    pair = steering_pair(estimates.element_positions, angles, number, "array_centre")
    if estimates.noise_covariance is None:
        return pair
    factor = noise_factor(estimates.noise_covariance)
    vectors, slopes = (np.linalg.solve(factor, each) for each in pair)
    return np.asarray(vectors, np.complex128), np.asarray(slopes, np.complex128)


def _beam_score(
    vectors: tuple[ComplexArray, ComplexArray],
    covariance: ComplexArray,
    noise: FloatArray,
    excess: FloatArray,
    beyond: FloatArray,
    row: int,
) -> tuple[FloatArray, FloatArray]:
    """Return score and information of one faint source per snapshot, both of shape (...)."""
    steering, slopes = vectors
    own, slope = steering[..., row], slopes[..., row]
    whole = (own.real**2 + own.imag**2).sum(axis=-1)
    if steering.shape[-1] > 1:
        others = np.concatenate(
            [np.delete(steering, row, axis=-1), np.delete(slopes, row, axis=-1)], axis=-1
        )
        lengths = np.sqrt((others.real**2 + others.imag**2).sum(axis=-2, keepdims=True))
        spanned = np.linalg.qr(others / np.maximum(lengths, np.finfo(float).tiny)).Q
        own, slope = _outside(spanned, own), _outside(spanned, slope)
    power = (own.real**2 + own.imag**2).sum(axis=-1)
    direction = own / np.sqrt(np.maximum(power, np.finfo(float).tiny))[..., None]
    slope = slope - direction * (direction.conj() * slope).sum(axis=-1)[..., None]
    seen = (covariance @ own[..., None])[..., 0]
    in_beam = (own.conj() * seen).sum(axis=-1).real
    product = (slope.conj() * seen).sum(axis=-1).real
    least = 1e-6 * whole
    usable = (power > least) & (noise > 0.0)
    scale = np.where(usable, power * noise, 1.0)
    usable &= in_beam / scale - 1.0 >= _OWN_SHARE * beyond
    own_excess = excess * power / whole
    gain = 2.0 * own_excess / (1.0 + own_excess)
    score = gain * product / scale
    squared = (slope.real**2 + slope.imag**2).sum(axis=-1)
    information = gain * own_excess * squared / np.maximum(power, least)
    return np.where(usable, score, 0.0), np.where(usable, information, 0.0)


def _outside(spanned: ComplexArray, vector: ComplexArray) -> ComplexArray:
    inside = np.swapaxes(spanned, -1, -2).conj() @ vector[..., None]
    return np.asarray(vector - (spanned @ inside)[..., 0], dtype=np.complex128)
