"""Protects: the detection-threshold study reproduces the paper's two figures.

Few runs of the shortest scene are tracked here; margins are wider than those of the full study.
"""

from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.evaluation.monte_carlo.batch_runner import RunBatch
from sonar_tracking.evaluation.monte_carlo.study import StudyRow
from sonar_tracking.evaluation.studies.detection_threshold import study
from sonar_tracking.evaluation.studies.detection_threshold.runs import (
    SCENES,
    SYSTEMS,
    ThresholdRuns,
    ThresholdSystem,
    poisson_quantile,
    riccati_error,
    threshold_batch,
    track,
)
from sonar_tracking.evaluation.studies.detection_threshold.study import (
    DETECTION_THRESHOLD,
    error_metrics,
    optimum_row,
)
from sonar_tracking.evaluation.studies.study_catalogue import STUDIES

RUNS = 5


@pytest.fixture(scope="module")
def results() -> list[dict[tuple[str, str], ThresholdRuns]]:
    seeds = np.random.SeedSequence((1, 0)).spawn(RUNS)
    return [dict(threshold_batch(RunBatch(0, tuple(seeds))))]


@pytest.fixture(scope="module")
def rows(results: list[dict[tuple[str, str], ThresholdRuns]]) -> tuple[StudyRow, ...]:
    return study.rows(results)


@pytest.mark.parametrize(
    ("level_db", "ratio_bound", "loss_bound_percent"),
    [(10.0, 0.14, 0.3), (15.0, 0.24, 0.4), (20.0, 0.24, 0.4)],
)
@pytest.mark.parametrize("cells", [2.0, 5.0, 20.0, 100.0, 1000.0])
def test_closed_form_and_optimum_nearly_coincide(
    level_db: float, ratio_bound: float, loss_bound_percent: float, cells: float
) -> None:
    metrics = optimum_row(level_db, cells).metrics
    assert abs(metrics["log10_ratio"]) <= ratio_bound
    assert 0.0 <= metrics["closed_form_loss_percent"] <= loss_bound_percent


def test_at_5_decibel_they_differ_as_reported() -> None:
    few, many = optimum_row(5.0, 2.0).metrics, optimum_row(5.0, 1000.0).metrics
    assert few["closed_form_loss_percent"] == pytest.approx(5.7, abs=0.1)
    assert many["closed_form_loss_percent"] == pytest.approx(4.0, abs=0.1)


def test_adaptive_threshold_beats_the_fixed_one(rows: tuple[StudyRow, ...]) -> None:
    figures = {(row.system, row.condition): row.metrics for row in rows}
    for scene in SCENES:
        fixed = figures["PDA, 0.01", scene.condition]
        closed = figures["PDA, closed form", scene.condition]
        assert closed["median_error_m"] < 1.05 * fixed["median_error_m"]
        assert closed["lost_share"] <= fixed["lost_share"]
        assert closed["information_reduction"] > fixed["information_reduction"]


def test_promised_errors_are_those_of_the_reference() -> None:
    assert riccati_error(SCENES[1], ThresholdSystem("PDA", "0.01"), 5) == pytest.approx(
        13.7, abs=0.6
    )
    assert riccati_error(SCENES[0], ThresholdSystem("PDA", "closed form"), 5) < 17.0


def test_runs_are_reproducible_and_systems_share_the_target() -> None:
    seed = np.random.SeedSequence(3)
    first, _ = track(SCENES[1], SYSTEMS[3], seed)
    again, _ = track(SCENES[1], SYSTEMS[3], seed)
    assert np.array_equal(first, again)


@pytest.mark.parametrize("mean", [1e-3, 0.1, 1.0, 7.3, 300.0])
def test_counts_are_poisson_quantiles(mean: float) -> None:
    """Between the steps of the distribution, and at them."""
    from scipy.stats import poisson  # which no other test should wait for

    at_steps = poisson.cdf(np.arange(12), mean)
    drawn = np.random.default_rng(1).random(200)
    for probability in (*drawn, *at_steps[(at_steps > 0.0) & (at_steps < 1.0)]):
        assert poisson_quantile(probability, mean) == poisson.ppf(probability, mean)


def test_a_lost_run_is_counted_and_left_out_of_the_kept() -> None:
    error = np.full((4, 35), 5.0)
    error[0, 20:] = 1000.0
    metrics = error_metrics(ThresholdRuns(error, np.full((4, 35), 0.5)))
    assert metrics["lost_share"] == 0.25
    assert metrics["kept_rmse_m"] == pytest.approx(5.0)
    assert metrics["rmse_m"] > 100.0


def test_study_is_known_by_name_and_draws(
    results: list[dict[tuple[str, str], ThresholdRuns]],
    rows: tuple[StudyRow, ...],
    tmp_path: Path,
) -> None:
    assert STUDIES["detection-threshold"] is DETECTION_THRESHOLD
    pictures = DETECTION_THRESHOLD.draw(results, rows, tmp_path)
    assert len(pictures) == 2
    assert all(picture.stat().st_size > 10_000 for picture in pictures)
    runs = [len(task.argument.seeds) for task in DETECTION_THRESHOLD.tasks(21, 1)]
    assert runs == [5, 5, 5, 5, 1]
