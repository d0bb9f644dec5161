"""Which rows of a list of echoes can be used: finite, with covariances that are some."""

from __future__ import annotations

import numpy as np

from sonar_tracking.errors import Notice, Severity, shown
from sonar_tracking.records.arrays import BoolArray, FloatArray
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import PositionTracks

ASYMMETRY = 1e-6
"""Of a covariance that is one, from rounding; relative to its entries."""


def are_covariances(matrices: FloatArray) -> BoolArray:
    """Return which matrices are symmetric, finite and positive definite.

    Parameters
    ----------
    matrices : ndarray, shape (n, d, d)
        In any units.

    Returns
    -------
    ndarray of bool, shape (n,)
        True = is one.
    """
    finite = np.all(np.isfinite(matrices), axis=(-2, -1))
    safe = np.where(finite[:, None, None], matrices, 0.0)
    mirrored = safe.swapaxes(-1, -2)
    symmetric = np.all(np.abs(safe - mirrored) <= ASYMMETRY * np.abs(mirrored), axis=(-2, -1))
    positive = np.linalg.eigvalsh(safe)[:, 0] > 0.0
    return np.asarray(finite & symmetric & positive)


def usable_states(tracks: PositionTracks) -> BoolArray:
    """Return which rows, shape (n,), tell a state and how well it is known."""
    finite = np.all(np.isfinite(tracks.state), axis=1)
    return np.asarray(finite & are_covariances(tracks.covariance))


def usable_measurements(tracks: PositionTracks) -> BoolArray:
    """Return which rows, shape (n,), tell what their last update measured."""
    finite = np.all(np.isfinite(tracks.measurement), axis=1)
    return np.asarray(finite & are_covariances(tracks.measurement_covariance))


def unusable_rows(tracks: PositionTracks, topic: str, usable: BoolArray) -> tuple[Notice, ...]:
    """Return the notices of a list: confirmed rows that cannot be used.

    Parameters
    ----------
    tracks : PositionTracks
        The list.
    topic : str
        Where it comes from.
    usable : ndarray of bool, shape (n,)
        Rows whose state can be used.
    """
    confirmed = tracks.status == TrackStatus.CONFIRMED
    told = ~np.all(np.isnan(tracks.measurement), axis=1)
    bad = confirmed & (~usable | (told & ~usable_measurements(tracks)))
    if not np.any(bad):
        return ()
    numbers = ", ".join(str(one) for one in tracks.id[bad][:3])
    text = (
        f"{shown(topic)}: track {numbers} has a state or a covariance that is not finite, not "
        "positive or impossibly small; it was left out, check the sender."
    )
    return (Notice(Severity.WARN, f"data of {shown(topic)}", text),)
