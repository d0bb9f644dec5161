"""What the data have told so far of how an array differs from its description."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from sonar_tracking.filtering.eigenpairs import stacked_eigenpairs
from sonar_tracking.passive.array_fit.alike_cases import alike
from sonar_tracking.passive.array_fit.element_faults import ElementFaults
from sonar_tracking.passive.array_fit.judged_covariance import JudgedCovariance
from sonar_tracking.passive.array_fit.noise_colour import NoiseColour
from sonar_tracking.passive.array_fit.noise_models import noise_model
from sonar_tracking.passive.array_fit.steering_fit import SteeringFit, updated_steering
from sonar_tracking.passive.array_fit.strong_sources import StrongSources, strong_sources
from sonar_tracking.passive.sources.noise_of_windows import common_or_stacked
from sonar_tracking.records.arrays import ComplexArray, FloatArray

MOST_WHITENED = 256
"""Elements of an array whose noise is whitened: beyond, that takes longer than the data last."""

_ALL_LOOKED_AT = 8
"""Covariances that strong sources are sought in one by one; then in every other one."""


@dataclass(frozen=True)
class ArrayFit:
    """How an array differs from its description.

    Attributes
    ----------
    colour : NoiseColour
        Of the noise.
    faults : ElementFaults
        Elements that are inverted or exchanged.
    steering : SteeringFit
        Errors of the elements.
    fitted_to : int
        Global index of the newest snapshot that was judged.
    n_judged : int
        Covariances judged.
    """

    colour: NoiseColour = field(default_factory=NoiseColour)
    faults: ElementFaults = field(default_factory=ElementFaults)
    steering: SteeringFit = field(default_factory=SteeringFit)
    fitted_to: int = -1
    n_judged: int = 0

    @property
    def as_described(self) -> bool:
        """Whether nothing but the description of the array is needed."""
        faulty = self.faults.found or self.steering.error
        return not (self.colour.coloured or faulty)

    def looks_at(self, judged: JudgedCovariance, colour: NoiseColour) -> bool:
        """Return whether strong sources are sought in the next covariance.

        Parameters
        ----------
        judged : JudgedCovariance
            The covariance.
        colour : NoiseColour
            Of the noise, after it.
        """
        if judged.covariance is None or colour.coloured is not self.colour.coloured:
            return False
        number = self.n_judged
        return number < _ALL_LOOKED_AT or number % 2 == 0 or self.faults.votes > 0

    def judged(self, colour: NoiseColour, end: int) -> ArrayFit:
        """Return the fit after one more covariance, before strong sources are looked at.

        Parameters
        ----------
        colour : NoiseColour
            Of the noise, after it.
        end : int
            Global index of its last snapshot.
        """
        fit = replace(self, colour=colour, fitted_to=end, n_judged=self.n_judged + 1)
        if colour.coloured is self.colour.coloured:
            return fit
        # What strong sources seemed to show was judged in noise of another colour.
        faults = ElementFaults(found=self.faults.found)
        return replace(fit, faults=faults, steering=SteeringFit())

    def noise_covariance(self, positions: FloatArray) -> ComplexArray | None:
        """Return the noise covariance found, None = white.

        Parameters
        ----------
        positions : ndarray, shape (n_elements, 3)
            Element positions, m.

        Returns
        -------
        ndarray, shape (n_elements, n_elements), complex, or None
            Pure numbers with trace n_elements.
        """
        model = noise_model(positions)
        if not self.colour.coloured or model is None or len(positions) > MOST_WHITENED:
            return None
        return model.covariance(self.colour.parameters)

    def largest_correlation(self, positions: FloatArray) -> float:
        """Return the largest correlation of the noise found with that of the first element.

        Parameters
        ----------
        positions : ndarray, shape (n_elements, 3)
            Element positions, m.
        """
        first = positions[:MOST_WHITENED]
        model = noise_model(first)
        if not self.colour.coloured or model is None:
            return 0.0
        return float(np.abs(model.covariance(self.colour.parameters)[0, 1:]).max())

    def undone(self, snapshots: ComplexArray) -> ComplexArray:
        """Return snapshots, or other rows of numbers by element, without the faults found.

        Parameters
        ----------
        snapshots : ndarray, shape (..., n_elements), complex
            Of all elements, in any unit.

        Returns
        -------
        ndarray, shape (..., n_elements), complex
            In that unit.
        """
        if not self.faults.found:
            return snapshots
        order, signs = self.faults.order_and_signs(snapshots.shape[-1])
        return np.asarray(snapshots[..., order] * signs, dtype=np.complex128)


def updated_fits(
    before: Sequence[tuple[ArrayFit, JudgedCovariance, NoiseColour, int]],
) -> list[ArrayFit]:
    """Return the fits of several runs after one more covariance, in which faults are undone.

    Parameters
    ----------
    before : sequence of (ArrayFit, JudgedCovariance, NoiseColour, int)
        The fit, the covariance, the colour of the noise after it, and the global index of its last
        snapshot.
    """
    fits = [fit.judged(colour, end) for fit, _, colour, end in before]
    looked_at = {
        run: judged
        for run, (fit, judged, colour, _) in enumerate(before)
        if fit.looks_at(judged, colour)
    }
    asked: dict[int, tuple[SteeringFit, StrongSources, JudgedCovariance]] = {}
    for run, strong in _strong_sources(fits, looked_at).items():
        faults = fits[run].faults
        after = faults.update(strong)
        fits[run] = replace(fits[run], faults=after)
        if not after.votes and after.found == faults.found:
            asked[run] = (fits[run].steering, strong, looked_at[run])
    for run, steering in zip(asked, updated_steering(list(asked.values())), strict=True):
        fits[run] = replace(fits[run], steering=steering)
    return fits


def _strong_sources(
    fits: Sequence[ArrayFit], looked_at: Mapping[int, JudgedCovariance]
) -> dict[int, StrongSources]:
    """Return the strong sources in the covariances of some runs, where there are any."""
    noise = {
        run: fits[run].noise_covariance(each.positions) if each.noise is None else each.noise
        for run, each in looked_at.items()
    }
    found: dict[int, StrongSources] = {}
    for runs in alike({run: each.kind(noise[run]) for run, each in looked_at.items()}):
        first, white = looked_at[runs[0]], noise[runs[0]] is None
        judged = [each for run in runs if (each := looked_at[run].covariance) is not None]
        strong = strong_sources(
            np.stack(judged),
            first.n_snapshots,
            first.positions,
            first.wavenumber,
            first.elements,
            common_or_stacked([noise[run] for run in runs]),
            stacked_eigenpairs([looked_at[run].eigenpairs for run in runs]) if white else None,
        )
        found.update((run, each) for run, each in zip(runs, strong, strict=True) if each)
    return found
