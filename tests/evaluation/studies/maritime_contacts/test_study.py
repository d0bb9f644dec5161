"""Protects: boats in recorded radar scans are tracked, and the contacts trail them by one scan."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.evaluation.studies.maritime_contacts import study as study
from sonar_tracking.evaluation.studies.maritime_contacts.scenarios import (
    MaritimeScenario,
    estimated_latency,
    read_scenarios,
)
from sonar_tracking.evaluation.studies.study_catalogue import run_study
from sonar_tracking.records.arrays import FloatArray
from tests.recorded_data import recorded_data

LATENCY = 1.5


def made_scenario(seed: int) -> MaritimeScenario:
    """Return two boats on crossing courses, whose contacts trail them by LATENCY."""
    generator = np.random.default_rng(seed)
    times: FloatArray = 1.7 * np.arange(40.0)
    starts = np.array([[-150.0, 80.0], [-100.0, 220.0]])
    velocity = np.array([[3.0, 0.5], [2.5, -2.0]])
    own = np.stack([0.5 * times, np.zeros_like(times)], axis=1)
    truth = starts + times[:, None, None] * velocity
    ranges, azimuths = [], []
    for scan in range(len(times)):
        seen = truth[scan] - LATENCY * velocity + generator.normal(0.0, 2.0, (2, 2))
        clutter = generator.uniform(-400.0, 400.0, (generator.poisson(2.0), 2))
        away = np.concatenate([seen, clutter]) - own[scan]
        ranges.append(np.hypot(away[:, 0], away[:, 1]))
        azimuths.append(np.arctan2(away[:, 1], away[:, 0]))
    return MaritimeScenario(
        f"made{seed}", times, 10**18, own, truth, tuple(ranges), tuple(azimuths)
    )


def test_latency_is_found_and_tracks_hold_the_boats() -> None:
    scenarios = [made_scenario(seed) for seed in (1, 2)]
    assert estimated_latency(scenarios) == pytest.approx(LATENCY, abs=0.3)
    corrected = study.track_scenario("a", study.CONFIGURATION, scenarios[0], LATENCY).metrics
    stamped = study.track_scenario("b", study.CONFIGURATION, scenarios[0], 0.0).metrics
    assert corrected["held_share"] > 0.8 and corrected["continuity"] > 0.8
    assert corrected["rmse_m"] < 3.0 < stamped["rmse_m"]


def test_nearest_contacts_are_as_good_as_their_errors() -> None:
    metrics = study.nearest_contacts(made_scenario(3), LATENCY).metrics
    assert metrics["held_share"] == 1.0
    assert metrics["rmse_m"] == pytest.approx(2.0 * np.sqrt(2.0), rel=0.15)
    assert metrics["gospa_m"] >= metrics["ospa_m"]


@pytest.mark.data
def test_recorded_boats_are_held(tmp_path: Path) -> None:
    (scenario,) = read_scenarios(recorded_data("maritime_contacts/scenario05.npz"))
    assert 1.0 < estimated_latency([scenario]) < 3.0
    metrics = study.track_scenario("a", study.CONFIGURATION, scenario, 1.7).metrics
    assert metrics["held_share"] > 0.85 and metrics["identity_swaps"] == 0.0
    assert metrics["ospa_m"] < 10.0 and metrics["rmse_m"] < 6.5
    nearest = study.nearest_contacts(scenario, 1.7)
    assert nearest.metrics["ospa_m"] < metrics["ospa_m"]


def test_data_that_are_not_there_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match="holds no scenario"):
        read_scenarios(tmp_path)
    np.savez(tmp_path / "scenario99.npz", nothing=np.zeros(3))
    with pytest.raises(ConfigurationError, match="radar_scan_t_s"):
        read_scenarios(tmp_path)
    with pytest.raises(ConfigurationError, match="needs measured data"):
        run_study(study.MARITIME_CONTACTS)


@pytest.mark.data
def test_study_draws_a_chart_of_each_scenario(tmp_path: Path) -> None:
    definition = study.maritime_contacts(recorded_data("maritime_contacts/scenario16.npz"))
    (task,) = definition.tasks(1, 1)
    results = [task.function(task.argument)]
    rows = definition.rows(results)
    assert {row.condition for row in rows} == {study.ALL, "scenario16"}
    assert len({row.system for row in rows}) == len(study.SYSTEMS) + 3
    means = {row.system: row.metrics for row in rows if row.condition == study.ALL}
    everything, moving = means[study.DEFAULTS], means[study.MOVING]
    assert moving["false_tracks_per_hour"] < everything["false_tracks_per_hour"]
    assert moving["held_share"] > 0.8 * everything["held_share"]
    (picture,) = definition.draw(results, rows, tmp_path)
    assert picture.stat().st_size > 10_000
