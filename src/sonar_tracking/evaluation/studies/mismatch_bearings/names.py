"""Names of targets: whether they are the same after an encounter as before, and how they err.

Where bearings cross, the track nearest to a target may be that of the other one for a moment. So a
target keeps its track for as long as it is within the cut-off, and the errors are those of the
track that has its name.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.evaluation.metrics.bearing_score import CUTOFF_DEG, ORDER
from sonar_tracking.evaluation.metrics.bearing_truth import BearingTruth
from sonar_tracking.evaluation.metrics.ospa_gospa import assign
from sonar_tracking.evaluation.metrics.score_statistics import normalised_square_error
from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import BearingTracks
from sonar_tracking.simulation.scenarios.scenario import Scenario

Interval = tuple[float, float]
"""From, to, s."""


@dataclass(frozen=True)
class NamedErrors:
    """Errors of the tracks that have the names of targets.

    Attributes
    ----------
    error : ndarray, shape (n, 2)
        Of angle and rate, rad and rad/s; of all targets at all times.
    covariance : ndarray, shape (n, 2, 2)
        What the tracks say of it, rad^2, rad^2/s and rad^2/s^2.
    """

    error: FloatArray
    covariance: FloatArray

    def nees(self) -> FloatArray:
        """Return the normalised estimation errors squared, shape (n,), pure numbers."""
        return normalised_square_error(self.error, self.covariance)


def errors_under_names(truth: BearingTruth, tracks: Sequence[BearingTracks]) -> NamedErrors:
    """Return the errors of the tracks that have the names of targets.

    Parameters
    ----------
    truth : BearingTruth
        True bearings.
    tracks : sequence of BearingTracks
        The lists of a tracker.
    """
    names: dict[int, int] = {}
    errors, covariances = [np.empty((0, 2))], [np.empty((0, 2, 2))]
    for entry in tracks:
        present = truth.at(entry.stamp)
        if present is None:
            continue
        rows = np.flatnonzero(entry.established)
        error = wrap_angle(entry.arrival_angle[rows] - present.angle[:, None])
        apart = np.asarray(np.degrees(np.abs(error)))
        # Whoever has a name that still fits keeps it, whatever is nearer.
        kept = np.array(
            [[names.get(int(one)) == int(name) for name in entry.id[rows]] for one in present.id],
            dtype=bool,
        ).reshape(apart.shape)
        # They have names from when there are tracks for all of them.
        fits = kept & (apart < CUTOFF_DEG) & (len(names) >= len(present.id))
        taken = fits.any(axis=1, keepdims=True) | fits.any(axis=0, keepdims=True)
        apart = np.where(fits, 0.0, np.where(taken, 10.0 * CUTOFF_DEG, apart))
        pairs = assign(apart, CUTOFF_DEG, ORDER)
        held = rows[pairs.estimates]
        if len(held) < len(present.id) and len(names) < len(present.id):
            names.clear()
        for target, row in zip(present.id[pairs.truths], held, strict=True):
            names[int(target)] = int(entry.id[row])
        rate = entry.arrival_angle_rate[held] - present.rate[pairs.truths]
        errors.append(np.stack([error[pairs.truths, pairs.estimates], rate], axis=-1))
        covariances.append(entry.covariance[held])
    return NamedErrors(np.concatenate(errors), np.concatenate(covariances))


def share_of_right_names(
    scenario: Scenario,
    truth: BearingTruth,
    tracks: Sequence[BearingTracks],
    intervals: tuple[Interval, Interval],
) -> float:
    """Return the share of the targets with the name they had before.

    Parameters
    ----------
    scenario : Scenario
        What was simulated.
    truth : BearingTruth
        True bearings.
    tracks : sequence of BearingTracks
        The lists of a tracker.
    intervals : tuple of two tuples of float
        Before and after; the name in an interval is the one that a target has longest.
    """
    before, after = (_names_in(scenario, truth, tracks, interval) for interval in intervals)
    return float(np.mean([before.get(one, 0) == after.get(one, -1) for one in _targets(scenario)]))


def _targets(scenario: Scenario) -> range:
    return range(1, len(scenario.targets) + 1)


def _names_in(
    scenario: Scenario,
    truth: BearingTruth,
    tracks: Sequence[BearingTracks],
    interval: Interval,
) -> dict[int, int]:
    """Return the name that each target has longest in an interval, by the number of the target."""
    first, last = (scenario.stamp(time) for time in interval)
    held: dict[int, Counter[int]] = {target: Counter() for target in _targets(scenario)}
    for entry in tracks:
        present = truth.at(entry.stamp) if first <= entry.stamp <= last else None
        if present is None:
            continue
        rows = np.flatnonzero(entry.established)
        error = wrap_angle(entry.arrival_angle[rows] - present.angle[:, None])
        assignment = assign(np.degrees(np.abs(error)), CUTOFF_DEG, ORDER)
        for row, column in zip(assignment.truths, assignment.estimates, strict=True):
            held[int(present.id[row])][int(entry.id[rows[column]])] += 1
    return {target: names.most_common(1)[0][0] for target, names in held.items() if names}
