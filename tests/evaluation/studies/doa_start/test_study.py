"""Protects: the chain given nothing finds, follows and drops targets that come and go."""

from __future__ import annotations

import pickle
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.evaluation.metrics.bearing_truth import BearingTruth
from sonar_tracking.evaluation.monte_carlo.batch_runner import RunBatch
from sonar_tracking.evaluation.offline.offline_bearing_chain import run_offline_chain
from sonar_tracking.evaluation.studies.doa_start.runs import (
    CONDITIONS,
    StartBatch,
    StartCondition,
    StartRuns,
    count_differences,
    start_batch,
    start_chains,
)
from sonar_tracking.evaluation.studies.doa_start.study import SYSTEM, draw, rows, tasks
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.simulation.scenarios.scenario import Scenario

CONDITION = StartCondition(15, 0.0)


@pytest.fixture(scope="module")
def result() -> StartRuns:
    seeds = tuple(np.random.SeedSequence(1).spawn(2))
    return start_batch(StartBatch(CONDITION, RunBatch(0, seeds)))


def test_tasks_cover_every_array_and_level() -> None:
    planned = tasks(3, 1)
    assert {task.argument.condition for task in planned} == set(CONDITIONS)
    assert len(CONDITIONS) == 12


def test_every_target_is_found_soon_and_nothing_else(result: StartRuns) -> None:
    (row,) = rows([result])
    assert (row.system, row.condition) == (SYSTEM, CONDITION.name)
    metrics = row.metrics
    assert metrics["targets_never_held"] == 0.0
    assert metrics["false_tracks_per_hour"] == 0.0
    assert metrics["lasting_swaps"] == 0.0
    assert metrics["name_kept_percent"] > 96.0
    assert metrics["confirmation_delay_s"] < 3.0
    assert metrics["count_error"] < 0.3
    assert metrics["rmse_deg"] < 0.5


def test_identifiers_are_never_reused(result: StartRuns) -> None:
    assert result.example is not None
    _, tracks = result.example
    ended: set[int] = set()
    for entry in tracks:
        assert not ended & set(entry.id.tolist())
        ended |= set(entry.id[entry.status == TrackStatus.TERMINATED].tolist())
    assert len(ended) == 2


def test_count_differences_tell_tracks_from_targets(result: StartRuns) -> None:
    assert result.example is not None
    truth, tracks = result.example
    without = [replace(entry, status=np.zeros_like(entry.status)) for entry in tracks]
    differences = count_differences(BearingTruth(truth), without)
    assert min(differences) == -5
    assert max(differences) == -3


def test_figure_of_each_array(result: StartRuns, tmp_path: Path) -> None:
    later = replace(result, example=None)  # of a task that has not the first run
    part = replace(result, condition=replace(CONDITION, n_elements=32))
    other = replace(result, condition=replace(CONDITION, n_elements=64))
    results = [result, later, part, other]
    pictures = draw(results, rows(results), tmp_path)
    assert all(path.stat().st_size > 1000 for path in pictures)
    assert len(pictures) == 3


class Short(StartCondition):
    """The first part of the scene, in which there are targets already."""

    def scenario(self, seed: int) -> Scenario:
        return replace(super().scenario(seed), duration=25.0)


@pytest.mark.parametrize(
    "condition", [Short(15, 0.0), pytest.param(Short(64, -8.0), marks=pytest.mark.slow)]
)
def test_long_blocks_of_many_runs_give_what_each_run_gives_by_itself(
    condition: StartCondition,
) -> None:
    """Bit for bit: tracks, truth and score are those of the offline chain.

    Of 64 elements the rank is not estimated: what was counted at the start stands for it.
    """
    chains = start_chains(condition, [5, 6])
    alone = run_offline_chain(condition.scenario(6))
    assert len(chains[1].tracks) == len(alone.tracks)
    assert len(chains[1].truth) == len(alone.truth)
    for one, other in zip(
        (*chains[1].tracks, *chains[1].truth), (*alone.tracks, *alone.truth), strict=True
    ):
        assert pickle.dumps(one) == pickle.dumps(other)
    assert chains[1].score() == alone.score()
    assert chains[0].score() != alone.score()
