"""Runs under one condition: the same sounds for both chains, and their scores."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.errors import Notice, Severity
from sonar_tracking.evaluation.metrics.bearing_truth import BearingTruth
from sonar_tracking.evaluation.metrics.identity_score import (
    IdentityScore,
    IdentityTally,
    ScoredPeriod,
)
from sonar_tracking.evaluation.metrics.score_statistics import mean
from sonar_tracking.evaluation.monte_carlo.run_synthesis import block_truth, true_bearings
from sonar_tracking.evaluation.studies.mismatch_bearings.condition import Condition, Seeds
from sonar_tracking.evaluation.studies.mismatch_bearings.conditions import CONDITIONS
from sonar_tracking.evaluation.studies.mismatch_bearings.matched_periods import (
    MatchedRun,
    matched_run,
)
from sonar_tracking.evaluation.studies.mismatch_bearings.names import (
    errors_under_names,
    share_of_right_names,
)
from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    BearingTrackerConfiguration,
)
from sonar_tracking.passive.bearings.bearing_tracker_stage import (
    BearingTrackerStage,
    TrackerUpdate,
)
from sonar_tracking.passive.bearings.bearing_tracker_stage import update_together as tracks_together
from sonar_tracking.passive.subspaces.subspace_stage import SubspaceStage, SubspaceUpdate
from sonar_tracking.passive.subspaces.subspace_stage import update_together as subspaces_together
from sonar_tracking.passive.subspaces.unfollowed_subspace import UnfollowedSubspace
from sonar_tracking.records.bearings import ArraySnapshots, BearingTracks
from sonar_tracking.records.time import seconds

DEFAULTS = "defaults"
TOLD = "told the truth"
WITHOUT = "defaults, no track-before-detect"

STARTING = ("start_s", "within_20_s_percent", "within_60_s_percent", "false_per_hour")
"""Figures of the start of a faint source."""

_NEAR_DEG = 5.0
_HOUR = 3600.0

TOLD_ANGLE_VARIANCE_DEG2, TOLD_RATE_VARIANCE_DEG2 = 0.25, 0.01
"""Of the first bearings that a tracker is told."""


@dataclass(frozen=True)
class MismatchTask:
    """Runs that are tracked together.

    Attributes
    ----------
    condition : str
        Name of the condition.
    seeds : tuple of numpy.random.SeedSequence
        One a run.
    """

    condition: str
    seeds: tuple[np.random.SeedSequence, ...]


@dataclass(frozen=True)
class MismatchRun:
    """What both chains did in one run.

    Attributes
    ----------
    condition : str
        Name of the condition.
    metrics : mapping of str to mapping of str to float
        Figures of each chain; NaN = there is none.
    """

    condition: str
    metrics: Mapping[str, Mapping[str, float]]


@dataclass(frozen=True)
class ChainRun:
    """What a chain gave in one run.

    Attributes
    ----------
    tracks : list of BearingTracks
        One a period.
    notices : list of Notice
        All of them.
    """

    tracks: list[BearingTracks]
    notices: list[Notice]


def mismatch_runs(task: MismatchTask) -> tuple[MismatchRun, ...]:
    """Simulate runs and track them with the defaults and with what is true."""
    return runs_under(CONDITIONS[task.condition], task.seeds)


def runs_under(
    condition: Condition, seeds: Seeds, compared: bool = True
) -> tuple[MismatchRun, ...]:
    """Simulate runs under a condition and track them with the defaults and with what is true.

    Parameters
    ----------
    condition : Condition
        The condition.
    seeds : sequence of SeedSequence
        One a run.
    compared : bool, optional
        Whether they are tracked with more than the defaults.
    """
    arrays = [
        condition.errors.draw(
            condition.scenario.array.n_elements, np.random.default_rng(seed.generate_state(4))
        )
        for seed in seeds
    ]
    other = WITHOUT if condition.faint else TOLD
    systems = (DEFAULTS, other) if compared else (DEFAULTS,)
    by_default, *beside = (_Chains(condition, name, len(seeds)) for name in systems)
    for block in condition.blocks(seeds):
        told_noise = block.noise_covariance if condition.published else None
        wrong = [
            replace(block, data=array.received(data), noise_covariance=told_noise)
            for array, data in zip(arrays, block.data, strict=True)
        ]
        updates = by_default.take(wrong)
        for chains in beside:
            if condition.faint:
                # Both trackers see the same estimates.
                chains.follow(updates)
            else:
                chains.take([replace(block, data=data) for data in block.data])
    truth = BearingTruth(block_truth(condition.scenario))
    runs = []
    for number, array in enumerate(arrays):
        metrics = {DEFAULTS: figures(condition, truth, by_default.runs[number], array.faulty)}
        for chains in beside:
            metrics[other] = figures(condition, truth, chains.runs[number], ())
        runs.append(MismatchRun(condition.name, metrics))
    return tuple(runs)


class _Chains:
    """The chains of several runs, by their name: with the defaults, told the truth, or without."""

    def __init__(self, condition: Condition, name: str, n_runs: int) -> None:
        self._condition = condition
        self._name = name
        self._told = name == TOLD and bool(condition.scenario.targets)
        estimator = condition.estimator
        if self._told:
            estimator = replace(estimator, source_count=len(condition.scenario.targets))
        self._estimators = [SubspaceStage(estimator, UnfollowedSubspace()) for _ in range(n_runs)]
        self._trackers: list[BearingTrackerStage] = []
        self.runs = tuple(ChainRun([], []) for _ in range(n_runs))

    def take(self, blocks: Sequence[ArraySnapshots]) -> Sequence[SubspaceUpdate]:
        """Take a block of each run, and return what the estimators make of them."""
        updates = subspaces_together(self._estimators, blocks)
        self.follow(updates)
        return updates

    def follow(self, updates: Sequence[SubspaceUpdate]) -> None:
        """Let the trackers take what estimators have made of a block of each run."""
        self._tell(updates)
        for estimates in zip(*(update.estimates for update in updates), strict=True):
            if not self._trackers:
                self._trackers = list(self._new_trackers(estimates[0].stamp))
            tracked = tracks_together(self._trackers, estimates)
            self._tell(tracked)
            for run, update in zip(self.runs, tracked, strict=True):
                run.tracks.append(update.tracks)

    def _tell(self, updates: Sequence[SubspaceUpdate | TrackerUpdate]) -> None:
        for run, update in zip(self.runs, updates, strict=True):
            run.notices.extend(update.notices)

    def _new_trackers(self, stamp: int) -> Iterator[BearingTrackerStage]:
        configuration = BearingTrackerConfiguration(track_before_detect=self._name != WITHOUT)
        if self._told:
            configuration = told_configuration(self._condition, stamp)
        for _ in self.runs:
            yield BearingTrackerStage(configuration)


def told_configuration(condition: Condition, stamp: int) -> BearingTrackerConfiguration:
    """Return the parameters of the tracker that is told the truth.

    Parameters
    ----------
    condition : Condition
        The condition.
    stamp : int
        Of its first estimate, ns.
    """
    time = seconds(stamp - condition.scenario.stamp(0.0))
    angles, rates = true_bearings(condition.scenario, np.array([time]))
    return BearingTrackerConfiguration(
        source_rank=condition.source_rank,
        start="given",
        initial_bearings_deg=tuple(np.degrees(angles[0]).tolist()),
        initial_rates_deg=tuple(np.degrees(rates[0]).tolist()),
        initial_angle_variance_deg2=TOLD_ANGLE_VARIANCE_DEG2,
        initial_rate_variance_deg2=TOLD_RATE_VARIANCE_DEG2,
        process_noise_deg2=condition.told_process_noise_deg2,
        steady_process_noise_deg2=condition.told_process_noise_deg2,
    )


def figures(
    condition: Condition, truth: BearingTruth, run: ChainRun, faulty: Sequence[int]
) -> dict[str, float]:
    """Return the figures of one chain in one run.

    Parameters
    ----------
    condition : Condition
        Of the run.
    truth : BearingTruth
        True bearings.
    run : ChainRun
        What the chain gave.
    faulty : sequence of int
        Elements whose channels are exchanged or inverted.
    """
    matched = matched_run(truth, run.tracks)
    identities = _identities(condition, truth, matched)
    errors = errors_under_names(matched)
    false = float(identities.false_tracks)
    texts = [notice.text for notice in run.notices if notice.severity != Severity.OK]
    metrics = {
        "mse_deg2": float(np.degrees(1.0) ** 2 * mean(errors.error[:, 0] ** 2)),
        "nees_per_dimension": 0.5 * mean(errors.nees()),
        "count_right_percent": 100.0 * mean(matched.count_right.astype(np.float64)),
        "swaps": float(identities.lasting_identity_swaps),
        "false_tracks": false,
        "silent_false_percent": 100.0 * (false > 0.0 and not texts),
        "clipped_notices": float(sum("clipped" in text for text in texts)),
        "right_names_percent": np.nan,
        "named_percent": np.nan,
        **dict.fromkeys(STARTING, np.nan),
    }
    if condition.faint:
        metrics |= _start(condition, matched)
        metrics["false_per_hour"] = false * _HOUR / condition.scenario.duration
    if condition.names_after[1] > 0.0:
        metrics["right_names_percent"] = 100.0 * share_of_right_names(
            condition.scenario, matched, (condition.names_before, condition.names_after)
        )
    if faulty:
        metrics["named_percent"] = 100.0 * any(_names(text, faulty) for text in texts)
    return metrics


def _identities(condition: Condition, truth: BearingTruth, matched: MatchedRun) -> IdentityScore:
    """Return how well the tracks have kept their identities."""
    tally = IdentityTally()
    for period in matched.periods:
        held = {period.targets[target]: period.tracks[track] for target, track in period.pairs}
        tally.add(ScoredPeriod(period.stamp, period.targets, period.tracks, held, period.near))
    return tally.score(condition.estimator.period, truth.first_seen())


def _start(condition: Condition, matched: MatchedRun) -> dict[str, float]:
    """Return when the source has a track first, s, and whether within 20 s and 60 s, percent."""
    if not condition.scenario.targets:
        return {}
    stamps = (
        period.stamp
        for period in matched.periods
        if any(apart[0] < _NEAR_DEG for apart in period.apart)
    )
    stamp = next(stamps, None)
    first = np.inf if stamp is None else seconds(stamp - condition.scenario.stamp(0.0))
    return {
        "start_s": first,
        "within_20_s_percent": 100.0 * (first <= 20.0),
        "within_60_s_percent": 100.0 * (first <= 60.0),
    }


def _names(text: str, elements: Sequence[int]) -> bool:
    """Return whether a sentence names exactly those elements, which count from 0."""
    words = text.split(";")[0].split("(")[0].replace(",", " ").split()
    return {int(word) for word in words if word.isdigit()} == set(elements)
