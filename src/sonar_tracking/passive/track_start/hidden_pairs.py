"""A second source that is nearer to a track than the array resolves: both are found together.

MUSIC gives a single peak for two sources that are near each other, midway, and a track follows it
and believes in itself. But the covariance has one more eigenvalue than there are tracks. So each
lone track in turn is taken for a pair: the two angles that fit the signal eigenvectors best are
found by Gauss-Newton steps from both sides of the track, all other tracks staying where they are.
A pair is believed if it explains the eigenvectors as well as noise allows: what is left of them,

    2 N / sigma^2 sum_m w_m |P_S e_m|^2,

has 2 (M - n) R degrees of freedom with M elements, n angles and R eigenvectors. Errors of the
array, or noise of another colour than it is taken for, leave more. One source that turns during
the snapshots looks like two as well: these must be farther apart than its turn.

Angles of successive covariances that share no snapshots are joined to two lines. They start as two
tracks, one of them in place of the track between them, once they are apart by several standard
deviations; until then that track is as uncertain as the pair is wide.

References
----------
M. Viberg, B. Ottersten, "Sensor array processing based on subspace fitting", IEEE Trans. Signal
Processing 39(5), 1991.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.geometry import beamwidth, wavenumber
from sonar_tracking.passive.directions.signal_subspace import SignalSubspace, signal_subspace
from sonar_tracking.passive.directions.sources_at_angles import unresolved
from sonar_tracking.passive.directions.weighted_subspace_fit import weighted_subspace_fit
from sonar_tracking.passive.track_start.tentative_track import TentativeTrack
from sonar_tracking.records.arrays import ComplexArray, FloatArray
from sonar_tracking.records.bearings import SubspaceEstimates

_FIRST_SEPARATION = 0.4
"""Of the pair from which the steps begin, over the beamwidth."""

_PRIOR_DEVIATION = 0.5
"""Of each angle about that pair, over the beamwidth: keeps the steps near the track."""

_LARGEST_SEPARATION = 0.8
"""Over the beamwidth: MUSIC resolves more."""

_STEPS = 6

_LEAST_POINTS, _MOST_POINTS = 4, 16

_LEAST_DEVIATIONS = 4.0
"""Separation of the two lines that start, in standard deviations."""

_MISSES_ALLOWED = 3

_DEVIATIONS_OF_FIT = 4.0

_SPREAD_BY_TURN = 1.5
"""Of how far a bearing turns during the snapshots: less apart, a pair may be one that turns, which
looks like two that are 1 / sqrt(3) of it apart."""


@dataclass(frozen=True)
class PairFit:
    """Two angles instead of one track.

    Attributes
    ----------
    row : int
        Of the track.
    angles : ndarray, shape (2,)
        Ascending, rad.
    variances : ndarray, shape (2,)
        rad^2.
    log_likelihood : float
        Of all angles.
    """

    row: int
    angles: FloatArray
    variances: FloatArray
    log_likelihood: float


@dataclass(frozen=True)
class HiddenPair:
    """Pairs that a track was taken for so far.

    Attributes
    ----------
    track_id : int
        Identifier of the track.
    sides : tuple of two TentativeTrack
        The smaller and the larger angle of each pair.
    misses : int
        Covariances without a pair since the last one.
    """

    track_id: int
    sides: tuple[TentativeTrack, TentativeTrack]
    misses: int = 0

    def add(self, stamp: int, fit: PairFit) -> HiddenPair:
        """Return it with one more pair, measured at a stamp in ns."""
        low, high = (
            _newest(side.add(stamp, float(angle), float(variance)))
            for side, angle, variance in zip(self.sides, fit.angles, fit.variances, strict=True)
        )
        return replace(self, sides=(low, high), misses=0)

    def missed(self) -> HiddenPair | None:
        """Return it after a covariance without a pair; None = it is given up."""
        if self.misses >= _MISSES_ALLOWED:
            return None
        return replace(self, misses=self.misses + 1)

    def half_separation(self) -> float:
        """Return half of the mean angle between the two, rad."""
        low, high = (np.mean(side.angles) for side in self.sides)
        return 0.5 * float(high - low)

    def resolved(self, stamp: int) -> bool:
        """Return whether there are two lines that are apart at a stamp in ns."""
        if len(self.sides[0].stamps) < _LEAST_POINTS:
            return False
        (low, low_covariance), (high, high_covariance) = (side.line(stamp) for side in self.sides)
        spread = low_covariance[0, 0] + high_covariance[0, 0]
        return bool(high[0] - low[0] > _LEAST_DEVIATIONS * np.sqrt(spread))


def hidden_pair(
    estimates: SubspaceEstimates,
    covariance: ComplexArray,
    n_sources: int,
    angles: FloatArray,
    rates: FloatArray,
) -> PairFit | None:
    """Return the pair that one of the tracks is best taken for; None = none of them is one.

    Parameters
    ----------
    estimates : SubspaceEstimates
        Of a single run.
    covariance : ndarray, shape (n_elements, n_elements), complex
        Its covariance, linear power.
    n_sources : int
        How many sources there are.
    angles : ndarray, shape (n_tracks,)
        Arrival angles of all tracks in the middle of the covariance, rad.
    rates : ndarray, shape (n_tracks,)
        Their rates, rad/s.
    """
    n_elements = len(estimates.element_positions)
    rank = min(n_sources, estimates.covariance_snapshots - 1)
    if len(angles) + 1 >= n_elements or not 0 < rank < n_elements:
        return None
    subspace = signal_subspace(covariance, rank, estimates.noise_covariance)
    close = unresolved(angles, angles, estimates) & ~np.eye(len(angles), dtype=bool)
    fits = [
        _pair_instead(subspace, estimates, angles, int(n)) for n in np.flatnonzero(~close.any(1))
    ]
    believed = [fit for fit in fits if fit is not None]
    best = max(believed, key=lambda fit: fit.log_likelihood, default=None)
    freedom = 2.0 * (n_elements - len(angles) - 1) * rank
    left = freedom + _DEVIATIONS_OF_FIT * np.sqrt(2.0 * freedom)
    if best is None or -2.0 * best.log_likelihood > left:
        return None
    duration = estimates.covariance_snapshots * estimates.sample_period
    turn = _SPREAD_BY_TURN * abs(float(rates[best.row])) * duration
    return best if best.angles[1] - best.angles[0] > turn else None


def _pair_instead(
    subspace: SignalSubspace, estimates: SubspaceEstimates, angles: FloatArray, row: int
) -> PairFit | None:
    """Return the best pair instead of one track, None if it is none or not near the track."""
    number = wavenumber(estimates.center_frequency, estimates.sound_speed)
    width = beamwidth(estimates.element_positions, number) / max(np.cos(angles[row]), 0.1)
    aside = 0.5 * _FIRST_SEPARATION * width
    first = np.array([angles[row] - aside, angles[row] + aside])
    others, prior = np.delete(angles, row), np.eye(2) / (_PRIOR_DEVIATION * width) ** 2
    pair = first
    for _ in range(_STEPS):
        fit = weighted_subspace_fit(
            subspace,
            estimates.covariance_snapshots,
            estimates.element_positions,
            np.concatenate([pair, others]),
            number,
        )
        information = fit.information[:2, :2] + prior
        pair = pair + np.linalg.solve(information, fit.score[:2] - prior @ (pair - first))
        pair = np.clip(pair, first - width, first + width)
    separation = pair[1] - pair[0]
    if not 0.0 < separation < _LARGEST_SEPARATION * width:
        return None
    variances = np.diagonal(np.linalg.inv(information)).copy()
    return PairFit(row, pair, variances, float(fit.log_likelihood))


def new_pair(track_id: int, next_id: int, stamp: int, fit: PairFit) -> HiddenPair:
    """Return the first pair that a track is taken for.

    Parameters
    ----------
    track_id, next_id : int
        Of the track, and of the other one.
    stamp : int
        Middle of the covariance, ns.
    fit : PairFit
        The pair.
    """
    low, high = (
        TentativeTrack(name, (stamp,), (float(angle),), (float(variance),))
        for name, angle, variance in zip(
            (track_id, next_id), fit.angles, fit.variances, strict=True
        )
    )
    return HiddenPair(track_id, (low, high))


def _newest(side: TentativeTrack) -> TentativeTrack:
    return replace(
        side,
        stamps=side.stamps[-_MOST_POINTS:],
        angles=side.angles[-_MOST_POINTS:],
        variances=side.variances[-_MOST_POINTS:],
    )
