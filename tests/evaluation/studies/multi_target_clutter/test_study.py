"""Protects: the multi-target-clutter study orders the trackers as published.

Two short runs are tracked here; the margins are wider than those of the full study.
"""

from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.evaluation.monte_carlo import tracked_runs
from sonar_tracking.evaluation.monte_carlo.study import StudyRow
from sonar_tracking.evaluation.studies.multi_target_clutter import runs as runs_of_tasks
from sonar_tracking.evaluation.studies.multi_target_clutter import study
from sonar_tracking.evaluation.studies.multi_target_clutter.clutter_bound import position_bounds
from sonar_tracking.evaluation.studies.multi_target_clutter.runs import (
    ClutterRun,
    ClutterTask,
    clutter_runs,
)
from sonar_tracking.evaluation.studies.multi_target_clutter.scene import (
    EPOCH,
    N_PINGS,
    PING_INTERVAL,
    SceneOptions,
    make_targets,
    simulate_scene,
)
from sonar_tracking.evaluation.studies.multi_target_clutter.study import BOUND, MULTI_TARGET_CLUTTER
from sonar_tracking.evaluation.studies.multi_target_clutter.systems import (
    CLUSTERING_LITERAL,
    HPDA_KALMAN,
    HPDA_PARTICLE,
    INTEGRATED,
    PAPER_SYSTEMS,
    PHD,
    THRESHOLD_SYSTEMS,
)
from sonar_tracking.evaluation.studies.study_catalogue import STUDIES

FIRST, PINGS = 60, 190
"""One target is there at first, four in the end; what comes before is more of one target."""


@pytest.fixture(scope="module")
def results() -> list[tuple[ClutterRun, ...]]:
    """Return runs of all environments; how long a ping takes is measured in the third."""
    seeds = tuple(np.random.SeedSequence((1, 0)).spawn(2))
    tasks = [
        ClutterTask(f"environment {number}", SceneOptions(number), PAPER_SYSTEMS, seeds, PINGS)
        for number in (1, 2)
    ]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tracked_runs, "_seconds_alone", lambda *_: 1e-3)
        patch.setattr(runs_of_tasks, "simulate_scene", lambda *of: simulate_scene(*of)[FIRST:])
        runs = [clutter_runs(task) for task in tasks]
    computed = {n: c for n, c in THRESHOLD_SYSTEMS.items() if n.startswith(INTEGRATED)}
    third = ClutterTask("environment 3", SceneOptions(3), computed, seeds[:1], 60)
    return [*runs, clutter_runs(third)]


@pytest.fixture(scope="module")
def rows(results: list[tuple[ClutterRun, ...]]) -> tuple[StudyRow, ...]:
    return study.rows(results)


def metric(rows: tuple[StudyRow, ...], system: str, number: int, name: str) -> float:
    (row,) = (
        row for row in rows if row.system == system and row.condition == f"environment {number}"
    )
    return row.metrics[name]


@pytest.mark.parametrize("number", [1, 2])
def test_hpda_counts_better_than_its_rivals(rows: tuple[StudyRow, ...], number: int) -> None:
    for hpda in (HPDA_PARTICLE, HPDA_KALMAN):
        own = metric(rows, hpda, number, "count_error")
        assert own < 0.75 * metric(rows, PHD, number, "count_error")
        assert own < 0.5 * metric(rows, CLUSTERING_LITERAL, number, "count_error")


@pytest.mark.parametrize("number", [1, 2])
def test_the_default_is_at_least_as_good_as_hpda(rows: tuple[StudyRow, ...], number: int) -> None:
    for name in ("count_error", "ospa_m"):
        own = metric(rows, INTEGRATED, number, name)
        assert own <= 1.02 * metric(rows, HPDA_KALMAN, number, name)


def test_clustering_counts_too_few(rows: tuple[StudyRow, ...]) -> None:
    assert metric(rows, CLUSTERING_LITERAL, 2, "count_bias") < -0.3


