"""Protects: every scene of the mismatch-positions study is what it says, and is told as it says.

How well the estimators do is not asked here: each condition is run twice.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.evaluation.monte_carlo.batch_runner import RunBatch
from sonar_tracking.evaluation.monte_carlo.study import StudyRow
from sonar_tracking.evaluation.studies.mismatch_positions import study
from sonar_tracking.evaluation.studies.mismatch_positions.condition import (
    lasting,
    lasting_factor,
)
from sonar_tracking.evaluation.studies.mismatch_positions.conditions import CONDITIONS
from sonar_tracking.evaluation.studies.mismatch_positions.runs import (
    MismatchBound,
    MismatchRuns,
    MismatchTask,
    mismatch_runs,
)
from sonar_tracking.evaluation.studies.study_catalogue import STUDIES
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.simulation.sensors.tma_scene import TmaRuns

SOME = ("bearing errors last 10 s, S1", "zig-zag by 30 deg, S3", "30 km away, S1")


def seeds(count: int, root: int = 3) -> tuple[np.random.SeedSequence, ...]:
    return tuple(np.random.SeedSequence(root).spawn(count))


def runs_of(name: str, count: int = 4) -> TmaRuns:
    condition = CONDITIONS[name]
    return condition.draw(condition.scene, seeds(count))


def azimuth_errors(runs: TmaRuns) -> FloatArray:
    offset = runs.truth[..., :2] - runs.scene.sensor_position
    return np.asarray(runs.azimuth - np.arctan2(offset[..., 1], offset[..., 0]))


def courses_deg(runs: TmaRuns) -> FloatArray:
    return np.asarray(np.degrees(np.arctan2(runs.truth[..., 3], runs.truth[..., 2])) % 360.0)


@pytest.fixture(scope="module")
def results() -> list[MismatchRuns | MismatchBound]:
    followed = [mismatch_runs(MismatchTask(name, RunBatch(0, seeds(2)))) for name in SOME]
    return [*followed, *(MismatchBound(name, 100.0) for name in SOME)]


@pytest.fixture(scope="module")
def rows(results: list[MismatchRuns | MismatchBound]) -> tuple[StudyRow, ...]:
    return study.rows(results)


@pytest.mark.slow
def test_every_estimator_has_finite_figures_under_a_condition(rows: tuple[StudyRow, ...]) -> None:
    assert [(row.condition, row.system) for row in rows] == [
        (name, system) for name in SOME for system in study.SYSTEMS
    ]
    for row in rows:
        assert row.metrics["range_rmse_m"] >= row.metrics["range_median_m"] > 0.0
        assert row.metrics["range_per_bound"] == row.metrics["range_rmse_m"] / 100.0
        assert np.isfinite(row.metrics["nees_per_dimension"])


@pytest.mark.slow
def test_same_seed_gives_the_same_run_whatever_is_followed_with_it(
    results: list[MismatchRuns | MismatchBound],
) -> None:
    (first,) = [one for one in results[:1] if isinstance(one, MismatchRuns)]
    one, other = seeds(2)
    batch = RunBatch(0, (*seeds(1, 9), other, one))
    again = mismatch_runs(MismatchTask(first.condition, batch))
    for system, outcomes in again.outcomes.items():
        assert outcomes.error[[2, 1]] == pytest.approx(first.outcomes[system].error, rel=1e-9)


def test_conditions_are_those_of_the_published_scenes_and_all_the_rest() -> None:
    names = " | ".join(CONDITIONS)
    for what in ("bearing errors last", "told 1/2", "wander", "zig-zag", "turn to", "30 km"):
        assert what in names
    assert len([name for name in CONDITIONS if name.startswith("turn to")]) == 12


def test_errors_last_as_long_as_they_should() -> None:
    normal = np.random.default_rng(1).standard_normal((20_000, 1))
    errors = lasting(normal, 10.0)[:, 0]
    assert np.var(errors) == pytest.approx(1.0, abs=0.15)
    assert np.mean(errors[10:] * errors[:-10]) == pytest.approx(np.exp(-1.0), abs=0.1)
    # The variance of a mean over a long time is that of white errors so much larger.
    means = errors.reshape(-1, 1000).mean(axis=1)
    assert 1000.0 * np.var(means) == pytest.approx(lasting_factor(10.0) ** 2, rel=0.5)


def test_bearing_errors_have_the_size_that_the_scene_says() -> None:
    for name in ("S1", "bearing errors last 10 s, S1", "bearing deviation told 1/2, S1"):
        spread = np.degrees(np.std(azimuth_errors(runs_of(name, 20))))
        assert spread == pytest.approx(0.5, rel=0.1), name


def test_what_is_claimed_and_told_differs_from_the_truth_as_the_name_says() -> None:
    halved = CONDITIONS["bearing deviation told 1/2, S1"]
    runs = halved.draw(halved.scene, seeds(1))
    assert halved.claimed(runs).scene.azimuth_deviation == 0.5 * runs.scene.azimuth_deviation
    assert halved.true(runs).scene.azimuth_deviation == runs.scene.azimuth_deviation
    wandering = CONDITIONS["lines wander 0.1 Hz over 10 s, S1"]
    runs = wandering.draw(wandering.scene, seeds(1))
    assert wandering.claimed(runs).scene.frequency_deviation == 0.05
    assert wandering.true(runs).scene.frequency_deviation == pytest.approx(0.45, abs=0.01)


def test_a_zigzag_keeps_its_speed_and_its_mean_course() -> None:
    runs = runs_of("zig-zag by 30 deg, S1", 6)
    speed = np.hypot(runs.truth[..., 2], runs.truth[..., 3])
    assert np.mean(speed) == pytest.approx(3.0, abs=0.2)
    assert np.median(courses_deg(runs), axis=1) == pytest.approx(180.0, abs=20.0)
    port = courses_deg(runs)[:, 80:] > 180.0
    assert 0.3 < np.mean(port) < 0.7
    firsts = [
        int(np.flatnonzero(np.abs(np.diff(one, axis=0)[:, 1]) > 0.4)[0])
        for one in runs.truth[..., 2:]
    ]
    assert len(set(firsts)) == 6 and max(firsts) <= 80


@pytest.mark.parametrize("name", [name for name in CONDITIONS if name.startswith("turn to")])
def test_targets_turn_by_ninety_degrees_to_the_side_that_is_said(name: str) -> None:
    runs = runs_of(name, 6)
    turned = np.median(courses_deg(runs)[:, 450] - courses_deg(runs)[:, 325])
    assert turned == pytest.approx(90.0 if "to port" in name else -90.0, abs=10.0)
    moving = np.diff(runs.scene.sensor_velocity, axis=0)
    assert not np.any(moving[201:]), "own ship is straight while the target turns"
    assert np.any(moving) == ("always straight" not in name)
    assert np.any(np.isfinite(runs.frequency)) == ("no tonal" not in name)


def test_study_is_known_by_name_and_draws(
    results: list[MismatchRuns | MismatchBound], rows: tuple[StudyRow, ...], tmp_path: Path
) -> None:
    definition = STUDIES["mismatch-positions"]
    tasks = definition.tasks(2, 1)
    assert sum(len(task.argument.batch.seeds) == 2 for task in tasks) == len(CONDITIONS)
    assert len(tasks) == 2 * len(CONDITIONS) and definition.default_runs == 50
    (picture,) = definition.draw(results, rows, tmp_path)
    assert picture.stat().st_size > 10_000
