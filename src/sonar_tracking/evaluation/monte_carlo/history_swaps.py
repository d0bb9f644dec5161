"""Identity swaps of runs that are kept as arrays of bearings, by the definition of all scores."""

from __future__ import annotations

import numpy as np

from sonar_tracking.evaluation.metrics.bearing_score import CUTOFF_DEG, ORDER
from sonar_tracking.evaluation.metrics.identity_score import LOST_PERIODS
from sonar_tracking.evaluation.metrics.ospa_gospa import assign
from sonar_tracking.records.arrays import FloatArray, IndexArray

NONE = -1
"""In place of a track where a target has none."""


def lasting_swaps(angle: FloatArray, truth: FloatArray) -> FloatArray:
    """Count the lasting identity swaps of each run, of all runs at once.

    Parameters
    ----------
    angle : ndarray, shape (..., n_steps, n_tracks)
        Filtered bearings, rad; NaN where there was no track.
    truth : ndarray, shape (n_steps, n_targets)
        True bearings, rad.

    Returns
    -------
    ndarray, shape (...)
        How often a target's assigned track changed for good.
    """
    held = _assigned(angle, truth)
    latest = np.full_like(held[..., 0, :], NONE)
    settled, periods = latest.copy(), np.zeros_like(latest)
    swaps = np.zeros(latest.shape)
    for step in range(len(truth)):
        track = held[..., step, :]
        here = track != NONE
        periods = np.where(here, np.where(track == latest, periods, 0) + 1, periods)
        latest = np.where(here, track, latest)
        stayed = here & (periods == LOST_PERIODS)
        swaps += stayed & (settled != NONE) & (settled != track)
        settled = np.where(stayed, track, settled)
    return np.sum(swaps, axis=-1)


def _assigned(angle: FloatArray, truth: FloatArray) -> IndexArray:
    """Return the track assigned to each target, shape (..., n_steps, n_targets)."""
    distances = np.degrees(np.abs(truth[:, :, None] - angle[..., None, :]))
    near = distances < CUTOFF_DEG
    held = np.where(near.any(axis=-1), near.argmax(axis=-1), NONE)
    contested = (near.sum(axis=-1) > 1).any(axis=-1) | (near.sum(axis=-2) > 1).any(axis=-1)
    for where in zip(*np.nonzero(contested), strict=True):
        tracks = np.flatnonzero(np.isfinite(angle[where]))
        pairs = assign(distances[where][:, tracks], CUTOFF_DEG, ORDER)
        held[where] = NONE
        held[where][pairs.truths] = tracks[pairs.estimates]
    return held