@pytest.mark.parametrize(("number", "ospa", "held"), [(1, 35.0, 0.95), (2, 50.0, 0.90)])
def test_figures_of_the_default(
    rows: tuple[StudyRow, ...], number: int, ospa: float, held: float
) -> None:
    assert metric(rows, INTEGRATED, number, "ospa_m") < ospa
    assert metric(rows, INTEGRATED, number, "held_share") > held
    assert metric(rows, INTEGRATED, number, "confirmation_delay_pings") < 8.0


def test_no_tracker_beats_the_bound(rows: tuple[StudyRow, ...]) -> None:
    for number in (1, 2):
        bound = metric(rows, BOUND, number, "settled_rmse_m")
        assert 12.0 < bound < 20.0
        for name in (INTEGRATED, HPDA_KALMAN, HPDA_PARTICLE):
            assert metric(rows, name, number, "settled_rmse_m") > 0.95 * bound


def test_computed_thresholds_work_in_the_scene(rows: tuple[StudyRow, ...]) -> None:
    closed = metric(rows, f"{INTEGRATED}, closed form", 3, "ospa_m")
    assert closed < 1.1 * metric(rows, f"{INTEGRATED}, 0.001", 3, "ospa_m")


def test_scene_is_that_of_the_paper() -> None:
    pings = simulate_scene(SceneOptions(1), np.random.SeedSequence(3))
    count = np.array([len(ping.target_id) for ping in pings])
    for first, last, expected in ((0, 99, 1), (100, 149, 2), (150, 200, 4), (201, 249, 3)):
        assert np.all(count[first : last + 1] == expected)
    for first, last, expected in ((250, 299, 4), (300, 350, 5), (351, 400, 3), (401, 449, 2)):
        assert np.all(count[first : last + 1] == expected)
    assert len(pings) == N_PINGS
    assert pings[1].contacts.stamp - EPOCH == PING_INTERVAL * 1e9
    clutter = np.mean([len(ping.contacts.range) for ping in pings[:100]])
    assert clutter == pytest.approx(10.9, abs=1.3)


def test_targets_turn_when_they_should() -> None:
    generators = np.random.default_rng(1), np.random.default_rng(1)
    turned, straight = make_targets(True, generators[0]), make_targets(False, generators[1])
    for one, other in zip(turned, straight, strict=True):
        angles = [
            np.arctan2(*one_path.path.state(one_path.last_time).velocity[::-1])
            for one_path in (one, other)
        ]
        assert abs(np.sin(0.5 * (angles[0] - angles[1]))) > 0.15


def test_bound_shrinks_with_detection() -> None:
    bounds = []
    for number in (1, 2):
        options = SceneOptions(number, turns=False)
        pings = simulate_scene(options, np.random.SeedSequence(4), 150)
        (bound,) = position_bounds(options, [pings], 20)
        bounds.append(np.sqrt(np.mean(bound)))
    assert 10.0 < bounds[0] < bounds[1] < 25.0


def test_study_is_known_by_name_and_draws(
    results: list[tuple[ClutterRun, ...]], rows: tuple[StudyRow, ...], tmp_path: Path
) -> None:
    assert STUDIES["multi-target-clutter"] is MULTI_TARGET_CLUTTER
    tasks = MULTI_TARGET_CLUTTER.tasks(21, 1)
    assert sum(len(task.argument.seeds) for task in tasks) == 105
    begins = [True, False]
    assert [task.argument.timed for task in tasks] == [*2 * begins, *begins, False, *2 * begins]
    trackers = [len(task.argument.systems) for task in tasks]
    assert trackers == sorted(trackers, reverse=True), "short tasks are the last"
    pictures = MULTI_TARGET_CLUTTER.draw(results, rows, tmp_path)
    assert len(pictures) == 6
    assert all(picture.stat().st_size > 10_000 for picture in pictures)
