"""Identity swaps of runs that are kept as arrays of bearings, by the definition of all scores."""

from __future__ import annotations

import numpy as np

from sonar_tracking.evaluation.metrics.bearing_score import CUTOFF_DEG, ORDER
from sonar_tracking.evaluation.metrics.identity_score import ScoredPeriod, score_identities
from sonar_tracking.evaluation.metrics.ospa_gospa import assign
from sonar_tracking.records.arrays import FloatArray, IndexArray

NONE = -1
"""In place of a track where a target has none."""


def lasting_swaps(angle: FloatArray, truth: FloatArray) -> FloatArray:
    """Count the lasting identity swaps of each run.

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
    swaps = np.empty(angle.shape[:-2])
    first_seen = dict.fromkeys(range(truth.shape[1]), 0)
    for run in np.ndindex(swaps.shape):
        periods = [_scored_period(step, row) for step, row in enumerate(held[run].tolist())]
        swaps[run] = score_identities(periods, 1.0, first_seen).lasting_identity_swaps
    return swaps


def _scored_period(step: int, tracks: list[int]) -> ScoredPeriod:
    held = {target: track for target, track in enumerate(tracks) if track != NONE}
    return ScoredPeriod(
        stamp=step,
        truth_ids=tuple(range(len(tracks))),
        track_ids=tuple(held.values()),
        held=held,
        near=frozenset(),
    )


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
