"""Time as it flows through the graph: stamps are integer nanoseconds, durations float seconds."""

from __future__ import annotations

import typing
from collections.abc import Collection

import numpy as np

from sonar_tracking.records.arrays import FloatArray, IntArray

NANOSECONDS = 1_000_000_000
"""In a second; stamps are counted in them."""

END_OF_DATA = 2_147_483_647 * NANOSECONDS
"""Watermark that says that no more data will follow, ns."""

LAST_STAMP = END_OF_DATA + NANOSECONDS - 1
"""The last instant that a time message can hold, ns."""

UNKNOWN_STAMP = 0
"""Watermark that says nothing, ns."""


@typing.overload
def seconds(stamp_difference: float) -> float: ...
@typing.overload
def seconds(stamp_difference: IntArray) -> FloatArray: ...
def seconds(stamp_difference: float | IntArray) -> float | FloatArray:
    """Return a difference of stamps as a duration.

    Parameters
    ----------
    stamp_difference : float or ndarray of int64, shape (...)
        ns. Subtract stamps before they become floats: a double holds an epoch to 0.2 us only.

    Returns
    -------
    float or ndarray, shape (...)
        s.
    """
    if isinstance(stamp_difference, np.ndarray):
        return np.multiply(stamp_difference, 1e-9)
    return stamp_difference * 1e-9


def common_watermark(watermarks: Collection[int], n_sources: int, stamp: int) -> int:
    """Return before when nothing follows of several sources, ns; unknown until all have told.

    Parameters
    ----------
    watermarks : collection of int
        Of the sources that have told any, ns.
    n_sources : int
        How many there are.
    stamp : int
        Of the latest data, ns; a watermark that is not later says nothing.
    """
    least = min(watermarks, default=UNKNOWN_STAMP)
    return least if len(watermarks) >= n_sources and least > stamp else UNKNOWN_STAMP


def nanoseconds(duration: float) -> int:
    """Return a duration in s as a difference of stamps, ns, rounded to the nearest."""
    return round(duration * 1e9)
