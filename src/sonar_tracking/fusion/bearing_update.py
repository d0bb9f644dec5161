"""What a bearing each, of one station, does to targets."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.alignment.aligned_targets import AlignedTargets
from sonar_tracking.alignment.measured_bearings import Bearings
from sonar_tracking.records.arrays import BoolArray, FloatArray


@dataclass(frozen=True)
class BearingUpdate:
    """What bearings do to targets.

    Attributes
    ----------
    bearings : Bearings
        One a target, on the sides where the targets are.
    innovation, spread : ndarray, shape (n,)
        By how much they differ from what was expected, rad, and the variance of that without the
        errors of the bearings, rad^2.
    updated : AlignedTargets
        The targets with the bearings taken in.
    likelihood : ndarray, shape (n,)
        How likely each bearing was, if it may be from anywhere, too; log of a density, 1/rad.
    """

    bearings: Bearings
    innovation: FloatArray
    spread: FloatArray
    updated: AlignedTargets
    likelihood: FloatArray

    def rows(self, rows: slice) -> BearingUpdate:
        """Return what some of the bearings do."""
        return BearingUpdate(
            self.bearings.rows(rows),
            self.innovation[rows],
            self.spread[rows],
            self.updated.rows(rows),
            self.likelihood[rows],
        )

    def is_expected(self, gate: float) -> BoolArray:
        """Return which bearings are within a gate (standard deviations), shape (n,)."""
        total = self.spread + self.bearings.variance
        return np.asarray(self.innovation**2 <= gate**2 * total)
