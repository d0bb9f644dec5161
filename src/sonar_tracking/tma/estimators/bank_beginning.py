"""The first measurements of a bank, which are kept lest they were believed too much.

How large the errors of a station really are shows only after some measurements. By then a bank that
believed what it was told may have settled on a wrong range, or on a target that weaves. So after a
few numbers of measurements what was believed is compared with what has been learnt meanwhile; see
:mod:`~sonar_tracking.tma.estimators.bank_replay`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.records.arrays import BoolArray, FloatArray, IntArray
from sonar_tracking.tma.estimators.sensor_frame import TmaMeasurement

CHECKED_AFTER = (20, 40, 80)
"""Numbers of measurements after which what was believed is compared with what has been learnt."""

MISJUDGED = 3.0
"""Variances that turn out to be larger than believed by this factor are no detail."""


@dataclass(frozen=True)
class Beginning:
    """What banks of one or many runs have taken in since they began.

    Attributes
    ----------
    measurements : tuple of TmaMeasurement
        As told, of all runs, in order.
    first : ndarray of int64, shape (...)
        Of each run, which of the measurements it began with.
    believed : ndarray, shape (..., 1 + n_lines)
        What told variances of the azimuth and of lines were multiplied by, pure numbers.
    """

    measurements: tuple[TmaMeasurement, ...]
    first: IntArray
    believed: FloatArray

    @property
    def due(self) -> BoolArray:
        """Which runs are to be compared now, shape (...)."""
        return np.isin(len(self.measurements) - self.first, CHECKED_AFTER)

    def misjudged(self, factor: FloatArray) -> BoolArray:
        """Return which runs are due and have believed too much, shape (...).

        Parameters
        ----------
        factor : ndarray, shape (..., 1 + n_lines)
            What told variances are to be multiplied by from what has been learnt, pure numbers.
        """
        return np.asarray(self.due & (factor > MISJUDGED * self.believed).any(axis=-1))

    def after(self, measurement: TmaMeasurement) -> Beginning | None:
        """Return the beginning with one more measurement; None = nothing will be compared."""
        enough = (len(self.measurements) - self.first >= CHECKED_AFTER[-1]).all()
        # Hypotheses are those of the sides of the first azimuth.
        if enough or any(_sides(one) != _sides(measurement) for one in self.measurements[:1]):
            return None
        return replace(self, measurements=(*self.measurements, measurement))

    def restarted(self, which: BoolArray, factor: FloatArray) -> Beginning:
        """Return the beginning where some runs begin with the next measurement.

        Parameters
        ----------
        which : ndarray of bool, shape (...)
            These runs.
        factor : ndarray, shape (..., 1 + n_lines)
            What told variances will be multiplied by, pure numbers.
        """
        first = np.where(which, len(self.measurements), self.first)
        return replace(
            self, first=first, believed=np.where(which[..., None], factor, self.believed)
        )

    def with_lines(self, n_lines: int, freed: tuple[int, ...]) -> Beginning:
        """Return the beginning of a single run with more lines, and without those freed.

        Parameters
        ----------
        n_lines : int
            Lines there shall be, not fewer than there are.
        freed : tuple of int
            Lines to forget.
        """
        believed = np.ones(1 + n_lines)
        believed[: self.believed.size] = self.believed
        believed[[1 + line for line in freed]] = 1.0
        padded = tuple(_with_lines(one, n_lines, list(freed)) for one in self.measurements)
        return replace(self, measurements=padded, believed=believed)


def nothing_measured(batch: tuple[int, ...], n_lines: int) -> Beginning:
    """Return the beginning of runs before the first measurement."""
    return Beginning((), np.zeros(batch, dtype=np.int64), np.ones((*batch, 1 + n_lines)))


def _sides(measurement: TmaMeasurement) -> int:
    return measurement.azimuth.shape[-1]


def _with_lines(measurement: TmaMeasurement, n_lines: int, freed: list[int]) -> TmaMeasurement:
    """Return a measurement of a single run with more columns, those freed without values."""
    frequency, deviation = np.full((2, n_lines), np.nan)
    frequency[: measurement.n_lines] = measurement.frequency
    deviation[: measurement.n_lines] = measurement.frequency_deviation
    frequency[freed] = np.nan
    return replace(measurement, frequency=frequency, frequency_deviation=deviation)
