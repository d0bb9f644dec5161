"""How large the errors of an array's bearings are, and how long they last: from its innovations.

A bearing tracker smooths, arrays bend, and bearings of sources near each other pull each other, so
that errors are larger than told, and last. With innovations nu of predicted variance S = P + R,
the told variance R is multiplied by

    k = max(1, mean (nu^2 - P) / R) (1 + rho) / (1 - rho),

rho the correlation of an innovation with the one before, of the same target: so many bearings in a
row tell as much as one that is free of what was before. Both are means with forgetting over all
targets the array hears; as long as little is known, k is that of a prior.

References
----------
Bar-Shalom, Li, Kirubarajan (2001), sections 5.4 (whiteness of innovations), 8.3 (coloured noise).
"""

from __future__ import annotations

import math

import numpy as np

from sonar_tracking.records.arrays import FloatArray

BearingKey = tuple[str, int]
"""Station and its bearing track."""

MEMORY = 200.0
"""Innovations after which what was before counts by e^-1."""

PRIOR_COUNT = 5.0
"""Innovations that the prior counts as much as: errors as large as told, and white."""

LARGEST = 9.0
"""Of nu^2 / S: what is larger is of something else, and tells nothing of the errors."""

LARGEST_SCALE = 100.0
"""Of variances; errors ten times as large as told are no errors of bearings."""

SURE = 2.0
"""Standard deviations by which a correlation must exceed none."""

HIGHEST_CORRELATION = 0.95


class BearingErrors:
    """What is known of the bearings of one array."""

    def __init__(self) -> None:
        self._count = PRIOR_COUNT
        self._size = PRIOR_COUNT
        self._product = 0.0
        self._square = PRIOR_COUNT
        self._last: dict[BearingKey, float] = {}

    @property
    def scale(self) -> float:
        """By how much told variances are too small, a pure number of at least 1."""
        correlation = self._product / self._square - SURE / math.sqrt(self._count)
        correlation = min(max(correlation, 0.0), HIGHEST_CORRELATION)
        size = max(self._size / self._count, 1.0)
        return min(size * (1.0 + correlation) / (1.0 - correlation), LARGEST_SCALE)

    def learn(
        self,
        keys: list[BearingKey],
        innovation: FloatArray,
        predicted: FloatArray,
        told: FloatArray,
    ) -> None:
        """Take the innovations of some bearing tracks in.

        Parameters
        ----------
        keys : list of BearingKey
            Whose.
        innovation : ndarray, shape (n,)
            rad.
        predicted, told : ndarray, shape (n,)
            Variances of the prediction and, as told, of the bearing, rad^2.
        """
        total = predicted + self.scale * told
        sizes = (innovation**2 - predicted) / told
        errors = innovation / np.sqrt(total)
        for key, size, error in zip(keys, sizes.tolist(), errors.tolist(), strict=True):
            if error**2 > LARGEST:
                self._last.pop(key, None)
                continue
            kept = math.exp(-1.0 / MEMORY)
            self._count = kept * self._count + 1.0
            self._size = kept * self._size + size
            self._square = kept * self._square + error**2
            self._product = kept * self._product + error * self._last.get(key, 0.0)
            self._last[key] = error
