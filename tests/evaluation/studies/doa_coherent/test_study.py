"""Protects: the doa-coherent study reproduces the paper's tables; the joint filter beats them.

The margins are wider than those of the full study, since 12 runs scatter more than 100.
"""

from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sonar_tracking.evaluation.monte_carlo.run_synthesis import true_bearings
from sonar_tracking.evaluation.monte_carlo.study import Study
from sonar_tracking.evaluation.studies.doa_coherent import study as definition
from sonar_tracking.evaluation.studies.doa_coherent.runs import DEFAULT, JOINT, PROPOSED, RYU
from sonar_tracking.evaluation.studies.doa_coherent.scenes import (
    BURST_SNAPSHOTS,
    CLOSE,
    COHERENT,
    COLOURED,
    CONDITIONS,
    CROSSING,
    INCOHERENT,
    PERIOD,
    Condition,
    bursts,
    scored_bearings,
    sources_of,
)
from sonar_tracking.evaluation.studies.doa_coherent.study import BOUND
from sonar_tracking.evaluation.studies.doa_fusion.figures import draw_run
from sonar_tracking.evaluation.studies.study_catalogue import STUDIES
from sonar_tracking.geometry import steering_vectors
from tests.evaluation.kept_results import SEED, KeptStudy

WAVENUMBER = 2.0 * np.pi / 0.075
NAME, RUNS = "doa-coherent", 12
DRAWN = {"figure_3_close_coherent", "figure_4_crossing_incoherent"}
"""Pictures that are drawn, of a run in which RYU fails and of one in which it does not."""


@pytest.fixture(scope="module")
def kept() -> KeptStudy:
    tasks = STUDIES[NAME].tasks(RUNS, SEED)
    results = [task.function(task.argument) for task in tasks]
    return KeptStudy(Study(NAME, RUNS, SEED, 1.0, STUDIES[NAME].rows(results)), tasks, results)


@pytest.fixture(scope="module")
def study(kept: KeptStudy) -> Study:
    return kept.study


def metric(study: Study, system: str, scene: str, kind: str, name: str = "mse_deg2") -> float:
    return study.row(system, Condition(scene, kind).name).metrics[name]


def success(study: Study, system: str, scene: str, kind: str) -> float:
    return metric(study, system, scene, kind, "success_percent")


@pytest.mark.parametrize("scene", [CLOSE, CROSSING])
def test_coherent_sources_break_ryu_only(study: Study, scene: str) -> None:
    assert success(study, RYU, scene, INCOHERENT) == 100
    assert success(study, PROPOSED, scene, INCOHERENT) == 100
    assert success(study, RYU, scene, COHERENT) <= 95
    assert success(study, PROPOSED, scene, COHERENT) >= 95
    assert metric(study, PROPOSED, scene, COHERENT) < 0.1 * metric(study, RYU, scene, COHERENT)


@pytest.mark.parametrize(
    ("scene", "kind", "ryu", "proposed"),
    [
        (CLOSE, INCOHERENT, 0.020, 0.0175),
        (CLOSE, COHERENT, 1.1, 0.018),
        (CROSSING, INCOHERENT, 0.031, 0.043),
        (CROSSING, COHERENT, 3.2, 0.047),
        (CLOSE, COLOURED, 0.036, 0.021),
    ],
)
def test_errors_are_those_of_the_reference(
    study: Study, scene: str, kind: str, ryu: float, proposed: float
) -> None:
    assert metric(study, RYU, scene, kind) == pytest.approx(ryu, rel=0.4)
    assert metric(study, PROPOSED, scene, kind) == pytest.approx(proposed, rel=0.2)


@pytest.mark.parametrize("condition", CONDITIONS)
def test_a_filter_that_is_not_told_how_bearings_turn_is_nearly_as_good(
    study: Study, condition: Condition
) -> None:
    case = condition.scene, condition.kind
    assert success(study, DEFAULT, *case) >= 98
    told, untold = (metric(study, name, *case, "rmse_over_bound") for name in (JOINT, DEFAULT))
    assert untold <= 1.15 * told


