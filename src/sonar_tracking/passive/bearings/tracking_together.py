"""Bearings of independent runs tracked in one go.

Small matrices cost more calls than arithmetic, so that runs that are alike are followed on arrays
with a dimension of runs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sonar_tracking.passive.bearings.alike_runs import (
    grouped,
    kind_of,
    kind_of_array,
    kind_of_estimates,
    rows_of,
    stacked,
    stacked_estimates,
)
from sonar_tracking.passive.bearings.followed_tracks import FollowedTracks
from sonar_tracking.passive.bearings.tracker_state import TrackerState
from sonar_tracking.passive.bearings.tracking_steps import TrackingSteps
from sonar_tracking.passive.sources.noise_of_windows import common_or_stacked
from sonar_tracking.passive.sources.weak_source_counting import counts_together
from sonar_tracking.passive.track_start.bearing_start import BearingStart
from sonar_tracking.records.bearings import SubspaceEstimates


def follow_together(
    steps: TrackingSteps,
    estimates: Sequence[SubspaceEstimates],
    before: Sequence[tuple[TrackerState, float | None]],
) -> list[FollowedTracks]:
    """Return the running tracks of several runs at their estimates, those alike in one go.

    Parameters
    ----------
    steps : TrackingSteps
        Of all runs.
    estimates : sequence of SubspaceEstimates
        One a run.
    before : sequence of (TrackerState, float or None)
        The state of each run before its estimate, and how long before, s; None = it is the first.
    """
    if len(estimates) == 1:
        return [steps.follow(estimates[0], *before[0])]
    kinds = [
        (
            interval,
            kind_of(state.filters),
            np.isfinite(state.excess).tobytes(),
            state.steering.looks_at(len(own.element_positions)),
            kind_of_estimates(own, steps.needs_covariance),
        )
        for own, (state, interval) in zip(estimates, before, strict=True)
    ]
    followed: dict[int, FollowedTracks] = {}
    for rows in grouped(kinds):
        state, interval = before[rows[0]]
        if len(rows) == 1:
            followed[rows[0]] = steps.follow(estimates[rows[0]], state, interval)
            continue
        states = [before[row][0] for row in rows]
        state = replace(
            state,
            filters=stacked([each.filters for each in states]),
            existence=stacked([each.existence for each in states]),
            excess=stacked([each.excess for each in states]),
        )
        together = stacked_estimates([estimates[row] for row in rows])
        all_of_them = steps.follow(together, state, interval)
        followed.update(zip(rows, rows_of(all_of_them, len(rows)), strict=True))
    return [followed[row] for row in range(len(estimates))]


def weak_sources(
    estimates: Sequence[SubspaceEstimates], starts: Sequence[BearingStart]
) -> list[int]:
    """Return how many sources the means of covariances show in each run at least.

    Parameters
    ----------
    estimates : sequence of SubspaceEstimates
        One a run.
    starts : sequence of BearingStart
        The automatic start of each, before its estimate.

    Returns
    -------
    list of int
        One a run; 0 = none, or not counted.
    """
    counters = [start.counting(own) for start, own in zip(starts, estimates, strict=True)]
    kinds = [
        None if counter is None else (counter.ages, kind_of_array(own))
        for counter, own in zip(counters, estimates, strict=True)
    ]
    weak = [0] * len(starts)
    for rows in grouped(kinds):
        together = [counter for row in rows if (counter := counters[row]) is not None]
        if together:
            first = rows[0]
            noise = common_or_stacked([estimates[row].noise_covariance for row in rows])
            alike = replace(estimates[first], noise_covariance=noise)
            counts = counts_together(together, alike, starts[first].maximum_rate)
            for row, count in zip(rows, counts.tolist(), strict=True):
                weak[row] = count
    return weak
