"""Probability that a bearing track has a source, from the block covariance.

A source at the angle of a track brings power into the part a of its steering vector that is
orthogonal to those of all other tracks, so that neither neighbours nor coherent copies count for
it. With r the power along a over the noise power, N snapshots and e the expected excess, the log
likelihood ratio of "source" against "noise only" is

    l = N (r e / (1 + e) - ln(1 + e)),  e = max(r - 1, e_least),

e_least being what N snapshots can tell from noise. A source that is there may be silent for a
while, in an interval dt with probability f = exp(-dt / silence_time); the odds of existence are
multiplied by f + (1 - f) exp(l). The probability stays between a floor and a ceiling, so that it
never gets stuck. A source that started as a faint one is expected to be as strong as it has been on
average, and not as one covariance can tell. Tracks that the array does not resolve keep theirs: a
crossing ends no track.

References
----------
D. Musicki, R. Evans, S. Stankovic, "Integrated probabilistic data association", IEEE Trans. AC
39(6), 1994, for the existence as part of the track.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from sonar_tracking.passive.directions.sources_at_angles import power_ratios, unresolved
from sonar_tracking.records.arrays import BoolArray, FloatArray
from sonar_tracking.records.bearings import SubspaceEstimates

FLOOR, CEILING = 0.01, 0.99
"""Bounds of the published probability."""

STARTED = 0.97
"""Probability of a track at its start, after four joined bearings."""

ENDED = 0.1
"""A track whose probability falls below this ends."""

_LEAST_EXCESS = 5.0
"""Excess power that counts, in standard deviations 1 / sqrt(N) of the noise power."""

_FAINTEST, _NOT_FAINT = 2.0, 25.0
"""Mean excess power of a faint source, in those standard deviations: it is taken for no less than
the first, by which its absence shows, and beyond the second it is as all others are."""

_FAINT_HASTE = 2.0
"""By which the time is shortened that a faint source may be silent: one covariance says so little
of it that the allowance would hide its absence."""

_LEARNT = 0.1
"""Weight of one covariance in that mean."""


@dataclass(frozen=True)
class Evidence:
    """What one covariance says of the existence of each track.

    Attributes
    ----------
    log_ratio : ndarray, shape (..., n_tracks)
        Log likelihood ratio of a source against noise only; NaN = the covariance cannot tell.
    excess : ndarray, shape (..., n_tracks)
        Power expected of each faint source after the covariance, over that of the noise,
        pure numbers; NaN = not faint.
    held : ndarray of bool, shape (..., n_tracks)
        Faint sources that are believed although this covariance does not show them.
    """

    log_ratio: FloatArray
    excess: FloatArray = field(default_factory=lambda: np.array(np.nan))
    held: BoolArray = field(default_factory=lambda: np.array(False))

    @property
    def unseen(self) -> BoolArray:
        """Tracks without a source in this covariance, shape (..., n_tracks)."""
        return np.asarray((self.log_ratio < 0.0) & ~self.held)

    @property
    def faint(self) -> BoolArray:
        """Tracks whose sources are faint, shape (..., n_tracks)."""
        return np.isfinite(self.excess)

    def n_shown(self, snapshots: int) -> int:
        """Return how many faint sources a covariance of so many snapshots may show by itself."""
        least = _LEAST_EXCESS / np.sqrt(max(snapshots, 1))
        return int(np.count_nonzero(self.faint & (self.excess >= least)))

    def holding(self, probability: FloatArray) -> Evidence:
        """Return it with the faint sources held that are more likely there than not.

        Parameters
        ----------
        probability : ndarray, shape (..., n_tracks)
            Of existence, after the covariance, pure numbers.
        """
        if not self.faint.any():
            return self
        return replace(self, held=np.asarray(self.faint & (probability >= 0.5)))

    def update(self, probability: FloatArray, interval: float, silence_time: float) -> FloatArray:
        """Return the probabilities of existence after the covariance.

        Parameters
        ----------
        probability : ndarray, shape (..., n_tracks)
            Before, pure numbers.
        interval : float
            Since the last covariance, s.
        silence_time : float
            How long a source may be silent, s.

        Returns
        -------
        ndarray, shape (..., n_tracks)
            Probabilities between ``FLOOR`` and ``CEILING``; as before where it cannot tell.
        """
        haste = np.where(self.faint, _FAINT_HASTE, 1.0)
        silent = np.exp(-haste * interval / silence_time)
        ratio = silent + (1.0 - silent) * np.exp(np.minimum(self.log_ratio, 20.0))
        odds = probability / (1.0 - probability) * np.where(np.isnan(ratio), 1.0, ratio)
        return np.clip(odds / (1.0 + odds), FLOOR, CEILING)


def no_evidence(shape: tuple[int, ...]) -> Evidence:
    """Return the evidence of an estimate that tells nothing of tracks, (..., n_tracks)."""
    return Evidence(np.full(shape, np.nan), np.full(shape, np.nan), np.zeros(shape, dtype=bool))


def faint_excess(estimates: SubspaceEstimates, mean: FloatArray) -> FloatArray:
    """Return the power of each source that is a faint one by this covariance.

    Parameters
    ----------
    estimates : SubspaceEstimates
        Of a single run, with covariance and noise power.
    mean : ndarray, shape (n_tracks, 2)
        Angle and rate of each at the stamp, rad and rad/s.

    Returns
    -------
    ndarray, shape (n_tracks,)
        Over that of the noise, pure numbers; NaN = not faint, or near another one.
    """
    middle = mean[:, 0] + estimates.covariance_time_offset * mean[:, 1]
    deviation = 1.0 / np.sqrt(max(estimates.covariance_snapshots, 1))
    excess = np.maximum(power_ratios(estimates, middle) - 1.0, _FAINTEST * deviation)
    close = unresolved(middle, middle, estimates).sum(axis=-1) > 1
    return np.where(close | (excess > _NOT_FAINT * deviation), np.nan, excess)


def existence_evidence(
    estimates: SubspaceEstimates,
    angles: FloatArray,
    rates: FloatArray,
    interval: float,
    faint_excess: FloatArray | None = None,
) -> Evidence:
    """Return what an estimate says of the existence of the tracks.

    Parameters
    ----------
    estimates : SubspaceEstimates
        With covariance and noise power.
    angles, rates : ndarray, shape (..., n_tracks)
        At the stamp, rad and rad/s.
    interval : float
        Since the estimate before, s: snapshots that it had too do not count again.
    faint_excess : ndarray, shape (..., n_tracks), optional
        Expected power of faint sources over that of the noise, pure numbers; NaN = not faint.
    """
    nothing = no_evidence(angles.shape)
    expected = nothing.excess if faint_excess is None else faint_excess
    if estimates.covariance_snapshots == 0:
        return replace(nothing, excess=expected)
    middle = angles + rates * estimates.covariance_time_offset
    duration = estimates.covariance_snapshots * estimates.sample_period
    snapshots = estimates.covariance_snapshots * min(1.0, interval / duration)
    ratio = power_ratios(estimates, middle)
    deviation = 1.0 / np.sqrt(estimates.covariance_snapshots)
    faint = np.isfinite(expected)
    excess = np.maximum(ratio - 1.0, np.where(faint, expected, _LEAST_EXCESS * deviation))
    log_ratio = snapshots * (ratio * excess / (1.0 + excess) - np.log1p(excess))
    close = unresolved(middle, middle, estimates) & ~np.eye(angles.shape[-1], dtype=bool)
    log_ratio = np.where(close.any(axis=-1), np.nan, log_ratio)
    if faint.any():
        share = _LEARNT * snapshots / estimates.covariance_snapshots
        learnt = expected + np.where(np.isnan(log_ratio), 0.0, share * (ratio - 1.0 - expected))
        learnt = np.maximum(learnt, _FAINTEST * deviation)
        expected = np.where(learnt > _NOT_FAINT * deviation, np.nan, learnt)
    return Evidence(log_ratio, expected, nothing.held)
