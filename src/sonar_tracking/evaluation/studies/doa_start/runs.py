"""Runs of the doa-start study: the whole passive chain, given nothing, on targets that come and go.

The scenario ``appearing_targets`` with other levels and arrays; each run has its own seed. The
stages are those that the nodes run.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from sonar_tracking.errors import Notice
from sonar_tracking.evaluation.metrics.bearing_score import BearingScore, OnlineBearingScore
from sonar_tracking.evaluation.metrics.bearing_truth import BearingTruth
from sonar_tracking.evaluation.monte_carlo.batch_runner import RunBatch
from sonar_tracking.evaluation.monte_carlo.run_synthesis import block_truth, long_blocks
from sonar_tracking.evaluation.offline.offline_bearing_chain import OfflineRun, bearing_stages
from sonar_tracking.passive.bearings.bearing_tracker_stage import TrackerUpdate
from sonar_tracking.passive.bearings.bearing_tracker_stage import update_together as tracks_together
from sonar_tracking.passive.subspaces.subspace_stage import SubspaceUpdate
from sonar_tracking.passive.subspaces.subspace_stage import update_together as subspaces_together
from sonar_tracking.passive.subspaces.unfollowed_subspace import UnfollowedSubspace
from sonar_tracking.records.bearings import BearingTracks, TrackStatus
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario

LEVELS_DB = (0.0, -3.0, -5.0, -8.0)
ELEMENTS = (15, 32, 64)

BLOCK_SNAPSHOTS = 1000
"""Fifty times as many as in a block of the scenario, and few enough for the memory of all runs."""


@dataclass(frozen=True)
class StartCondition:
    """Array and level of all targets.

    Attributes
    ----------
    n_elements : int
        At half a wavelength.
    level_db : float
        Signal over noise per element, dB.
    """

    n_elements: int
    level_db: float

    @property
    def name(self) -> str:
        """Name in the tables."""
        return f"{self.n_elements} elements, {self.level_db:g} dB"

    def scenario(self, seed: int) -> Scenario:
        """Return the scenario of a run."""
        scenario = load_scenario("appearing_targets")
        targets = tuple(replace(target, level_db=self.level_db) for target in scenario.targets)
        array = replace(scenario.array, n_elements=self.n_elements)
        return replace(scenario, array=array, targets=targets, seed=seed)


CONDITIONS = tuple(
    StartCondition(n_elements, level_db) for n_elements in ELEMENTS for level_db in LEVELS_DB
)


@dataclass(frozen=True)
class StartBatch:
    """Runs that are computed together.

    Attributes
    ----------
    condition : StartCondition
        The condition.
    batch : RunBatch
        Which runs.
    """

    condition: StartCondition
    batch: RunBatch


@dataclass(frozen=True)
class StartRun:
    """What the chain did in one run.

    Attributes
    ----------
    score : BearingScore
        Of confirmed and coasted tracks.
    count_error : float
        Mean over the periods of the difference between the number of confirmed tracks and that of
        targets, without its sign.
    count_right : float
        Share of the periods without such a difference.
    """

    score: BearingScore
    count_error: float
    count_right: float


@dataclass(frozen=True)
class StartRuns:
    """What the chain did in the runs of a batch.

    Attributes
    ----------
    condition : StartCondition
        The condition.
    runs : tuple of StartRun
        One a run.
    example : tuple of tuple of BearingTracks, or None
        True bearings and tracks of the first run of the study, for the figure.
    """

    condition: StartCondition
    runs: tuple[StartRun, ...]
    example: tuple[tuple[BearingTracks, ...], tuple[BearingTracks, ...]] | None


def start_batch(task: StartBatch) -> StartRuns:
    """Run the passive chain on the runs of a batch under one condition.

    Parameters
    ----------
    task : StartBatch
        Which runs, under which condition.
    """
    chains = start_chains(
        task.condition, [int(seed.generate_state(1)[0]) for seed in task.batch.seeds]
    )
    truth = BearingTruth(chains[0].truth)
    runs = tuple(_scored(chain.tracks, truth) for chain in chains)
    example = (chains[0].truth, chains[0].tracks) if task.batch.first_run == 0 else None
    return StartRuns(task.condition, runs, example)


def start_chains(condition: StartCondition, seeds: Sequence[int]) -> tuple[OfflineRun, ...]:
    """Return what the chain gives with each of several seeds: that of the offline chain.

    Only the blocks are longer, since a block costs much and gives the same, what all runs have in
    common is made once, and the subspaces, in which this tracker takes no bearings, are left out.

    Parameters
    ----------
    condition : StartCondition
        The condition.
    seeds : sequence of int
        Of the scenario, one a run.
    """
    scenario = condition.scenario(0)
    stages = [bearing_stages(scenario, UnfollowedSubspace()) for _ in seeds]
    estimators, trackers = zip(*stages, strict=True)
    tracks: list[list[BearingTracks]] = [[] for _ in seeds]
    notices: list[list[Notice]] = [[] for _ in seeds]
    for block in long_blocks(scenario, seeds, BLOCK_SNAPSHOTS):
        blocks = [replace(block, data=data) for data in block.data]
        subspaces = subspaces_together(estimators, blocks)
        _add(notices, subspaces)
        for estimates in zip(*(update.estimates for update in subspaces), strict=True):
            updates = tracks_together(trackers, estimates)
            _add(notices, updates)
            for own, update in zip(tracks, updates, strict=True):
                own.append(update.tracks)
    truth = _truth(condition)
    return tuple(
        OfflineRun(truth, tuple(own), tuple(told))
        for own, told in zip(tracks, notices, strict=True)
    )


def _add(notices: list[list[Notice]], updates: Sequence[SubspaceUpdate | TrackerUpdate]) -> None:
    for told, update in zip(notices, updates, strict=True):
        told.extend(update.notices)


@lru_cache(maxsize=len(CONDITIONS))
def _truth(condition: StartCondition) -> tuple[BearingTracks, ...]:
    return block_truth(condition.scenario(0))


def count_differences(truth: BearingTruth, tracks: Sequence[BearingTracks]) -> tuple[int, ...]:
    """Return in each period the number of confirmed tracks minus that of targets."""
    differences = []
    for entry in tracks:
        present = truth.at(entry.stamp)
        if present is not None:
            confirmed = np.count_nonzero(entry.status == TrackStatus.CONFIRMED)
            differences.append(int(confirmed) - len(present.id))
    return tuple(differences)


def _scored(tracks: Sequence[BearingTracks], truth: BearingTruth) -> StartRun:
    differences = np.array(count_differences(truth, tracks))
    online = OnlineBearingScore(truth)
    online.add_all(tracks)
    return StartRun(
        online.score(), float(np.abs(differences).mean()), float((differences == 0).mean())
    )