@pytest.mark.parametrize("condition", CONDITIONS)
def test_joint_filter_beats_both_and_nothing_beats_the_bound(
    study: Study, condition: Condition
) -> None:
    case = condition.scene, condition.kind
    joint, bound = metric(study, JOINT, *case), metric(study, BOUND, *case)
    assert success(study, JOINT, *case) >= 98
    # One without a successful run has no error.
    assert joint < 0.95 * np.fmin(metric(study, RYU, *case), metric(study, PROPOSED, *case))
    assert joint > bound
    assert metric(study, JOINT, *case, "rmse_over_bound") < 1.4
    nees = metric(study, JOINT, *case, "median_nees_per_dimension")
    assert nees == pytest.approx(1.0, abs=0.25)


@pytest.mark.parametrize(
    ("scene", "kind", "expected"),
    [(CLOSE, INCOHERENT, 0.0108), (CLOSE, COHERENT, 0.0114), (CROSSING, INCOHERENT, 0.0169)],
)
def test_bound_is_the_known_one(study: Study, scene: str, kind: str, expected: float) -> None:
    assert metric(study, BOUND, scene, kind) == pytest.approx(expected, rel=0.03)


def test_scenes_are_those_of_the_paper() -> None:
    # Angles from the axis; speed over range turned into the rate at the closest point.
    angles, rates = scored_bearings(Condition(CLOSE, INCOHERENT))
    from_axis = np.degrees(angles) + 90.0
    assert from_axis[4] == pytest.approx([50.0, 133.5 - np.degrees(np.arctan(4 * 560 / 1500))])
    assert np.diff(from_axis, axis=1).min() == pytest.approx(10.01, abs=0.01)
    assert rates[4, 0] == pytest.approx(4.0 / 1500.0)
    angles, _ = scored_bearings(Condition(CROSSING, INCOHERENT))
    order = np.argsort(angles, axis=1)
    assert np.count_nonzero(np.any(np.diff(order, axis=0) != 0, axis=1)) == 2


def test_bursts_have_the_covariance_of_their_condition() -> None:
    seeds = np.random.SeedSequence(3).spawn(300)
    for condition in (Condition(CLOSE, INCOHERENT), Condition(CROSSING, COLOURED)):
        sources = sources_of(condition, seeds)
        first, second = islice(bursts(sources), 2)
        scenario = condition.scenario()
        half = 0.5 * (BURST_SNAPSHOTS - 1) * first.sample_period
        assert first.stamp == scenario.stamp(-half)
        assert second.stamp - first.stamp == round(PERIOD * 1e9)
        snapshots = first.data.reshape(-1, 15)
        measured = snapshots.T @ snapshots.conj() / len(snapshots)
        angles, _ = true_bearings(scenario, np.zeros(1))
        vectors = steering_vectors(scenario.array.element_positions(), angles[0], WAVENUMBER)
        colour = condition.noise_covariance()
        expected = vectors @ vectors.conj().T + (np.eye(15) if colour is None else colour)
        assert np.abs(measured - expected).max() < 0.15


def test_coherent_sources_carry_one_waveform_at_equal_power() -> None:
    sources = sources_of(Condition(CROSSING, COHERENT), np.random.SeedSequence(4).spawn(10))
    covariances = sources.covariances()
    assert set(np.linalg.matrix_rank(covariances, tol=1e-9).tolist()) == {1}
    assert np.allclose(np.abs(covariances), 1.0)
    assert np.std(np.angle(covariances[:, 0, 1])) > 0.5


def test_pictures_are_written(
    kept: KeptStudy, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def draw_some(path: Path, *what: Any) -> Path:
        return draw_run(path, *what) if path.stem in DRAWN else path

    monkeypatch.setattr(definition, "draw_run", draw_some)
    pictures = definition.draw(kept.results, kept.study.rows, tmp_path)
    names = {path.stem for path in pictures}
    assert {f"figure_{number}" for number in (2, 3, 4, 5)} <= {name[:8] for name in names}
    assert len(names) == len(CONDITIONS)
    assert {path.stem for path in tmp_path.glob("*.png")} == DRAWN


def test_published_figures_stand_beside(study: Study) -> None:
    row = study.row(PROPOSED, Condition(CROSSING, COHERENT).name)
    assert row.published == {"mse_deg2": 0.1327, "success_percent": 100.0}
    assert not study.row(JOINT, Condition(CROSSING, COHERENT).name).published


def test_a_worker_by_itself_gives_the_same_numbers(kept: KeptStudy) -> None:
    kept.assert_same_alone([2])
