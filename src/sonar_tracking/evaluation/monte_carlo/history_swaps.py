"""Identity swaps of runs that are kept as arrays of bearings, by the definition of all scores."""

from __future__ import annotations

import numpy as np

from sonar_tracking.evaluation.metrics.bearing_score import CUTOFF_DEG, ORDER
from sonar_tracking.evaluation.metrics.identity_score import ScoredPeriod, score_identities
from sonar_tracking.evaluation.metrics.ospa_gospa import assign
from sonar_tracking.records.arrays import FloatArray


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
    swaps = np.empty(angle.shape[:-2])
    for run in np.ndindex(swaps.shape):
        periods = [
            _scored_period(step, bearings, truth[step]) for step, bearings in enumerate(angle[run])
        ]
        first_seen = dict.fromkeys(range(truth.shape[1]), 0)
        swaps[run] = score_identities(periods, 1.0, first_seen).lasting_identity_swaps
    return swaps


def _scored_period(step: int, bearings: FloatArray, truth: FloatArray) -> ScoredPeriod:
    tracks = np.flatnonzero(np.isfinite(bearings))
    distances = np.degrees(np.abs(truth[:, None] - bearings[tracks]))
    assignment = assign(distances, CUTOFF_DEG, ORDER)
    pairs = zip(assignment.truths, assignment.estimates, strict=True)
    return ScoredPeriod(
        stamp=step,
        truth_ids=tuple(range(len(truth))),
        track_ids=tuple(int(track) for track in tracks),
        held={int(target): int(tracks[column]) for target, column in pairs},
        near=frozenset(),
    )
