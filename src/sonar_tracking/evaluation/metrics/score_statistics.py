"""Figures every score has: means over what there is, the period of track lists, flat JSON."""

from __future__ import annotations

import dataclasses
import math
from array import array
from collections.abc import Sequence
from typing import Any

import numpy as np

from sonar_tracking.records.arrays import BoolArray, FloatArray
from sonar_tracking.records.time import seconds

CHI_SQUARE_BAND = {
    2: (0.05063561596857975, 7.377758908227871),
    4: (0.4844185570879299, 11.143286781877796),
}
"""Quantiles 2.5 and 97.5 % of chi-square by degrees of freedom: ``scipy.stats``, which knows them
all, takes longer to load than a run of a few minutes takes to score."""


LISTS_AT_ONCE = 64
"""Whose errors are normalised together: few enough for the memory of a run without end."""


def nees_band(n_dimensions: int) -> tuple[float, float]:
    """Return the chi-square 95 % band of one normalised error squared, per dimension."""
    low, high = CHI_SQUARE_BAND[n_dimensions]
    return low / n_dimensions, high / n_dimensions


class Column:
    """Numbers of a run, eight bytes each: an hour of them takes a few hundred kilobytes."""

    def __init__(self) -> None:
        self._values = array("d")

    def add(self, values: FloatArray | BoolArray | Sequence[float]) -> None:
        """Add values, shape (n,), in the unit of the column."""
        self._values.frombytes(np.asarray(values, float).tobytes())

    @property
    def values(self) -> FloatArray:
        """All of them, shape (n,), in the unit of the column."""
        return np.array(self._values)


class NormalisedErrors:
    """Normalised square errors; those of several lists are computed at once, which costs less."""

    def __init__(self) -> None:
        self._squares = Column()
        self._waiting: list[tuple[FloatArray, FloatArray]] = []

    def add(self, error: FloatArray, covariance: FloatArray) -> None:
        """Add errors, shape (n, n_dimensions), and covariances, (n, n_dimensions, n_dimensions).

        In any units, as :func:`normalised_square_error` takes them.
        """
        self._waiting.append((error, covariance))
        if len(self._waiting) == LISTS_AT_ONCE:
            self._compute()

    @property
    def values(self) -> FloatArray:
        """All of them whose covariance is proper, shape (n,), pure numbers."""
        self._compute()
        return self._squares.values

    def _compute(self) -> None:
        if self._waiting:
            columns = map(np.concatenate, zip(*self._waiting, strict=True))
            self._squares.add(normalised_square_error(*columns))
            self._waiting.clear()


class Periods:
    """Stamps of track lists, to tell the time between them."""

    def __init__(self) -> None:
        self._stamps = array("q")

    def add(self, stamp: int) -> None:
        """Add the stamp of a list, ns."""
        self._stamps.append(stamp)

    def __len__(self) -> int:
        return len(self._stamps)

    def median(self) -> float:
        """Return the median time between lists in order of time, s; 0 for fewer than two."""
        if len(self._stamps) < 2:
            return 0.0
        return seconds(float(np.median(np.diff(sorted(self._stamps)))))


def mean(values: FloatArray | Sequence[float]) -> float:
    """Return the mean of values, shape (n,), in their unit; NaN where there is none."""
    return float(np.mean(values)) if len(values) else math.nan


def median(values: FloatArray | Sequence[float]) -> float:
    """Return the median of values, shape (n,), in their unit; NaN where there is none."""
    return float(np.median(values)) if len(values) else math.nan


def normalised_square_error(error: FloatArray, covariance: FloatArray) -> FloatArray:
    """Return e^T P^-1 e of the errors whose covariance is proper.

    Parameters
    ----------
    error : ndarray, shape (n, n_dimensions)
        Estimate minus truth, in any units.
    covariance : ndarray, shape (n, n_dimensions, n_dimensions)
        As the tracker gives it, in the same units squared; a row that is not positive
        definite, or not finite, is left out.

    Returns
    -------
    ndarray, shape (n_proper,)
        Pure numbers.
    """
    finite = np.all(np.isfinite(covariance), axis=(-2, -1)) & np.all(np.isfinite(error), axis=-1)
    error, covariance = error[finite], covariance[finite]
    # Scaled to unit variances first: metres and metres per second differ by orders.
    scale = np.sqrt(np.maximum(np.diagonal(covariance, axis1=-2, axis2=-1), 0.0))
    positive = np.all(scale > 0.0, axis=-1)
    error, covariance, scale = error[positive], covariance[positive], scale[positive]
    error = error / scale
    covariance = covariance / (scale[:, :, None] * scale[:, None, :])
    proper = np.linalg.eigvalsh(covariance)[:, 0] > 1e-12
    error, covariance = error[proper], covariance[proper]
    return np.sum(error * np.linalg.solve(covariance, error[..., None])[..., 0], axis=-1)


def flat_mapping(score: Any) -> dict[str, object]:
    """Return a score with its identities as one flat mapping for JSON; unknown is None."""
    values = dataclasses.asdict(score)
    values.update(values.pop("identities"))
    return {name: _json_value(value) for name, value in values.items()}


def _json_value(value: object) -> object:
    if isinstance(value, tuple):
        return [_json_value(entry) for entry in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
