"""Power in beams that no tracked source brings, over the noise: where faint sources show.

The steering vectors of the tracked sources, at several angles each, are projected out of the
(whitened) covariance C. With P the projector, sigma^2 the mean power that is left, a the steering
vector of a beam of a uniform line and w its phase between neighbours,

    D = P C P / sigma^2 - P,  d_k = sum_n D_{n+k,n},
    y = sum_{K<|k|<M} d_k exp(-j k w) / (f a^H P a),  f = sum_{K<|k|<M} (M - |k|) / M^2,

y is on average the power that a source in the beam brings over that of the noise, s M with a
signal-to-noise ratio s. Lags up to K are left out: noise with an unknown correlation between near
elements, or of unequal power, has its share there, and only there. f is the share of the power that
stays, and y has the variance of N f snapshots. Where the lags left out show that the noise is
stronger than on average, y is divided by its power there, by which it varies.

References
----------
G. Zhang, C. Zheng, S. Sun, G. Liang, Y. Zhang, "Joint detection and DOA tracking with a Bernoulli
filter based on information theoretic criteria", Sensors 18(10), 3473, 2018, for the Gaussian
likelihood of the snapshots in place of detections.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from sonar_tracking.geometry import (
    beamwidth,
    is_uniform_line,
    steering_vectors,
    wavenumber,
)
from sonar_tracking.passive.directions.signal_subspace import noise_factor
from sonar_tracking.records.arrays import BoolArray, ComplexArray, FloatArray
from sonar_tracking.records.bearings import SubspaceEstimates

MOST_LAGS = 4
"""Largest lag that noise of an unknown colour may have a share in."""

_POINTS_PER_BEAM = 6
"""Beams over the width between a peak and its first zero."""

_FEWEST_ELEMENTS = 6
_RESOLVED = 0.7
"""Of the power of a steering vector, that the projection must leave."""

_LEAST_NOISE_SHARE = 1e-9
"""Of the power: below it there is no noise to compare with."""

_MOST_PROJECTED = 0.6
"""Of the elements, that there may be angles to project out: beams are to be left."""


@dataclass(frozen=True)
class BeamGrid:
    """Beams of a uniform line, even in the sine of the angle.

    Attributes
    ----------
    angles : ndarray, shape (n_beams,)
        rad, ascending.
    transform : ndarray, shape (2 n_elements, n_beams)
        From the real and the imaginary parts of d_k to power, pure numbers.
    high : ndarray, shape (2 n_elements,)
        1 for the lags that are used, 0 for the others, pure numbers.
    share : float
        f, pure number.
    width : float
        Of a beam: between the sines of its peak and its first zero.
    """

    angles: FloatArray
    transform: FloatArray
    high: FloatArray
    share: float
    width: float


@dataclass(frozen=True)
class BeamExcess:
    """What beams hold beside the tracked sources.

    Attributes
    ----------
    excess : ndarray, shape (n_beams,)
        y, power over that of the noise, pure numbers.
    free : ndarray of bool, shape (n_beams,)
        Beams that the array tells from the tracked sources.
    snapshots : float
        N f, independent snapshots behind each.
    received : float
        Power of all sources at an element, over that of the noise.
    whitened : bool
        Whether the noise was whitened, with a covariance that may not be quite its own.
    """

    excess: FloatArray
    free: BoolArray
    snapshots: float
    received: float
    whitened: bool


def beam_grid(positions: FloatArray, number: float) -> BeamGrid | None:
    """Return the beams of an array, None if it is no uniform line or too short.

    Parameters
    ----------
    positions : ndarray, shape (n_elements, 3)
        Element positions, m.
    number : float
        Wavenumber, rad/m.
    """
    if len(positions) < _FEWEST_ELEMENTS or not is_uniform_line(positions):
        return None
    return _kept_grid(np.ascontiguousarray(positions).tobytes(), number)


@lru_cache(maxsize=6)
def _kept_grid(position_bytes: bytes, number: float) -> BeamGrid:
    positions = np.frombuffer(position_bytes).reshape(-1, 3)
    n_elements = len(positions)
    width = beamwidth(positions, number)
    n_beams = int(np.ceil(2.0 * _POINTS_PER_BEAM / width))
    sines = (2.0 * np.arange(n_beams) + 1.0) / n_beams - 1.0
    angles = np.arcsin(sines)
    # First element as the reference: the steering vector holds the phases of all lags.
    lags = steering_vectors(positions, angles, number)
    lags[1:] *= 2.0
    order = np.arange(n_elements)
    used = order > min(MOST_LAGS, n_elements // 4)
    share = 2.0 * float((n_elements - order)[used].sum()) / n_elements**2
    return BeamGrid(
        angles,
        np.concatenate([lags.real, lags.imag]),
        np.concatenate([used, used]).astype(float),
        share,
        width,
    )


def beam_excess(
    estimates: SubspaceEstimates,
    covariance: ComplexArray,
    n_snapshots: int,
    tracked_angles: FloatArray,
) -> BeamExcess | None:
    """Return what the beams hold beside the tracked sources, None if nothing can be told.

    Parameters
    ----------
    estimates : SubspaceEstimates
        Array, frequency and noise.
    covariance : ndarray, shape (n_elements, n_elements), complex
        Sample covariance, linear power.
    n_snapshots : int
        Snapshots in it.
    tracked_angles : ndarray, shape (n_tracks,)
        Where the tracked sources are during it; several to a source that moves, rad.
    """
    positions, n_elements = estimates.element_positions, len(covariance)
    number = wavenumber(estimates.center_frequency, estimates.sound_speed)
    grid = beam_grid(positions, number)
    if grid is None or len(tracked_angles) > _MOST_PROJECTED * n_elements:
        return None
    inverse: ComplexArray | None = None
    white = covariance
    if estimates.noise_covariance is not None:
        inverse = np.asarray(
            np.linalg.inv(noise_factor(estimates.noise_covariance)), dtype=np.complex128
        )
        white = inverse @ covariance @ inverse.conj().T
    spanned = _spanned(positions, tracked_angles, number, inverse)
    product = white @ spanned
    half = product - 0.5 * spanned @ (spanned.conj().T @ product)
    outer = spanned @ half.conj().T
    left = white - outer - outer.conj().T
    noise = float(np.trace(left).real) / (n_elements - spanned.shape[1])
    total = float(np.trace(white).real) / n_elements
    if not (np.isfinite(noise) and noise > _LEAST_NOISE_SHARE * total):
        return None
    projector = np.eye(n_elements) - spanned @ spanned.conj().T
    left = left / noise - projector
    if inverse is not None:
        left, projector = (inverse.conj().T @ each @ inverse for each in (left, projector))
    excess, free = _powers(left, projector, grid)
    received = max(total / noise - 1.0, 0.0)
    return BeamExcess(excess, free, n_snapshots * grid.share, received, inverse is not None)


def _powers(
    left: ComplexArray, projector: ComplexArray, grid: BeamGrid
) -> tuple[FloatArray, BoolArray]:
    """Return y and which beams are free of the tracked sources, both of shape (n_beams,)."""
    sums = np.stack([_diagonal_sums(left), _diagonal_sums(projector)])
    lags, whole = np.concatenate([sums.real, sums.imag], axis=-1)
    powers = np.stack([lags * grid.high, lags * (1.0 - grid.high), whole]) @ grid.transform
    most = float(powers[2].max())
    free = powers[2] > _RESOLVED * most
    own = np.where(free, powers[2], most)
    local = np.maximum(1.0 + powers[1] / own, 1.0)
    return np.where(free, powers[0] / (grid.share * own * local), 0.0), free


def _spanned(
    positions: FloatArray, angles: FloatArray, number: float, whitening: ComplexArray | None
) -> ComplexArray:
    """Return orthonormal columns that span the steering vectors, (n_elements, n_angles)."""
    columns = steering_vectors(positions, angles, number)
    if whitening is not None:
        columns = whitening @ columns
    return np.asarray(np.linalg.qr(columns).Q, dtype=np.complex128)


def _diagonal_sums(matrix: ComplexArray) -> ComplexArray:
    """Return the sums of the diagonals from the main one down, shape (n_elements,)."""
    n_elements = len(matrix)
    padded = np.zeros((n_elements, 2 * n_elements), dtype=np.complex128)
    padded[:, :n_elements] = matrix.T
    # Each row begins one column further: the diagonals become columns.
    sheared = np.append(padded, np.zeros(n_elements)).reshape(n_elements, 2 * n_elements + 1)
    return np.asarray(sheared[:, :n_elements].sum(axis=0), dtype=np.complex128)
