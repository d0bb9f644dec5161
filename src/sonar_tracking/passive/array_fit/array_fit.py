"""What the data have told so far of how an array differs from its description."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from sonar_tracking.errors import Notice, Severity
from sonar_tracking.passive.array_fit.noise_colour import NoiseColour
from sonar_tracking.passive.array_fit.noise_models import noise_model
from sonar_tracking.records.arrays import ComplexArray, FloatArray


@dataclass(frozen=True)
class ArrayFit:
    """How an array differs from its description.

    Attributes
    ----------
    colour : NoiseColour
        Of the noise.
    fitted_to : int
        Global index of the newest snapshot that was judged.
    """

    colour: NoiseColour = field(default_factory=NoiseColour)
    fitted_to: int = -1

    @property
    def as_described(self) -> bool:
        """Whether nothing but the description of the array is needed."""
        return not self.colour.coloured

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
        if not self.colour.coloured or model is None:
            return None
        return model.covariance(self.colour.parameters)

    def notices(self, positions: FloatArray) -> list[Notice]:
        """Return what a user should know of the array.

        Parameters
        ----------
        positions : ndarray, shape (n_elements, 3)
            Element positions, m.
        """
        noise = self.noise_covariance(positions)
        if noise is None:
            return []
        largest = float(np.abs(noise[0, 1:]).max())
        return [
            Notice(
                Severity.WARN,
                "noise",
                f"The noise is not white: correlated between elements by up to {largest:.2f}. Its "
                "covariance is estimated from the data and used; give noise_covariance with the "
                "snapshots if it is known.",
            )
        ]
