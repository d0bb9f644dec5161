"""What the data have told so far of how an array differs from its description."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from sonar_tracking.passive.array_fit.element_faults import ElementFaults
from sonar_tracking.passive.array_fit.judged_covariance import JudgedCovariance
from sonar_tracking.passive.array_fit.noise_colour import NoiseColour
from sonar_tracking.passive.array_fit.noise_models import noise_model
from sonar_tracking.passive.array_fit.steering_fit import SteeringFit
from sonar_tracking.passive.array_fit.strong_sources import strong_sources
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

    def update(self, judged: JudgedCovariance, colour: NoiseColour, end: int) -> ArrayFit:
        """Return the fit after one more covariance, in which the faults found are undone.

        Parameters
        ----------
        judged : JudgedCovariance
            The covariance.
        colour : NoiseColour
            Of the noise, after it.
        end : int
            Global index of its last snapshot.
        """
        number = self.n_judged
        fit = replace(self, colour=colour, fitted_to=end, n_judged=number + 1)
        if colour.coloured is not self.colour.coloured:
            # What strong sources seemed to show was judged in noise of another colour.
            faults = ElementFaults(found=self.faults.found)
            return replace(fit, faults=faults, steering=SteeringFit())
        looked_at = number < _ALL_LOOKED_AT or number % 2 == 0 or self.faults.votes > 0
        if judged.covariance is None or not looked_at:
            return fit
        strong = strong_sources(
            judged.covariance,
            judged.n_snapshots,
            judged.positions,
            judged.wavenumber,
            judged.elements,
            fit.noise_covariance(judged.positions) if judged.noise is None else judged.noise,
        )
        if strong is None:
            return fit
        faults = self.faults.update(strong)
        if faults.votes or faults.found != self.faults.found:
            return replace(fit, faults=faults)
        return replace(fit, faults=faults, steering=self.steering.update(strong, judged))

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
