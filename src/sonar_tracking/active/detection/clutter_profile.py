"""How the density of false contacts depends on the distance, where it is not as claimed.

A claim of so many false contacts per square metre, or per cell, says how they are spread over the
distance. Real ones come in clumps: near the sensor, where a beam has many cells, at the shore, in a
convergence zone. They are counted in rings whose width doubles outwards, and a ring with clearly
more than its share gets what it has.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from sonar_tracking.records.arrays import BoolArray, FloatArray, IndexArray

RINGS = 7
"""Number of rings; the outermost begins at half the largest distance."""

FORGETTING = 0.95
"""Weight of the pings before, about twenty of which count."""

CLEAR_RATIO = 2.0
"""By which the contacts of a ring must exceed its share."""

CLEAR_DEVIATIONS = 4.0
"""By which a number must exceed the expected one besides, or the expectation is believed."""

UNSEEN = 0.2
"""Contacts that are taken to have been counted and expected besides: of few one cannot tell."""


@dataclass(frozen=True)
class ClutterProfile:
    """Contacts that no track explains, in rings around the sensor, older ones forgotten.

    Attributes
    ----------
    reach : float
        Largest distance, m.
    counted, expected : ndarray, shape (RINGS,)
        Contacts in each ring, pure numbers.
    """

    reach: float = 0.0
    counted: FloatArray = field(default_factory=lambda: np.zeros(RINGS))
    expected: FloatArray = field(default_factory=lambda: np.zeros(RINGS))

    def after(self, distance: FloatArray, expected: FloatArray, reach: float) -> ClutterProfile:
        """Return the profile after another ping.

        Parameters
        ----------
        distance : ndarray, shape (n,)
            Of the contacts that no track explains, m.
        expected : ndarray, shape (RINGS,)
            Contacts that the claimed density gives in each ring, pure numbers.
        reach : float
            Largest distance, m.
        """
        rings = _rings(distance, reach)
        counted = np.bincount(rings, minlength=RINGS).astype(np.float64)
        if reach != self.reach:
            return ClutterProfile(reach, counted, expected)
        return ClutterProfile(
            reach, FORGETTING * self.counted + counted, FORGETTING * self.expected + expected
        )

    @property
    def contradicted(self) -> BoolArray:
        """Rings with clearly more than their share, shape (RINGS,)."""
        return clearly_more(self.counted, self.expected, CLEAR_RATIO)

    @property
    def is_contradicted(self) -> bool:
        """Whether a ring has clearly more than its share."""
        more = self.counted > CLEAR_RATIO * self.expected
        return bool(more.any() and self.contradicted.any())

    def factor(self, distance: FloatArray) -> FloatArray:
        """Return by what the claimed density has to be multiplied, at distances, shape (n,), m."""
        if not self.reach:
            return np.ones(len(distance))
        found = (self.counted + UNSEEN) / (self.expected + UNSEEN)
        factor = np.where(self.contradicted, found, 1.0)
        return np.asarray(factor[_rings(distance, self.reach)])


def clearly_more(
    counted: FloatArray | float, expected: FloatArray | float, ratio: float
) -> BoolArray:
    """Return whether clearly more contacts were counted than are expected.

    Parameters
    ----------
    counted, expected : float or ndarray, shape (n,)
        Contacts, pure numbers.
    ratio : float
        By which, and by several deviations of a Poisson number, they must be more.

    Returns
    -------
    ndarray of bool, shape () or (n,)
        Of each.
    """
    deviation = np.sqrt(np.maximum(expected, 1.0))
    clear = np.maximum(ratio * expected, expected + CLEAR_DEVIATIONS * deviation)
    return np.asarray(counted > clear)


@lru_cache(maxsize=16)
def ring_edges(reach: float) -> FloatArray:
    """Return the bounds of the rings, shape (RINGS + 1,), m; read only, since they are kept."""
    edges = np.append(0.0, reach * 2.0 ** np.arange(1.0 - RINGS, 1.0))
    edges.setflags(write=False)
    return edges


def _rings(distance: FloatArray, reach: float) -> IndexArray:
    return np.asarray(ring_edges(reach)[1:-1].searchsorted(distance, side="right"))
