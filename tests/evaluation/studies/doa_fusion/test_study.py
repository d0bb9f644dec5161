"""Protects: the doa-fusion study reproduces the paper's table, on any number of workers.

The margins are wider than those of the full study, since ten runs scatter more than 100.
"""

import json
from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.evaluation.monte_carlo.batch_runner import RunBatch, run_batches
from sonar_tracking.evaluation.monte_carlo.study import Study
from sonar_tracking.evaluation.studies.doa_fusion import study as definition
from sonar_tracking.evaluation.studies.doa_fusion.joint_map_runs import CAUSAL, CENTRED, DEFAULT
from sonar_tracking.evaluation.studies.doa_fusion.study import BOUND, bound_deg2
from sonar_tracking.evaluation.studies.doa_fusion.systems import (
    AUTOMATIC,
    AVERAGE_ONLY,
    CORRELATED,
    PROPOSED,
    RYU,
    VARIANCE_ONLY,
)
from sonar_tracking.evaluation.studies.study_catalogue import run_study
from tests.evaluation.kept_results import KeptStudy, run_and_keep

RUNS, RUNS_PER_BATCH = 10, 9  # more than one batch
RUNS_OF_VARIANCES = 13
"""Variances of fused bearings scatter most, and take least."""
LEVELS_DB = (-5, -3, 0)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("doa_fusion")


def batches(runs: int, seed: int, part: int) -> tuple[RunBatch, ...]:
    """Return those of bearings that are tracked, or those of fused variances, which are more."""
    return run_batches(RUNS_OF_VARIANCES if part else runs, seed, part, RUNS_PER_BATCH)


@pytest.fixture(scope="module")
def kept(folder: Path) -> KeptStudy:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(definition, "run_batches", batches)
        return run_and_keep("doa-fusion", RUNS, json=folder / "study.json", plots=folder)


@pytest.fixture(scope="module")
def study(kept: KeptStudy) -> Study:
    return kept.study


def metric(study: Study, system: str, level: int, name: str = "mse_deg2") -> float:
    return study.row(system, f"SNR {level} dB").metrics[name]


def test_fusion_beats_one_subspace_as_published(study: Study) -> None:
    for level, ratio in zip(LEVELS_DB, (0.60, 0.65, 0.75), strict=True):
        assert metric(study, PROPOSED, level) < ratio * metric(study, RYU, level)


@pytest.mark.parametrize(
    ("system", "expected"), [(RYU, (1.25, 0.75, 0.40)), (PROPOSED, (0.48, 0.34, 0.19))]
)
def test_errors_are_those_of_the_reference(
    study: Study, system: str, expected: tuple[float, ...]
) -> None:
    measured = [metric(study, system, level) for level in LEVELS_DB]
    assert measured == pytest.approx(expected, rel=0.35)


def test_success_rates_are_those_of_the_paper(study: Study) -> None:
    assert 45 <= metric(study, RYU, -5, "success_percent") <= 95
    for level in LEVELS_DB:
        assert metric(study, PROPOSED, level, "success_percent") >= 85


def test_the_gain_comes_from_the_claimed_variance_and_not_from_averaging(study: Study) -> None:
    for level in LEVELS_DB:
        ryu = metric(study, RYU, level)
        assert metric(study, AVERAGE_ONLY, level) == pytest.approx(ryu, rel=0.25)
        assert metric(study, VARIANCE_ONLY, level) < 0.75 * ryu


def test_automatic_start_succeeds_as_often_as_the_truth(study: Study) -> None:
    told = metric(study, PROPOSED, 0, "success_percent")
    assert metric(study, AUTOMATIC, 0, "success_percent") >= told - 5


def test_nothing_beats_the_bound(study: Study) -> None:
    for level in LEVELS_DB:
        bound = metric(study, BOUND, level)
        told = (RYU, AVERAGE_ONLY, VARIANCE_ONLY, PROPOSED, CORRELATED, AUTOMATIC, CENTRED)
        for system in told:
            assert metric(study, system, level) > bound


