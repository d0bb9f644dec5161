"""Track before detect: a Bernoulli filter for one faint source that no covariance shows by itself.

Whether there is one source more than there are tracks, and where, how fast and how strong it is,
is a single Bernoulli random set. Its density is kept on a grid of bearings (even in the sine),
rates and powers y = s M in a beam, and held as odds: their sum is the odds of existence. Between
covariances the grid moves with its rates, spreads a little, loses the sources that disappear and
gains those that appear anywhere. A covariance multiplies the odds by the likelihood ratio of
"source with y" against "none" of the power 1 + e in each beam
(:mod:`sonar_tracking.passive.directions.beam_excess`) of n independent snapshots,

    l = n (r y / (1 + y) - ln(1 + y)),  r = (1 + e) / (1 + g).

No detection is made and nothing is thresholded before the odds are. g is what may leak from the
tracked sources into the beams: as long as it explains the power, nothing is believed. An update
counts for ``_MOST_TOLD`` nats at most, so that a noise that lasts no longer starts nothing; sources
that tell more are found by the ordinary start.

References
----------
B. Ristic, B.-T. Vo, B.-N. Vo, A. Farina, "A tutorial on Bernoulli filters: theory, implementation
and applications", IEEE Trans. Signal Processing 61(13), 2013, section III; G. Zhang, C. Zheng, S.
Sun, G. Liang, Y. Zhang, "Joint detection and DOA tracking with a Bernoulli filter based on
information theoretic criteria", Sensors 18(10), 3473, 2018, and Bosser et al., arXiv 2412.15727,
2024, for bearings from the likelihood of the snapshots.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np

from sonar_tracking.passive.directions.beam_excess import BeamExcess, BeamGrid
from sonar_tracking.records.arrays import FloatArray, IndexArray

N_RATES = 7

_FASTEST = float(np.deg2rad(0.6))
_TIME_IN_BEAM = 8.0
"""rad/s; s: a faint source that turns faster does not stay in a beam for long enough."""

EXCESSES = 0.15 * 2.0 ** np.arange(6)
"""y, pure numbers: with 15 elements -20 to -5 dB at each."""

STARTING_ODDS = 1e3
"""At which a source is believed: with the rate of births below one false track in ten hours of
covariances half a second apart."""

_BIRTH = 1e-3
_DEATH = 1e-3
"""Probabilities per update that a source appears and disappears."""

_SPREAD_ANGLE, _SPREAD_RATE, _SPREAD_EXCESS = 0.05, 0.02, 0.05
"""Of the odds of a cell, to each of its neighbours per update."""

_MOST_TOLD = 12.0
"""Nats that one update counts for at most."""

_LEAKAGE = 0.015
"""Of the power received, that may come in a beam beside its bearing by errors that do not show."""

_WORST = 5.0
"""Of what errors that show bring, in the worst beam over the mean."""

_LEAST_FLOOR = 0.03
"""Of g: what noise of another colour leaves in the larger lags."""

_WHITENED_FLOOR = 0.15
"""Of g in noise that was whitened: what a covariance that was found in the data leaves."""

_MOST_RECEIVED = 0.5
"""Power of the tracked sources at an element over that of the noise, beside which faint ones are
sought: the echoes of louder ones are as strong as they are."""

_LARGEST_DEVIATION = 0.35
"""Of the bearing, over the width of a beam, when it is sure enough to start."""

_ENDFIRE = 0.97
"""Sine beyond which a bearing is not sought: beams are wide there."""

_MOST_ODDS = 1e12


@dataclass(frozen=True)
class FaintSource:
    """A source that is believed.

    Attributes
    ----------
    mean : ndarray, shape (2,)
        Angle and rate in the middle of the covariance, rad and rad/s.
    covariance : ndarray, shape (2, 2)
        rad^2, rad^2/s, rad^2/s^2.
    excess : float
        y, its power in a beam over that of the noise, pure number.
    """

    mean: FloatArray
    covariance: FloatArray
    excess: float


@dataclass(frozen=True)
class TrackBeforeDetect:
    """The filter between two covariances.

    Attributes
    ----------
    odds : ndarray, shape (n_rates, n_beams, n_excesses), or empty
        Of existence in each cell, pure numbers.
    angles : ndarray, shape (n_beams,), or empty
        Of the beams, rad.
    rates : ndarray, shape (n_rates,), or empty
        rad/s.
    """

    odds: FloatArray = field(default_factory=lambda: np.empty((0, 0, 0)))
    angles: FloatArray = field(default_factory=lambda: np.empty(0))
    rates: FloatArray = field(default_factory=lambda: np.empty(0))

    @property
    def total(self) -> float:
        """Odds that there is a source."""
        return float(self.odds.sum())

    def predict(self, interval: float) -> TrackBeforeDetect:
        """Return the filter after an interval in s, without what appears in it."""
        if not self.odds.size:
            return self
        before, weight = _moves(self.angles.tobytes(), self.rates.tobytes(), interval)
        rows = np.arange(len(self.rates))[:, None]
        padded = np.pad(self.odds, ((0, 0), (1, 1), (0, 0)))
        moved = padded[rows, before] * (1.0 - weight) + padded[rows, before + 1] * weight
        for axis, share in enumerate((_SPREAD_RATE, _SPREAD_ANGLE, _SPREAD_EXCESS)):
            moved = _spread(moved, axis, share)
        return replace(self, odds=moved)

    def update(
        self, beams: BeamExcess, grid: BeamGrid, steering_error: float = 0.0
    ) -> TrackBeforeDetect:
        """Return the filter after a covariance, predicted to its middle.

        Parameters
        ----------
        beams : BeamExcess
            Of the covariance.
        grid : BeamGrid
            The beams.
        steering_error : float
            Relative rms error of the elements that is known, pure number.
        """
        odds, rates, angles = self.odds, self.rates, grid.angles
        if not np.array_equal(angles, self.angles):
            fastest = min(_FASTEST, grid.width / _TIME_IN_BEAM)
            rates = np.linspace(-fastest, fastest, N_RATES)
            odds = np.zeros((N_RATES, len(angles), len(EXCESSES)))
        odds = (odds * (1.0 - _DEATH) + _BIRTH / odds.size) / (1.0 + _DEATH * odds.sum())
        floor = _WHITENED_FLOOR if beams.whitened else _LEAST_FLOOR
        floor += (_LEAKAGE + _WORST * steering_error**2) * beams.received
        ratio = np.maximum(1.0 + beams.excess, 0.0) / (1.0 + floor)
        told = beams.snapshots * (
            ratio[:, None] * (EXCESSES / (1.0 + EXCESSES)) - np.log1p(EXCESSES)
        )
        told *= min(1.0, _MOST_TOLD / max(float(told.max()), _MOST_TOLD))
        sought = beams.free & (np.abs(np.sin(angles)) < _ENDFIRE)
        sought &= beams.received <= _MOST_RECEIVED
        odds = odds * np.exp(told) * sought[:, None]
        odds = odds * min(1.0, _MOST_ODDS / max(odds.sum(), 1.0))
        return TrackBeforeDetect(odds, angles, rates)

    def believed(self, width: float) -> FaintSource | None:
        """Return the source if the odds are high enough and its bearing is sure enough.

        Parameters
        ----------
        width : float
            Of a beam, between the sines of its peak and its first zero.
        """
        if self.total < STARTING_ODDS:
            return None
        share = self.odds / self.total
        grid = share.sum(axis=-1)
        angle, rate = float(grid.sum(axis=0) @ self.angles), float(grid.sum(axis=1) @ self.rates)
        turned = self.angles - angle, self.rates - rate
        slope = float(np.cos(angle))
        cell = (2.0 / len(self.angles) / slope) ** 2 / 12.0
        variance = float(grid.sum(axis=0) @ turned[0] ** 2) + cell
        if variance > (_LARGEST_DEVIATION * width / slope) ** 2:
            return None
        spread = (
            float(grid.sum(axis=1) @ turned[1] ** 2) + (self.rates[1] - self.rates[0]) ** 2 / 12.0
        )
        both = float(turned[1] @ grid @ turned[0])
        return FaintSource(
            np.array([angle, rate]),
            np.array([[variance, both], [both, spread]]),
            float(share.sum(axis=(0, 1)) @ EXCESSES),
        )


@lru_cache(maxsize=16)
def _moves(angle_bytes: bytes, rate_bytes: bytes, interval: float) -> tuple[IndexArray, FloatArray]:
    """Return from which beams the odds of each rate and beam come.

    Returns
    -------
    before : ndarray of int, shape (n_rates, n_beams)
        The lower of two beams, in a grid with an empty beam more at both ends.
    weight : ndarray, shape (n_rates, n_beams, 1)
        Of the upper one, pure numbers.
    """
    angles, rates = np.frombuffer(angle_bytes), np.frombuffer(rate_bytes)
    n_beams = len(angles)
    came_from = angles - rates[:, None] * interval
    place = (np.sin(came_from) + 1.0) * n_beams / 2.0 + 0.5
    place = np.where(np.abs(came_from) < 0.5 * np.pi, place, 0.0)
    before = np.clip(np.floor(place), 0, n_beams).astype(np.intp)
    return before, np.clip(place - before, 0.0, 1.0)[..., None]


def _spread(odds: FloatArray, axis: int, share: float) -> FloatArray:
    """Return the odds after each cell has given a share to both of its neighbours."""
    lower = [slice(None)] * odds.ndim
    upper = list(lower)
    lower[axis], upper[axis] = slice(None, -1), slice(1, None)
    flow = share * np.diff(odds, axis=axis)
    spread = odds.copy()
    spread[tuple(lower)] += flow
    spread[tuple(upper)] -= flow
    return spread
