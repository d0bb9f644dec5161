"""The colour of the noise that nobody has told: found by a test, followed with slow forgetting.

While the noise is taken to be white, the scores of its model at white noise are summed with slow
forgetting; in white noise z = g^T V^-1 g is chi-square distributed, V the sum of the informations
with the squares of the weights. When z is beyond any chance, the model is fitted to the covariance
at hand by Fisher scoring from several starts, and is taken only if it describes the snapshots, its
sources with them, much more briefly than white noise and its sources do. From then on each
covariance takes one scoring step, c <- c + I^-1 g with the information I summed with forgetting,
until nothing of the colour is left.

A source is a far narrower peak than the model can follow, so that the two do not take each other's
place: eigenvectors that MDL gives to sources are left out of score and information.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from sonar_tracking.passive.array_fit.judged_covariance import JudgedCovariance
from sonar_tracking.passive.array_fit.noise_evidence import (
    LARGEST_STEP,
    NoiseEvidence,
    noise_evidence,
    solved,
)
from sonar_tracking.passive.array_fit.noise_models import NoiseModel
from sonar_tracking.records.arrays import ComplexArray, FloatArray

FORGETTING = 0.95
"""Weight of what was known before, per covariance that shares no snapshots."""

SIGNIFICANT = 80.0
"""Of z, 8 on average in white noise with eight parameters: one chance in 10^13."""

LEAST_GAIN = 30.0
"""Nats by which coloured noise must shorten the description of one covariance."""

LEAST_CORRELATION = 0.2
"""Between any two elements: less brings no false track, and what strong sources leave in the noise
when they move during a covariance is not more."""

_GAIN_PER_PAIR, _MOST_GAIN = 0.68, 160.0
"""The same when the colour is first found, in the mean of some covariances: five sources of -8 dB
that 15 elements do not resolve bring 150."""

_WHITE_AGAIN = 30.0
_FIT_STEPS = 8
_LEAST_GAIN_OF_A_STEP = 0.01
"""Nats that a step is expected to gain; the fits are told apart by tens."""

_FITTED_AGAIN = 8
"""Covariances after which the fit is tried from its starts again, then after ever more of them."""

_CROWDED = 3
"""Of so many elements one source: where there seem to be more, noise may have been taken for them,
and little is left of it that the test could see."""

_RAREST_TURN = 32

_MEANT, _FEWEST_MEANT = 4, 3
"""Covariances in whose mean the fit is tried: weak sources that one covariance does not show are
no colour."""

_MOST_SOURCES = 0.5
"""Of the elements, beside which the colour of the noise can be seen at all."""

_FEWEST_SOURCES = (None, 0, 2)
"""Starts of the fit: with as many sources as MDL sees in white noise, and with few of them."""


@dataclass(frozen=True)
class NoiseColour:
    """What is known of the colour of the noise.

    Attributes
    ----------
    coloured : bool
        Whether it is not white.
    parameters : ndarray, shape (n_parameters,), or empty
        Of the model, pure numbers; zero = white.
    score : ndarray, shape (n_parameters,), or empty
        Sum of the scores at white noise, pure numbers.
    variance : ndarray, shape (n_parameters, n_parameters), or empty
        Its variance in white noise, pure numbers.
    information : ndarray, shape (n_parameters, n_parameters), or empty
        Of the parameters, pure numbers.
    n_steps : int
        Covariances since the colour was found; suspect ones while the noise is white.
    mean : ndarray, shape (n_elements, n_elements), complex, or empty
        Of the last covariances while the noise is white, linear power.
    n_meant : int
        How many they are.
    """

    coloured: bool = False
    parameters: FloatArray = field(default_factory=lambda: np.empty(0))
    score: FloatArray = field(default_factory=lambda: np.empty(0))
    variance: FloatArray = field(default_factory=lambda: np.empty((0, 0)))
    information: FloatArray = field(default_factory=lambda: np.empty((0, 0)))
    n_steps: int = 0
    mean: ComplexArray = field(default_factory=lambda: np.empty((0, 0), dtype=np.complex128))
    n_meant: int = 0

    def update(self, judged: JudgedCovariance, share: float) -> NoiseColour:
        """Return the colour after one more covariance.

        Parameters
        ----------
        judged : JudgedCovariance
            The covariance.
        share : float
            How many of its snapshots are new, 0 to 1.
        """
        model, n_snapshots = judged.model, judged.n_snapshots
        if model is None:
            return self
        if len(self.parameters) != model.n_parameters:
            return _white(model).update(judged, share)
        covariance, white, row = judged.of_noise, judged.white, judged.row
        if self.coloured:
            return self._follow(covariance, n_snapshots, model, share)
        if white is None:
            white, row = noise_evidence(covariance[None], n_snapshots, model, self.parameters), 0
        return self._test(covariance, n_snapshots, model, share, white, row)

    def _test(
        self,
        covariance: ComplexArray,
        n_snapshots: int,
        model: NoiseModel,
        share: float,
        white: NoiseEvidence,
        row: int,
    ) -> NoiseColour:
        kept = FORGETTING**share
        score = kept * self.score + share * white.score[row]
        variance = kept**2 * self.variance + share * white.information[row]
        significant = score @ solved(variance, score) >= SIGNIFICANT
        suspect = significant or white.ranks[row] >= len(covariance) / _CROWDED
        n_suspect = self.n_steps + int(suspect)
        n_meant = min(self.n_meant + 1, _MEANT)
        before = self.mean if self.mean.shape == covariance.shape else covariance
        latest, covariance = covariance, before + (covariance - before) / n_meant
        summed = replace(
            self,
            score=score,
            variance=variance,
            n_steps=n_suspect,
            mean=covariance,
            n_meant=n_meant,
        )
        if not suspect or n_meant < _FEWEST_MEANT or not _has_a_turn(n_suspect - _FEWEST_MEANT + 1):
            return summed
        n_all = n_snapshots * n_meant
        fitted, evidence = _fitted(covariance, n_all, model)
        least = _least_gain(len(covariance)) * _caution(covariance)
        doubtful = _gain(covariance, n_all, model, fitted) < least
        doubtful |= _gain(latest, n_snapshots, model, fitted) < LEAST_GAIN * _caution(latest)
        doubtful |= evidence.ranks[0] > _MOST_SOURCES * len(covariance)
        if doubtful or _largest_correlation(model.covariance(fitted)) < LEAST_CORRELATION:
            return summed
        return replace(
            _white(model),
            coloured=True,
            parameters=fitted,
            information=evidence.information[0],
        )

    def _follow(
        self, covariance: ComplexArray, n_snapshots: int, model: NoiseModel, share: float
    ) -> NoiseColour:
        evidence = noise_evidence(covariance[None], n_snapshots, model, self.parameters)
        information = FORGETTING**share * self.information + share * evidence.information[0]
        change = solved(information, share * evidence.score[0])
        parameters = model.bounded(self.parameters + np.clip(change, -LARGEST_STEP, LARGEST_STEP))
        followed = replace(
            self, parameters=parameters, information=information, n_steps=self.n_steps + 1
        )
        if parameters @ information @ parameters < _WHITE_AGAIN:
            return _white(model)
        turn, rest = divmod(followed.n_steps, _FITTED_AGAIN)
        if rest or not _has_a_turn(turn):
            return followed
        fitted, other = _fitted(covariance, n_snapshots, model)
        if other.description[0] > evidence.description[0] - LEAST_GAIN:
            return followed
        return replace(followed, parameters=fitted, information=other.information[0])


def _gain(
    covariance: ComplexArray, n_snapshots: int, model: NoiseModel, parameters: FloatArray
) -> float:
    """Return how many nats a colour shortens the description of a covariance by.

    Sources that move are smeared in the mean of several covariances, and not in one of them.
    """
    white = noise_evidence(covariance[None], n_snapshots, model, np.zeros(model.n_parameters))
    coloured = noise_evidence(covariance[None], n_snapshots, model, parameters)
    return float(white.description[0] - coloured.description[0])


def _least_gain(n_elements: int) -> float:
    """Return the nats that a colour must gain: weak sources that are not counted bring some too."""
    return min(_GAIN_PER_PAIR * n_elements**2, _MOST_GAIN)


def _caution(covariance: ComplexArray) -> float:
    """Return how much more must be gained beside a strong source: it leaves more in the noise."""
    values = np.linalg.eigvalsh(covariance)
    middle = max(float(values[len(values) // 2]), float(np.finfo(float).tiny))
    return max(float(np.log10(float(values[-1]) / middle)) - 1.0, 1.0)


def _largest_correlation(covariance: ComplexArray) -> float:
    return float(np.abs(covariance - np.diag(np.diagonal(covariance))).max())


def _has_a_turn(number: int) -> bool:
    """Return whether the fit is tried at the so many-th suspect covariance: less and less often."""
    return number < 1 or number % _RAREST_TURN == 0 or number & (number - 1) == 0


def _white(model: NoiseModel) -> NoiseColour:
    n = model.n_parameters
    zero, none = np.zeros(n), np.zeros((n, n))
    return NoiseColour(parameters=zero, score=zero, variance=none, information=none)


def _fitted(
    covariance: ComplexArray, n_snapshots: int, model: NoiseModel
) -> tuple[FloatArray, NoiseEvidence]:
    """Return the parameters that describe one covariance most briefly, and their evidence.

    A start goes on only as long as a step is expected to raise the likelihood.
    """
    fits = []
    for most_sources in _FEWEST_SOURCES:
        parameters = np.zeros(model.n_parameters)
        for limit in dict.fromkeys((most_sources, None)):
            n_steps = _FIT_STEPS if most_sources is None else _FIT_STEPS // 2
            for _ in range(n_steps):
                evidence = noise_evidence(covariance[None], n_snapshots, model, parameters, limit)
                before, parameters = parameters, evidence.step(0, model, parameters)
                if 0.5 * evidence.score[0] @ (parameters - before) < _LEAST_GAIN_OF_A_STEP:
                    break
        fits.append((parameters, noise_evidence(covariance[None], n_snapshots, model, parameters)))
    return min(fits, key=lambda fit: float(fit[1].description[0]))
