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

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from sonar_tracking.passive.array_fit.alike_cases import alike
from sonar_tracking.passive.array_fit.judged_covariance import JudgedCovariance
from sonar_tracking.passive.array_fit.noise_evidence import (
    LARGEST_STEP,
    NoiseEvidence,
    noise_evidence,
    solved,
)
from sonar_tracking.passive.array_fit.noise_fit import NoiseFits, noise_fits
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

    def updated(
        self, judged: JudgedCovariance, share: float, evidence: NoiseEvidence
    ) -> tuple[NoiseColour, _Trial | None]:
        """Return the colour after one more covariance, and the fit that is due then, if any.

        Parameters
        ----------
        judged : JudgedCovariance
            The covariance.
        share : float
            How many of its snapshots are new, 0 to 1.
        evidence : NoiseEvidence
            What it says of the colour so far.
        """
        if judged.model is None:
            return self, None
        step = self._followed if self.coloured else self._summed
        return step(judged, judged.model, share, evidence)

    def _summed(
        self, judged: JudgedCovariance, model: NoiseModel, share: float, white: NoiseEvidence
    ) -> tuple[NoiseColour, _Trial | None]:
        """Return the colour after a test for white noise of one more covariance."""
        latest = judged.of_noise
        kept = FORGETTING**share
        score = kept * self.score + share * white.score
        variance = kept**2 * self.variance + share * white.information
        significant = score @ solved(variance, score) >= SIGNIFICANT
        suspect = significant or white.ranks >= len(latest) / _CROWDED
        n_suspect = self.n_steps + int(suspect)
        n_meant = min(self.n_meant + 1, _MEANT)
        before = self.mean if self.mean.shape == latest.shape else latest
        mean = before + (latest - before) / n_meant
        summed = replace(
            self, score=score, variance=variance, n_steps=n_suspect, mean=mean, n_meant=n_meant
        )
        if not suspect or n_meant < _FEWEST_MEANT or not _has_a_turn(n_suspect - _FEWEST_MEANT + 1):
            return summed, None
        return summed, _Trial(summed, judged, model, white, mean, judged.n_snapshots * n_meant)

    def _followed(
        self, judged: JudgedCovariance, model: NoiseModel, share: float, evidence: NoiseEvidence
    ) -> tuple[NoiseColour, _Trial | None]:
        """Return the colour, which is known, after a step towards one more covariance."""
        information = FORGETTING**share * self.information + share * evidence.information
        change = solved(information, share * evidence.score)
        parameters = model.bounded(self.parameters + np.clip(change, -LARGEST_STEP, LARGEST_STEP))
        followed = replace(
            self, parameters=parameters, information=information, n_steps=self.n_steps + 1
        )
        if parameters @ information @ parameters < _WHITE_AGAIN:
            return _white(model), None
        turn, rest = divmod(followed.n_steps, _FITTED_AGAIN)
        if rest or not _has_a_turn(turn):
            return followed, None
        trial = _Trial(followed, judged, model, evidence, judged.of_noise, judged.n_snapshots)
        return followed, trial


@dataclass(frozen=True)
class _Trial:
    """A fit that is due after one more covariance.

    Attributes
    ----------
    colour : NoiseColour
        Without the fit.
    judged : JudgedCovariance
        The covariance.
    model : NoiseModel
        Of the noise.
    evidence : NoiseEvidence
        What it says of the colour before it.
    fitted_in : ndarray, shape (n_elements, n_elements), complex
        What is fitted: that covariance or the mean of the last ones, linear power.
    n_snapshots : int
        Snapshots in that.
    """

    colour: NoiseColour
    judged: JudgedCovariance
    model: NoiseModel
    evidence: NoiseEvidence
    fitted_in: ComplexArray
    n_snapshots: int

    def with_fit(self, fits: NoiseFits, row: int) -> NoiseColour:
        """Return the colour with the fit, one of several, if that tells more than no fit."""
        parameters, evidence = fits.parameters[row], fits.evidence.of(row)
        if not self.colour.coloured:
            if self._is_doubtful(parameters, evidence, float(fits.gains[row])):
                return self.colour
            found = replace(_white(self.model), coloured=True)
        elif evidence.description > self.evidence.description - LEAST_GAIN:
            return self.colour
        else:
            found = self.colour
        return replace(found, parameters=parameters, information=evidence.information)

    def _is_doubtful(self, parameters: FloatArray, evidence: NoiseEvidence, gain: float) -> bool:
        """Return whether a fit in the mean of some covariances is no colour for sure."""
        mean, latest, n_elements = self.colour.mean, self.judged.of_noise, len(self.colour.mean)
        if evidence.ranks > _MOST_SOURCES * n_elements:
            return True
        if gain < _least_gain(n_elements) * _caution(mean):
            return True
        if _largest_correlation(self.model.covariance(parameters)) < LEAST_CORRELATION:
            return True
        # Sources that move are smeared in the mean, and not in one covariance.
        n_snapshots = self.judged.n_snapshots
        coloured = noise_evidence(latest[None], n_snapshots, self.model, parameters)
        gain = float(self.evidence.description - coloured.description[0])
        return gain < LEAST_GAIN * _caution(latest)


def updated_colours(
    before: Sequence[tuple[NoiseColour, JudgedCovariance, float]],
) -> list[NoiseColour]:
    """Return the colours of the noise of several runs after one more covariance of each.

    Parameters
    ----------
    before : sequence of (NoiseColour, JudgedCovariance, float)
        What is known of the colour, the covariance, and how many of its snapshots are new, 0 to 1.
    """
    after = [_sized(colour, judged.model) for colour, judged, _ in before]
    evidence = _own_evidence(after, [judged for _, judged, _ in before])
    trials: dict[int, _Trial] = {}
    for run, own in evidence.items():
        _, judged, share = before[run]
        after[run], trial = after[run].updated(judged, share, own)
        if trial is not None:
            trials[run] = trial
    for runs in alike({run: (id(t.model), t.n_snapshots) for run, t in trials.items()}):
        first = trials[runs[0]]
        covariances = np.stack([trials[run].fitted_in for run in runs])
        fits = noise_fits(covariances, first.n_snapshots, first.model)
        for row, run in enumerate(runs):
            after[run] = trials[run].with_fit(fits, row)
    return after


def _own_evidence(
    colours: Sequence[NoiseColour], judged: Sequence[JudgedCovariance]
) -> dict[int, NoiseEvidence]:
    """Return what the covariances say of the colours, by run, where the noise can be judged."""
    evidence: dict[int, NoiseEvidence] = {}
    asked: dict[int, tuple[int, int]] = {}
    for run, (colour, each) in enumerate(zip(colours, judged, strict=True)):
        if each.white is not None and not colour.coloured:
            evidence[run] = each.white
        elif each.model is not None:
            asked[run] = (id(each.model), each.n_snapshots)
    for runs in alike(asked):
        first = judged[runs[0]]
        if first.model is None:
            continue
        together = noise_evidence(
            np.stack([judged[run].of_noise for run in runs]),
            first.n_snapshots,
            first.model,
            np.stack([colours[run].parameters for run in runs]),
        )
        evidence.update((run, together.of(row)) for row, run in enumerate(runs))
    return evidence


def _sized(colour: NoiseColour, model: NoiseModel | None) -> NoiseColour:
    """Return the colour, white where its parameters are not those of the model."""
    if model is None or len(colour.parameters) == model.n_parameters:
        return colour
    return _white(model)


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
