"""Amplitudes that end in a plateau: what a converter at its limit makes of any sound.

The largest value of a sound occurs once. At full scale it occurs again and again, to the last bit,
and more often than all values just below it; in the real part, in the imaginary part, or in the
magnitude, by where the limit is. No sound has that by chance, however few snapshots are looked at.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.records.arrays import BoolArray, ComplexArray, FloatArray

_SAME = 1e-6
"""Values that differ by less than this share are the same."""

_BELOW = 0.9
"""Where the values just below the largest one begin."""

_LEAST_SHARE = 0.1
"""Of the snapshots at the limit."""


@dataclass(frozen=True)
class AmplitudePlateau:
    """How often each element is at its largest value, of real part, imaginary part and magnitude.

    Attributes
    ----------
    largest : ndarray, shape (3, n_elements)
        Largest value of late, linear amplitude.
    at_largest, below : ndarray, shape (3, n_elements)
        Share of the snapshots at it, and just below it, pure numbers.
    """

    largest: FloatArray
    at_largest: FloatArray
    below: FloatArray

    @property
    def found(self) -> BoolArray:
        """Elements whose values end in a plateau, shape (n_elements,)."""
        flat = (self.at_largest >= _LEAST_SHARE) & (self.at_largest >= self.below)
        return np.asarray((flat & (self.largest > 0.0)).any(axis=0))


def updated_plateaus(
    plateaus: Sequence[AmplitudePlateau], data: ComplexArray, share: float
) -> list[AmplitudePlateau]:
    """Return the plateaus of several runs after more snapshots.

    Parameters
    ----------
    plateaus : sequence of AmplitudePlateau
        One a run.
    data : ndarray, shape (n_runs, n_snapshots, n_elements), complex
        Linear amplitude.
    share : float
        Weight of these snapshots, 0 to 1.
    """
    n_runs, *shape = data.shape
    values = np.empty((n_runs, 3, *shape))
    np.abs(data.real, out=values[:, 0])
    np.abs(data.imag, out=values[:, 1])
    np.abs(data, out=values[:, 2])
    here = values.max(axis=-2)
    before = np.array([each.largest for each in plateaus])
    at_largest = np.array([each.at_largest for each in plateaus])
    below = np.array([each.below for each in plateaus])
    # A value that has not been reached again for long was no limit.
    forgotten = at_largest * data.shape[-2] < 0.5 * share
    larger = (here > (1.0 + _SAME) * before) | forgotten
    largest = np.where(larger, here, before)
    top = values >= (1.0 - _SAME) * largest[..., None, :]
    reached = values >= _BELOW * largest[..., None, :]
    kept = np.where(larger, 0.0, 1.0 - share)
    weight = np.where(larger, 1.0, share)
    n_top, n_reached = top.sum(axis=-2), reached.sum(axis=-2)
    at_largest = kept * at_largest + weight * (n_top / data.shape[-2])
    below = kept * below + weight * ((n_reached - n_top) / data.shape[-2])
    return [AmplitudePlateau(*own) for own in zip(largest, at_largest, below, strict=True)]


def no_plateau(n_elements: int) -> AmplitudePlateau:
    """Return the plateaus of elements of which nothing has been seen."""
    zero = np.zeros((3, n_elements))
    return AmplitudePlateau(zero, zero, zero)
