"""Study tma-frequency-fusion: Table 3 of Cheong (2011), and what it does not show.

S1 is the paper's scenario, where own ship's turns alone make the range observable: the estimator
that hears no line at all does as well as the best, and the gap between the published ones is made
by their restarts. S2 and S3, where own ship goes straight on, tell what Doppler adds. The last row
of each scenario is what no estimator can beat.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from sonar_tracking.evaluation.monte_carlo.batch_runner import RunBatch, Task, run_batches
from sonar_tracking.evaluation.monte_carlo.study import StudyRow
from sonar_tracking.evaluation.monte_carlo.study_definition import (
    Column,
    StudyDefinition,
    TableLayout,
)
from sonar_tracking.evaluation.studies.tma_frequency_fusion.batch_rows import (
    BatchHistories,
    batch_rows,
    estimate_whole_batch,
)
from sonar_tracking.evaluation.studies.tma_frequency_fusion.cases import (
    CASES,
    case_bound,
    case_rows,
    estimate_case,
)
from sonar_tracking.evaluation.studies.tma_frequency_fusion.figures import draw_errors, draw_scene
from sonar_tracking.evaluation.studies.tma_frequency_fusion.histories import (
    TmaHistories,
    frame_metrics,
    joined,
)
from sonar_tracking.evaluation.studies.tma_frequency_fusion.observability_rows import (
    ObservabilityPart,
    ObservabilityResult,
    observability_cases,
    observability_rows,
    observe_cases,
)
from sonar_tracking.evaluation.studies.tma_frequency_fusion.random_scenes import (
    RUNS_PER_SCENE,
    RandomSceneResults,
    estimate_random_scenes,
    random_scene_rows,
)
from sonar_tracking.evaluation.studies.tma_frequency_fusion.runs import (
    BOUND_PATHS,
    SceneBatch,
    SceneBound,
    SceneHistories,
    bound_of,
    estimate_batch,
)
from sonar_tracking.evaluation.studies.tma_frequency_fusion.systems import (
    CHAN,
    JAUFFRET,
    PROPOSED,
    SYSTEMS,
)
from sonar_tracking.records.arrays import FloatArray

SCENARIOS = {
    "S1": "S1, own ship turns, lines 1 Hz",
    "S2": "S2, own ship straight, lines 1 Hz",
    "S3": "S3, own ship straight, lines 0.05 Hz",
}
"""What stands over the rows of each."""

FRAMES = (199, 249, 299, 349)
"""Frames shown beside the last one."""

BOUND = "bound"

RUNS_PER_TASK, SCENES_PER_TASK = 100, 5
"""Runs computed together: a frame of a hundred costs little more than one of twenty."""

PUBLISHED = {
    PROPOSED: (102.0, 0.07, 7.3, 0.5),
    CHAN: (481.0, 0.17, 49.3, 2.7),
    JAUFFRET: (330.0, 0.13, 40.1, 2.0),
}
"""Table 3 of the paper: range (m), bearing (deg), course (deg), speed (m/s), 100 runs."""

ERRORS = ("range_rmse_m", "bearing_rmse_deg", "course_rmse_deg", "speed_rmse_m_s")

LAYOUTS = (
    TableLayout(
        "Errors in the last frame",
        (
            Column("range_rmse_m", "range", ".0f"),
            Column("bearing_rmse_deg", "bearing", ".3f"),
            Column("course_rmse_deg", "course", ".1f"),
            Column("speed_rmse_m_s", "speed", ".2f"),
            Column("range_median_m", "median", ".0f"),
            Column("range_per_bound", "/bound", ".2f"),
            Column("nees_per_dimension", "NEES", ".2f"),
            Column("lost_percent", "lost %", ".1f"),
        ),
        "RMSE in m, deg, deg, m/s. median: of the range error. /bound: range RMSE over the root of "
        "the posterior bound. NEES: per dimension, 1 = the claimed covariance is right. lost: "
        "range error beyond 5 bounds. bearings only: the default given no lines; where it "
        "does as well, Doppler added nothing.",
        condition="S",
    ),
    TableLayout(
        "Range RMSE over the bound, by frame",
        tuple(Column(f"range_per_bound_{frame}", str(frame), ".2f") for frame in FRAMES),
        "",
        condition="S",
    ),
    TableLayout(
        "What goes wrong at sea",
        (
            Column("case_range_rmse_m", "range", ".0f"),
            Column("range_per_bound", "/bound", ".2f"),
            Column("range_per_clean", "/clean", ".2f"),
            Column("nees_settled", "NEES", ".2f"),
            Column("manoeuvre_percent", "manoeuvre %", ".1f"),
            Column("reborn_percent", "reborn %", ".1f"),
        ),
        "/clean: over the RMSE of the same runs with nothing wrong. NEES: the largest from frame "
        "330 on. manoeuvre, reborn: share of runs with such an alarm from frame 250 on.",
    ),
    TableLayout(
        "All frames at once",
        (
            Column("batch_range_rmse_m", "range", ".0f"),
            Column("range_per_bound", "/bound", ".2f"),
            Column("nees_per_dimension", "NEES", ".2f"),
            Column("lost_percent", "lost %", ".1f"),
        ),
        "maximum likelihood takes the target to move straight: where it does not, its covariance "
        "is wrong.",
    ),
    TableLayout(
        "Random scenes",
        (
            Column("random_per_bound", "range/bound", ".2f"),
            Column("random_median_per_bound", "median", ".2f"),
            Column("random_lost_percent", "lost %", ".1f"),
            Column("random_nees", "NEES", ".2f"),
            Column("scenes", "scenes", ".0f"),
        ),
        "Of the last frame; only scenes whose bound is below a tenth of the range.",
    ),
    TableLayout(
        "What is said to be known",
        (
            Column("observability", "observability", ".3f"),
            Column("unobservable_percent", "unobservable %", ".0f"),
            Column("early_sides", "sides at first", ".1f"),
            Column("last_sides", "at last", ".1f"),
            Column("right_side_percent", "right side %", ".0f"),
        ),
        "In the last frame, of a few runs; below 0.5 the range is what was assumed, not what was "
        "measured. sides: solutions that stand before own ship's first turn and in the last frame.",
    ),
)


def tasks(runs: int, seed: int) -> tuple[Task, ...]:
    """Return what the workers compute: every batch of every scenario, and the bounds."""
    batches = run_batches(runs, seed, size=RUNS_PER_TASK)
    paths = RunBatch(0, tuple(np.random.SeedSequence((seed, 1)).spawn(BOUND_PATHS)))
    scenes = run_batches(max(1, runs // RUNS_PER_SCENE), seed, part=2, size=SCENES_PER_TASK)
    return (
        *(Task(bound_of, SceneBatch(name, paths)) for name in SCENARIOS),
        *(Task(case_bound, SceneBatch(name, paths)) for name in CASES if CASES[name].changes_scene),
        *(Task(estimate_batch, SceneBatch(name, batch)) for name in SCENARIOS for batch in batches),
        *(Task(estimate_case, SceneBatch(name, batch)) for name in CASES for batch in batches),
        *(Task(estimate_whole_batch, batch) for batch in batches),
        *(
            Task(observe_cases, ObservabilityPart(case, batches[0]))
            for case in observability_cases()
        ),
        *(Task(estimate_random_scenes, batch) for batch in scenes),
    )


def rows(results: Sequence[Any]) -> tuple[StudyRow, ...]:
    """Turn the results of the tasks into rows."""
    bounds, histories = _bounds(results), _histories(results)
    table = []
    for name, condition in SCENARIOS.items():
        bound = bounds[name]
        for system in SYSTEMS:
            metrics = _metrics(histories[name][system], bound)
            published = PUBLISHED.get(system, ()) if name == "S1" else ()
            table.append(
                StudyRow(system, condition, metrics, dict(zip(ERRORS, published, strict=False)))
            )
        best = dict(zip(ERRORS, bound[-1].tolist(), strict=True))
        table.append(StudyRow(BOUND, condition, best))
    whole = [one for one in results if isinstance(one, BatchHistories)]
    scenes = [one for one in results if isinstance(one, RandomSceneResults)]
    return (
        *table,
        *case_rows(histories, bounds),
        *batch_rows(whole, bounds["S1"]),
        *random_scene_rows(scenes),
        *observability_rows([one for one in results if isinstance(one, ObservabilityResult)]),
    )


def draw(results: Sequence[Any], rows: Sequence[StudyRow], directory: Path) -> tuple[Path, ...]:
    """Write the figures: geometry and lines (Figs. 2, 3), errors over time (Figs. 4-7)."""
    bounds, histories = _bounds(results), _histories(results)
    pictures = []
    for name, condition in SCENARIOS.items():
        pictures.append(draw_scene(directory / f"{name}_scene.png", name, condition))
        path = directory / f"{name}_errors.png"
        pictures.append(draw_errors(path, condition, histories[name], bounds[name]))
    return tuple(pictures)


def _metrics(histories: TmaHistories, bound: FloatArray) -> dict[str, float]:
    metrics = frame_metrics(histories, bound, -1)
    for frame in FRAMES:
        at_frame = frame_metrics(histories, bound, frame)
        metrics[f"range_per_bound_{frame}"] = at_frame["range_per_bound"]
        metrics[f"nees_per_dimension_{frame}"] = at_frame["nees_per_dimension"]
    alarms = int(np.count_nonzero(histories.manoeuvre))
    metrics["frames_per_alarm"] = histories.manoeuvre.size / alarms if alarms else np.inf
    return metrics


def _bounds(results: Sequence[Any]) -> dict[str, FloatArray]:
    return {one.scenario: one.bound for one in results if isinstance(one, SceneBound)}


def _histories(results: Sequence[Any]) -> dict[str, dict[str, TmaHistories]]:
    parts = [one for one in results if isinstance(one, SceneHistories)]
    grouped: dict[str, dict[str, list[TmaHistories]]] = {}
    for part in parts:
        for system, one in part.systems.items():
            grouped.setdefault(part.scenario, {}).setdefault(system, []).append(one)
    return {
        name: {system: joined(own) for system, own in systems.items()}
        for name, systems in grouped.items()
    }


TMA_FREQUENCY_FUSION = StudyDefinition(
    name="tma-frequency-fusion",
    description="positions from bearings and intermittent lines, against the published methods",
    default_runs=400,
    tasks=tasks,
    rows=rows,
    layouts=LAYOUTS,
    draw=draw,
)
