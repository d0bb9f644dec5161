"""Protects the scenario-seeds study: seed 1 is the scenario, quantiles are over seeds."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.evaluation.offline.offline_contact_chain import run_offline_active_chain
from sonar_tracking.evaluation.studies.scenario_seeds.study import (
    CHAINS,
    FIGURES,
    RUNS_PER_TASK,
    SCENARIO_SEEDS,
    RunFigures,
    SeededRuns,
    scenario_rows,
    score_runs,
)
from sonar_tracking.evaluation.studies.study_catalogue import STUDIES
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario


def figures(value: float) -> dict[str, float]:
    counts = ("confirmation_delay", "confirmation_delay_periods", "false_tracks")
    return dict.fromkeys((*FIGURES, *counts, "identity_swaps", "targets_never_held"), value)


def test_the_first_seed_is_what_the_scenario_says_and_another_is_another_run() -> None:
    first, second = score_runs(SeededRuns("active", (1, 2), 300.0))
    scenario = replace(load_scenario("active"), duration=300.0)
    score = run_offline_active_chain(scenario).score()
    assert first.figures["rmse_m"] == score.rmse_m != second.figures["rmse_m"]
    assert (first.system, first.seed) == ("active", 1)


def test_tracks_of_target_motion_analysis_come_with_hindsight_too() -> None:
    parts = score_runs(SeededRuns("tma", (3,), 400.0))
    assert [part.system for part in parts] == ["tma", "tma, smoothed"]
    assert parts[1].figures["held_share"] > parts[0].figures["held_share"]


def test_quantiles_are_over_seeds_and_runs_without_positions_are_counted() -> None:
    """Of 1 to 11 the median is 6, a tenth of the way 2, nine tenths 10."""
    runs = [(RunFigures("tma", seed, figures(float(seed))),) for seed in range(1, 12)]
    runs.append((RunFigures("tma", 12, {**figures(6.0), "median_error_m": np.nan}),))
    (row,) = scenario_rows(runs)
    assert (row.system, row.condition) == ("tma", "seeds 1 to 12")
    names = ("median_error_m_low", "median_error_m_median", "median_error_m_high")
    assert [row.metrics[name] for name in names] == [2.0, 6.0, 10.0]
    assert row.metrics["false_tracks_mean"] == 6.0 and row.metrics["runs_without_positions"] == 1.0


def test_each_scenario_has_every_seed_from_the_one_given(tmp_path: Path) -> None:
    assert STUDIES["scenario-seeds"] is SCENARIO_SEEDS and SCENARIO_SEEDS.default_runs >= 20
    runs = [task.argument for task in SCENARIO_SEEDS.tasks(RUNS_PER_TASK + 1, 5)]
    last = RUNS_PER_TASK + 5
    of_each = {name: [run.seeds for run in runs if run.scenario == name] for name in CHAINS}
    assert of_each == {name: [tuple(range(5, last)), (last,)] for name in CHAINS}
    with pytest.raises(ConfigurationError, match="at least 1 run"):
        SCENARIO_SEEDS.tasks(0, 1)
    results = [(RunFigures("tma", 1, figures(20.0)), RunFigures("tma, smoothed", 1, figures(9.0)))]
    (picture,) = SCENARIO_SEEDS.draw(results, scenario_rows(results), tmp_path)
    assert picture.stat().st_size > 0
