"""Bounds of the work on a ping: how many contacts a gate may hold.

Where contacts are so many that they fill the gates of thousands of candidates, the number of pairs
grows with their square. The nearest contacts of a gate then stand for all: which of a crowd is the
target's cannot be known, and a track in a crowd is none for long.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.records.arrays import BoolArray, FloatArray, IndexArray

CONTACTS_IN_GATE = (64, 32, 16, 8, 4)
"""Largest number in a gate: the first one with which all pairs are few enough, else the last."""

MAXIMUM_PAIRS = 110_000
MAXIMUM_BOXED = 10_000_000
"""Contacts in boxes around gates; beyond it only those in the middle of a box are looked at."""


def half_widths(counts: IndexArray, confirmed: BoolArray) -> IndexArray:
    """Return how many contacts to either side of the middle of each box are looked at.

    Parameters
    ----------
    counts : ndarray of int, shape (n_tracks,)
        Contacts in the boxes.
    confirmed : ndarray of bool, shape (n_tracks,)
        Boxes of confirmed tracks are looked at as a whole.

    Returns
    -------
    ndarray of int, shape (n_tracks,)
        Counts.
    """
    if counts.sum() <= MAXIMUM_BOXED:
        return counts
    each = MAXIMUM_BOXED // (2 * len(counts))
    return np.where(confirmed, counts, np.maximum(each, CONTACTS_IN_GATE[0]))


def nearest_in_gates(
    track: IndexArray, square: FloatArray, limits: IndexArray | int = CONTACTS_IN_GATE[0]
) -> BoolArray:
    """Return which pairs are among the nearest of their gate.

    Parameters
    ----------
    track : ndarray of int, shape (n_pairs,)
        Row of the track, ascending.
    square : ndarray, shape (n_pairs,)
        Squared distance of the contact from the centre of the gate, pure numbers
        (variances).
    limits : int or ndarray of int, shape (n_tracks,)
        Largest number of each gate.

    Returns
    -------
    ndarray of bool, shape (n_pairs,)
        True = among the nearest.
    """
    counts = np.bincount(track)
    largest = np.broadcast_to(limits, max(len(counts), np.size(limits)))[: len(counts)]
    kept = np.ones(len(track), dtype=bool)
    ends = np.cumsum(counts)
    crowded = np.flatnonzero(counts > largest)
    rows = (column[crowded].tolist() for column in (ends - counts, ends, largest))
    for begin, end, most in zip(*rows, strict=True):
        kept[begin + np.argsort(square[begin:end], kind="stable")[most:]] = False
    return kept


def few_enough(track: IndexArray, square: FloatArray, confirmed: BoolArray) -> BoolArray:
    """Return which pairs are kept so that there are not too many of all gates together.

    Parameters
    ----------
    track : ndarray of int, shape (n_pairs,)
        Row of the track, ascending.
    square : ndarray, shape (n_pairs,)
        Squared distance of the contact from the centre of the gate, pure numbers (variances).
    confirmed : ndarray of bool, shape (n_tracks,)
        Gates of confirmed tracks keep the largest number whatever the others do.

    Returns
    -------
    ndarray of bool, shape (n_pairs,)
        True = kept.
    """
    if len(track) <= MAXIMUM_PAIRS:
        return np.ones(len(track), dtype=bool)
    counts = np.bincount(track, minlength=len(confirmed))
    for limit in CONTACTS_IN_GATE:
        limits = np.where(confirmed, CONTACTS_IN_GATE[0], limit)
        if np.sum(np.minimum(counts, limits)) <= MAXIMUM_PAIRS:
            break
    return nearest_in_gates(track, square, limits)