@pytest.mark.parametrize(
    ("system", "of_proposed", "of_bound"), [(CENTRED, 0.25, 1.4), (CAUSAL, 0.33, 1.65)]
)
def test_joint_filter_stays_near_the_bound(
    study: Study, system: str, of_proposed: float, of_bound: float
) -> None:
    for level in LEVELS_DB:
        assert metric(study, system, level) < of_proposed * metric(study, PROPOSED, level)
        assert metric(study, system, level, "success_percent") >= 90
        assert metric(study, system, level, "rmse_over_bound") < of_bound
        nees = metric(study, system, level, "median_nees_per_dimension")
        assert nees == pytest.approx(1.0, abs=0.25)


def test_default_process_noise_keeps_all_targets(study: Study) -> None:
    # It knows nothing of the turns, so that its errors are larger than with the process noise
    # of this scenario, but no target is lost.
    for level in LEVELS_DB:
        assert metric(study, DEFAULT, level) < 0.5 * metric(study, PROPOSED, level)
        assert metric(study, DEFAULT, level, "success_percent") >= 95


@pytest.mark.parametrize(("level", "expected"), [(-5, 0.0530), (-3, 0.0361), (0, 0.0207)])
def test_bound_is_the_known_one(level: int, expected: float) -> None:
    assert np.mean(bound_deg2(level)) == pytest.approx(expected, rel=0.02)


def test_claimed_variances_of_the_paper_are_pessimistic_and_reported(study: Study) -> None:
    for level in LEVELS_DB:
        assert metric(study, RYU, level, "nis_per_dimension") < 0.05
        assert metric(study, PROPOSED, level, "nees_per_dimension") < 0.3


def test_calibrated_tracker_is_consistent_with_correlation_and_not_without(study: Study) -> None:
    condition = "calibrated, SNR 0 dB"
    believed = study.row("7, eq. 14", condition).metrics
    correlated = study.row("7, correlated", condition).metrics
    assert correlated["nis_per_dimension"] == pytest.approx(1.0, abs=0.25)
    assert correlated["nees_per_dimension"] == pytest.approx(1.0, abs=0.3)
    assert believed["nis_per_dimension"] > 3
    assert believed["nees_per_dimension"] > 3


def test_fused_variance_holds_with_correlation_and_fails_without(study: Study) -> None:
    checked = [row for row in study.rows if "variance_ratio" in row.metrics]
    assert len(checked) == 10
    for row in checked:
        assert row.metrics["claimed_over_measured_correlated"] == pytest.approx(1.0, abs=0.15)
        assert 5.0 < row.metrics["nis_independent"] < 7.0


def test_numbers_do_not_depend_on_the_number_of_workers(kept: KeptStudy) -> None:
    # A batch of many runs, and of each part of the study the one that is left over.
    kept.assert_same_alone([len(kept.tasks) - 2, *range(1, len(kept.tasks), 2)])


def test_json_and_pictures_are_written(study: Study, folder: Path) -> None:
    content = json.loads((folder / "study.json").read_text())
    assert (content["study"], content["runs"], content["seed"]) == ("doa-fusion", RUNS, 1)
    published = {
        (row["system"], row["condition"]): row["published"]
        for row in content["rows"]
        if row["published"]
    }
    assert published["PROPOSED", "SNR -5 dB"] == {"mse_deg2": 0.454, "success_percent": 97.0}
    assert len(published) == 6
    names = {path.stem for path in folder.glob("*.png")}
    assert {"figure_2_typical_run", "table_1_levels", "fused_variance"} <= names


def test_an_unknown_study_is_refused_with_the_nearest_name() -> None:
    with pytest.raises(ConfigurationError, match="did you mean doa-fusion"):
        run_study("doa_fusion")
