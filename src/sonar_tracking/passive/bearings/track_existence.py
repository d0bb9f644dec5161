"""Probability that a bearing track has a source, from the block covariance.

A source at the angle of a track brings power into the part a of its steering vector that is
orthogonal to those of all other tracks, so that neither neighbours nor coherent copies count for
it. With r the power along a over the noise power, N snapshots and e the expected excess, the log
likelihood ratio of "source" against "noise only" is

    l = N (r e / (1 + e) - ln(1 + e)),  e = max(r - 1, e_least),

e_least being what N snapshots can tell from noise. A source that is there may be silent for a
while, in an interval dt with probability f = exp(-dt / silence_time); the odds of existence are
multiplied by f + (1 - f) exp(l). The probability stays between a floor and a ceiling, so that it
never gets stuck. Tracks that the array does not resolve keep theirs: a crossing ends no track.

References
----------
D. Musicki, R. Evans, S. Stankovic, "Integrated probabilistic data association", IEEE Trans. AC
39(6), 1994, for the existence as part of the track.
"""

from __future__ import annotations

from dataclasses import dataclass

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


@dataclass(frozen=True)
class Evidence:
    """What one covariance says of the existence of each track.

    Attributes
    ----------
    log_ratio : ndarray, shape (..., n_tracks)
        Log likelihood ratio of a source against noise only; NaN = the covariance cannot tell.
    """

    log_ratio: FloatArray

    @property
    def unseen(self) -> BoolArray:
        """Tracks without a source in this covariance, shape (..., n_tracks)."""
        return np.asarray(self.log_ratio < 0.0)

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
        silent = np.exp(-interval / silence_time)
        ratio = silent + (1.0 - silent) * np.exp(np.minimum(self.log_ratio, 20.0))
        odds = probability / (1.0 - probability) * np.where(np.isnan(ratio), 1.0, ratio)
        return np.clip(odds / (1.0 + odds), FLOOR, CEILING)


def no_evidence(shape: tuple[int, ...]) -> Evidence:
    """Return the evidence of an estimate that tells nothing of tracks, (..., n_tracks)."""
    return Evidence(np.full(shape, np.nan))


def existence_evidence(
    estimates: SubspaceEstimates, angles: FloatArray, rates: FloatArray, interval: float
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
    """
    if estimates.covariance_snapshots == 0:
        return no_evidence(angles.shape)
    middle = angles + rates * estimates.covariance_time_offset
    duration = estimates.covariance_snapshots * estimates.sample_period
    snapshots = estimates.covariance_snapshots * min(1.0, interval / duration)
    ratio = power_ratios(estimates, middle)
    excess = np.maximum(ratio - 1.0, _LEAST_EXCESS / np.sqrt(estimates.covariance_snapshots))
    log_ratio = snapshots * (ratio * excess / (1.0 + excess) - np.log1p(excess))
    close = unresolved(middle, middle, estimates) & ~np.eye(angles.shape[-1], dtype=bool)
    return Evidence(np.where(close.any(axis=-1), np.nan, log_ratio))
