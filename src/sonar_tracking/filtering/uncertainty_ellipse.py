"""Uncertainty of a position as the ellipse that holds the target with a given probability."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sonar_tracking.records.arrays import FloatArray

PROBABILITY = 0.95
"""Of the ellipses people are shown."""


@dataclass(frozen=True)
class UncertaintyEllipse:
    """Ellipse about a position.

    Attributes
    ----------
    semi_major, semi_minor : float
        Half axes, m.
    azimuth : float
        Direction of the major axis, rad in [-pi/2, pi/2).
    """

    semi_major: float
    semi_minor: float
    azimuth: float

    def outline(self, centre: FloatArray, n_points: int = 73) -> FloatArray:
        """Return points on the ellipse, closed.

        Parameters
        ----------
        centre : ndarray, shape (2,)
            m.
        n_points : int
            First and last are the same.

        Returns
        -------
        ndarray, shape (n_points, 2)
            m.
        """
        around = np.linspace(0.0, 2.0 * np.pi, n_points)
        along, across = self.semi_major * np.cos(around), self.semi_minor * np.sin(around)
        cosine, sine = math.cos(self.azimuth), math.sin(self.azimuth)
        return centre + np.stack(
            [along * cosine - across * sine, along * sine + across * cosine], axis=-1
        )


def uncertainty_ellipse(
    covariance: FloatArray, probability: float = PROBABILITY
) -> UncertaintyEllipse | None:
    """Return the ellipse of a Gaussian position, or None where the covariance is not proper.

    The squared Mahalanobis distance of two dimensions is exponentially distributed: the ellipse of
    probability p has the half axes sqrt(-2 ln(1 - p) eigenvalue).

    Parameters
    ----------
    covariance : ndarray, shape (2, 2) or larger
        Of x, y and whatever follows, m^2.
    probability : float
        That the target is inside, 0 to 1.
    """
    position = np.asarray(covariance)[:2, :2]
    if not np.isfinite(position).all():
        return None
    values, vectors = np.linalg.eigh(position)
    if values[1] <= 0.0 or values[0] < -1e-9 * values[1]:
        return None
    minor, major = np.sqrt(-2.0 * math.log1p(-probability) * np.maximum(values, 0.0))
    azimuth = math.atan2(vectors[1, 1], vectors[0, 1])
    azimuth = (azimuth + 0.5 * math.pi) % math.pi - 0.5 * math.pi
    return UncertaintyEllipse(float(major), float(minor), azimuth)
