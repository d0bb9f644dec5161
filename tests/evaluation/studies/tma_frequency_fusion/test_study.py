"""Protects the tma-frequency-fusion study: its rows, its figures, its conclusions."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sonar_tracking.evaluation.monte_carlo.batch_runner import Task, run_batches
from sonar_tracking.evaluation.monte_carlo.study import Study
from sonar_tracking.evaluation.studies.study_catalogue import STUDIES
from sonar_tracking.evaluation.studies.tma_frequency_fusion import (
    observability_rows,
    random_scenes,
    runs,
)
from sonar_tracking.evaluation.studies.tma_frequency_fusion import study as definition
from sonar_tracking.evaluation.studies.tma_frequency_fusion.batch_rows import (
    FUSED_LIKELIHOOD,
    LIKELIHOOD,
    PATH,
    estimate_whole_batch,
)
from sonar_tracking.evaluation.studies.tma_frequency_fusion.cases import CASES, estimate_case
from sonar_tracking.evaluation.studies.tma_frequency_fusion.figures import draw_errors, draw_scene
from sonar_tracking.evaluation.studies.tma_frequency_fusion.histories import frame_metrics
from sonar_tracking.evaluation.studies.tma_frequency_fusion.random_scenes import (
    estimate_random_scenes,
    random_scene,
)
from sonar_tracking.evaluation.studies.tma_frequency_fusion.runs import SceneBatch, estimate_batch
from sonar_tracking.evaluation.studies.tma_frequency_fusion.study import (
    BOUND,
    SCENARIOS,
    TMA_FREQUENCY_FUSION,
)
from sonar_tracking.evaluation.studies.tma_frequency_fusion.systems import (
    BEARINGS_ONLY,
    CHAN,
    JAUFFRET,
    PROPOSED,
    RANGE_BANK,
    SYSTEMS,
)

RUNS = 16
NOT_ASKED_FOR = ("all lines gone for 50 s", "all lines 3 sigma off")
LINES_AND_STRAIGHT = ("own ship straight, lines 1 Hz", "own ship straight, lines 0.05 Hz")
"""Cases of the whole study from whose rows these tests conclude nothing."""


RUNS_NEEDED: dict[object, dict[str, slice]] = {
    estimate_batch: {"S1": slice(RUNS), "S2": slice(10), "S3": slice(2)},
    estimate_case: {"5 % outliers": slice(RUNS)},
}
"""By task and scene or case. In S2 estimators are several times apart; of S3 rows are wanted only.
Outliers are compared with the clean runs."""

OF_OTHER_CASES = slice(4, 10)
"""Six tell of alarms and of the NEES."""

DRAWN = {"S1_scene", "S1_errors"}
"""Pictures that are drawn: those of other scenarios differ in what is shown alone."""


def with_runs_needed(task: Task) -> Task:
    """Return a task with as many of its runs as these tests draw conclusions from."""
    batch = task.argument
    if task.function in RUNS_NEEDED:
        own = RUNS_NEEDED[task.function].get(batch.scenario, OF_OTHER_CASES)
        few = replace(batch.batch, seeds=batch.batch.seeds[own])
        return replace(task, argument=replace(batch, batch=few))
    if task.function in (estimate_random_scenes, estimate_whole_batch):
        count = 1 if task.function is estimate_random_scenes else 10
        return replace(task, argument=replace(batch, seeds=batch.seeds[:count]))
    return task


@pytest.fixture(scope="module")
def results() -> Iterator[Sequence[Any]]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(definition, "BOUND_PATHS", 40)
        patch.setattr(observability_rows, "RUNS", 1)
        patch.setattr(random_scenes, "RUNS_PER_SCENE", 2)
        for case in NOT_ASKED_FOR:
            patch.delitem(CASES, case)
        tasks = [with_runs_needed(task) for task in TMA_FREQUENCY_FUSION.tasks(RUNS, 1)]
        yield [
            task.function(task.argument)
            for task in tasks
            if getattr(task.argument, "case", "") not in LINES_AND_STRAIGHT
        ]


@pytest.fixture(scope="module")
def study(results: Sequence[Any]) -> Study:
    return Study("tma-frequency-fusion", RUNS, 1, 1.0, TMA_FREQUENCY_FUSION.rows(results))


def test_it_is_known_by_name() -> None:
    assert STUDIES["tma-frequency-fusion"] is TMA_FREQUENCY_FUSION


def test_every_estimator_has_a_row_in_every_scenario(study: Study) -> None:
    for condition in SCENARIOS.values():
        for system in (*SYSTEMS, BOUND):
            assert study.row(system, condition).metrics["range_rmse_m"] > 0.0


def test_table_3_stands_beside_s1_only(study: Study) -> None:
    assert study.row(PROPOSED, SCENARIOS["S1"]).published["range_rmse_m"] == 102.0
    assert study.row(CHAN, SCENARIOS["S1"]).published["course_rmse_deg"] == 49.3
    assert not study.row(PROPOSED, SCENARIOS["S2"]).published


def test_the_published_order_is_met(study: Study) -> None:
    ranges = {
        system: study.row(system, SCENARIOS["S1"]).metrics["range_rmse_m"] for system in SYSTEMS
    }
    assert ranges[CHAN] > 3.0 * ranges[PROPOSED]
    assert ranges[JAUFFRET] > 2.0 * ranges[PROPOSED]
    # The twin that hears no line does as well: the gap is not made by Doppler.
    assert ranges[BEARINGS_ONLY] < 1.1 * ranges[PROPOSED]


def test_the_default_is_far_ahead_where_doppler_matters(study: Study) -> None:
    ranges = {
        system: study.row(system, SCENARIOS["S2"]).metrics["range_rmse_m"] for system in SYSTEMS
    }
    assert ranges[PROPOSED] > 2.5 * ranges[RANGE_BANK]
    assert ranges[BEARINGS_ONLY] > 8.0 * ranges[RANGE_BANK]


def test_bad_data_and_turns_cost_little(study: Study) -> None:
    alarms = {
        "target turns 90 deg in 30 s, S1": "manoeuvre_percent",
        "one line is another source, S2": "reborn_percent",
        "one line is another, well-measured source, S3": "reborn_percent",
        "one line 3 sigma off, S2": "reborn_percent",
    }
    for case, alarm in alarms.items():
        metrics = study.row(RANGE_BANK, f"gone wrong: {case}").metrics
        assert metrics[alarm] >= 95.0
        assert metrics["nees_settled"] < 2.0
    assert study.row(RANGE_BANK, "gone wrong: 5 % outliers, S1").metrics["range_per_clean"] < 1.3


def test_batch_estimators_are_told_apart(study: Study) -> None:
    straight = "batch: target exactly straight, S1"
    for system in (LIKELIHOOD, FUSED_LIKELIHOOD):
        assert study.row(system, straight).metrics["range_per_bound"] < 1.5
    moving = "batch: random accelerations, S1"
    assert study.row(LIKELIHOOD, moving).metrics["nees_per_dimension"] > 5.0
    assert study.row(PATH, moving).metrics["nees_per_dimension"] < 2.0


def test_what_cannot_be_known_is_said_to_be_unknown(study: Study) -> None:
    cases = {row.system: row.metrics for row in study.rows if row.condition == "observability"}
    for case in ("own ship straight, no line", "constant bearing, lines 0.05 Hz"):
        assert cases[case]["unobservable_percent"] == 100.0
        assert cases[case]["observability"] < 0.05
    assert cases["own ship turns, no line"]["unobservable_percent"] == 0.0
    sides = cases["line array, own ship turns, no line"]
    assert (sides["early_sides"], sides["last_sides"]) == (2.0, 1.0)
    assert sides["right_side_percent"] == 100.0


def test_random_scenes_are_different() -> None:
    one = random_scene(np.random.default_rng(1))
    other = random_scene(np.random.default_rng(2))
    assert not np.array_equal(one.target, other.target)
    assert 2000.0 <= np.hypot(*one.target[:2]) <= 12_000.0
    assert one.heard.any()
    assert not one.heard.all()


def test_a_run_has_its_own_numbers(results: Sequence[Any], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(runs, "SYSTEMS", {RANGE_BANK: SYSTEMS[RANGE_BANK]})
    batches = run_batches(2, 1)
    part = estimate_batch(SceneBatch("S1", batches[0])).systems[RANGE_BANK]
    whole = next(one for one in results if getattr(one, "systems", None)).systems[RANGE_BANK]
    np.testing.assert_allclose(part.error, whole.error[:2], rtol=1e-6, atol=1e-9)


def test_figures_of_known_errors(results: Sequence[Any]) -> None:
    histories = next(one for one in results if getattr(one, "systems", None)).systems[PROPOSED]
    histories.error[:, -1] = np.array([3.0, 0.1, -2.0, 0.5])
    bound = np.ones((400, 4))
    metrics = frame_metrics(histories, bound, -1)
    assert metrics["range_rmse_m"] == pytest.approx(3.0)
    assert metrics["course_rmse_deg"] == pytest.approx(2.0)
    assert metrics["lost_percent"] == 0.0
    assert frame_metrics(histories, 0.5 * bound, -1)["lost_percent"] == 100.0


def test_pictures_are_drawn(
    results: Sequence[Any], study: Study, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for draw in (draw_scene, draw_errors):

        def draw_some(path: Path, *what: Any, draw: Callable[..., Path] = draw) -> Path:
            return draw(path, *what) if path.stem in DRAWN else path

        monkeypatch.setattr(definition, draw.__name__, draw_some)
    pictures = TMA_FREQUENCY_FUSION.draw(results, study.rows, tmp_path)
    assert len(set(pictures)) == 6
    drawn = set(tmp_path.glob("*.png"))
    assert {picture.stem for picture in drawn} == DRAWN
    assert all(picture.stat().st_size > 10_000 for picture in drawn)
