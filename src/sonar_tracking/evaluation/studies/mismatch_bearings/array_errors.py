"""Arrays that are not as described: gains and phases, exchanged and inverted channels."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.records.arrays import ComplexArray


@dataclass(frozen=True)
class ArrayErrors:
    """What is wrong with an array, drawn anew in each run.

    Attributes
    ----------
    gain : float
        Relative standard deviation of the gains of the channels.
    phase_deg : float
        Standard deviation of their phases, deg.
    exchanged : bool
        Whether two channels, any two, are exchanged.
    inverted : bool
        Whether one channel, any one, is inverted.
    """

    gain: float = 0.0
    phase_deg: float = 0.0
    exchanged: bool = False
    inverted: bool = False

    def draw(self, n_elements: int, generator: np.random.Generator) -> WrongArray:
        """Return the array of a run.

        Parameters
        ----------
        n_elements : int
            Of the array.
        generator : numpy.random.Generator
            All randomness.
        """
        normal = generator.standard_normal((2, n_elements))
        phase = np.radians(self.phase_deg) * normal[1]
        factors = (1.0 + self.gain * normal[0]) * np.exp(1j * phase)
        order = np.arange(n_elements)
        first, second = generator.choice(n_elements, 2, replace=False).tolist()
        if self.exchanged:
            order[[first, second]] = order[[second, first]]
            return WrongArray(factors, order, (first, second))
        if self.inverted:
            factors[first] *= -1.0
            return WrongArray(factors, order, (first,))
        return WrongArray(factors, order, ())


@dataclass(frozen=True)
class WrongArray:
    """The array of a run.

    Attributes
    ----------
    factors : ndarray, shape (n_elements,), complex
        Of what each channel should deliver, pure numbers.
    order : ndarray of int, shape (n_elements,)
        Element that each channel belongs to.
    faulty : tuple of int
        Elements whose channels are exchanged or inverted.
    """

    factors: ComplexArray
    order: np.ndarray
    faulty: tuple[int, ...]

    def received(self, data: ComplexArray) -> ComplexArray:
        """Return what the channels deliver, shape as given, linear amplitude.

        Parameters
        ----------
        data : ndarray, shape (..., n_elements), complex
            What they should deliver, linear amplitude.
        """
        return (data * self.factors)[..., self.order]
