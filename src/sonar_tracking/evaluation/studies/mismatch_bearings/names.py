"""Names of targets: whether they are the same after an encounter as before, and how they err.

Where bearings cross, the track nearest to a target may be that of the other one for a moment. So a
target keeps its track for as long as it is within the cut-off, and the errors are those of the
track that has its name.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np

from sonar_tracking.evaluation.metrics.bearing_score import CUTOFF_DEG
from sonar_tracking.evaluation.metrics.score_statistics import normalised_square_error
from sonar_tracking.evaluation.studies.mismatch_bearings.matched_periods import (
    MatchedPeriod,
    MatchedRun,
    Pairs,
    assigned,
)
from sonar_tracking.records.arrays import FloatArray
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


def errors_under_names(run: MatchedRun) -> NamedErrors:
    """Return the errors of the tracks that have the names of targets.

    Parameters
    ----------
    run : MatchedRun
        The tracks beside the targets.
    """
    names: dict[int, int] = {}
    targets, rows = list[int](), list[int]()
    for period in run.periods:
        pairs, n_targets = _named_pairs(period, names), len(period.targets)
        if len(pairs) < n_targets and len(names) < n_targets:
            names.clear()
        for target, track in pairs:
            names[period.targets[target]] = period.tracks[track]
            targets.append(target)
            rows.append(period.first + track)
    places = np.array(rows, dtype=np.intp)
    return NamedErrors(run.error[places, np.array(targets, dtype=np.intp)], run.covariance[places])


def _named_pairs(period: MatchedPeriod, names: dict[int, int]) -> Pairs:
    """Return the pairs of a period: whoever has a name that still fits keeps it."""
    if len(names) < len(period.targets):
        # They have names from when there are tracks for all of them.
        return period.pairs
    fits = [
        (target, period.tracks.index(name))
        for target, each in enumerate(period.targets)
        if (name := names.get(each)) in period.tracks
    ]
    fits = [(target, track) for target, track in fits if period.apart[track][target] < CUTOFF_DEG]
    if not fits:
        return period.pairs
    taken = {target for target, _ in fits}, {track for _, track in fits}
    if len(fits) == len(period.targets) == len(taken[1]):
        return tuple(fits)
    kept = set(fits)
    return assigned(
        [
            [
                0.0
                if (target, track) in kept
                else 10.0 * CUTOFF_DEG
                if target in taken[0] or track in taken[1]
                else distance
                for target, distance in enumerate(distances)
            ]
            for track, distances in enumerate(period.apart)
        ]
    )


def share_of_right_names(
    scenario: Scenario, run: MatchedRun, intervals: tuple[Interval, Interval]
) -> float:
    """Return the share of the targets with the name they had before.

    Parameters
    ----------
    scenario : Scenario
        What was simulated.
    run : MatchedRun
        The tracks beside the targets.
    intervals : tuple of two tuples of float
        Before and after; the name in an interval is the one that a target has longest.
    """
    before, after = (_names_in(scenario, run, interval) for interval in intervals)
    return float(np.mean([before.get(one, 0) == after.get(one, -1) for one in _targets(scenario)]))


def _targets(scenario: Scenario) -> range:
    return range(1, len(scenario.targets) + 1)


def _names_in(scenario: Scenario, run: MatchedRun, interval: Interval) -> dict[int, int]:
    """Return the name that each target has longest in an interval, by the number of the target."""
    first, last = (scenario.stamp(time) for time in interval)
    held: dict[int, Counter[int]] = {target: Counter() for target in _targets(scenario)}
    for period in run.periods:
        if first <= period.stamp <= last:
            for target, track in period.pairs:
                held[period.targets[target]][period.tracks[track]] += 1
    return {target: names.most_common(1)[0][0] for target, names in held.items() if names}
