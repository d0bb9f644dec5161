"""Study multi-target-clutter: Figs. 4 to 9 of Kim and Song (2007), with what the paper leaves out.

Six targets come, turn and go in clutter; all trackers see the same contacts. The paper's two
environments, the same without turns against the Cramer-Rao bound, and a third one in which the
detector reports nearly everything and the tracker sets the threshold in its gates. The paper shows
the run-averaged number of targets only; single runs, errors and identities are added.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from sonar_tracking.evaluation.metrics.score_statistics import mean
from sonar_tracking.evaluation.monte_carlo.batch_runner import (
    RUNS_PER_BATCH,
    Task,
    run_batches,
)
from sonar_tracking.evaluation.monte_carlo.study import StudyRow
from sonar_tracking.evaluation.monte_carlo.study_definition import (
    Column,
    StudyDefinition,
    TableLayout,
)
from sonar_tracking.evaluation.studies.multi_target_clutter.figures import (
    draw_counts,
    draw_scene,
    draw_tracks,
)
from sonar_tracking.evaluation.studies.multi_target_clutter.runs import (
    ClutterRun,
    ClutterTask,
    clutter_runs,
)
from sonar_tracking.evaluation.studies.multi_target_clutter.scene import SceneOptions
from sonar_tracking.evaluation.studies.multi_target_clutter.system_run import SystemRun
from sonar_tracking.evaluation.studies.multi_target_clutter.systems import (
    CLUSTERING,
    CLUSTERING_LITERAL,
    HPDA_KALMAN,
    HPDA_PARTICLE,
    INTEGRATED,
    INTEGRATED_DEFAULTS,
    INTEGRATED_STRAIGHT,
    PAPER_SYSTEMS,
    PHD,
    STRAIGHT_SYSTEMS,
    THRESHOLD_SYSTEMS,
)
from sonar_tracking.records.arrays import FloatArray

_PAIRED = (
    (INTEGRATED, INTEGRATED_DEFAULTS, INTEGRATED_STRAIGHT, HPDA_PARTICLE, HPDA_KALMAN),
    (CLUSTERING, CLUSTERING_LITERAL, PHD),
)
_OTHERS = tuple(name for name in PAPER_SYSTEMS if not any(name in panel for panel in _PAIRED))
PANELS = (*_PAIRED, _OTHERS) if _OTHERS else _PAIRED
"""Trackers drawn together in the pictures of the number of targets."""

BOUND = "Cramer-Rao bound"
EARLY = slice(5, 100)

RUNS_TOGETHER = {1: RUNS_PER_BATCH, 2: RUNS_PER_BATCH, 3: 10}
"""Runs of a task in each environment: the arrays of more, with two thousand contacts each, do not
stay near the processor."""

CONDITIONS = (
    ("environment 1", SceneOptions(1), PAPER_SYSTEMS),
    ("environment 2", SceneOptions(2), PAPER_SYSTEMS),
    ("straight targets, environment 1", SceneOptions(1, turns=False), STRAIGHT_SYSTEMS),
    ("straight targets, environment 2", SceneOptions(2, turns=False), STRAIGHT_SYSTEMS),
    ("environment 3", SceneOptions(3), THRESHOLD_SYSTEMS),
)
"""Name, scene and trackers of each part."""

LAYOUTS = (
    TableLayout(
        "Number of targets (Figs. 8 and 9) and sets of positions",
        (
            Column("count_curve_error", "curve", ".3f"),
            Column("count_error", "count", ".3f"),
            Column("count_bias", "bias", "+.3f"),
            Column("early_count_bias", "early", "+.3f"),
            Column("ospa_m", "OSPA", ".1f"),
            Column("gospa_m", "GOSPA", ".1f"),
            Column("cpu_ms", "ms", ".2f"),
        ),
        "Published: HPDA's number of targets is closest to the truth in both environments; in "
        "environment 2 clustering counts too few, SMC-PHD too many early. curve: mean absolute "
        "error of the run-averaged number; count: of single runs; early: pings 5 to 99. The more "
        "runs are averaged, the more the curve hides the scatter of SMC-PHD, which count shows. "
        "OSPA, GOSPA: m, cut-off 200 m, order 2. ms: processor time a ping of a tracker by "
        "itself, in the first run.",
    ),
    TableLayout(
        "Tracks",
        (
            Column("rmse_m", "RMSE", ".1f"),
            Column("settled_rmse_m", "settled", ".2f"),
            Column("held_share", "maintained", ".3f"),
            Column("continuity", "continuity", ".3f"),
            Column("identity_swaps", "swaps", ".1f"),
            Column("false_tracks_per_hour", "false/h", ".2f"),
            Column("confirmation_delay_pings", "confirmed", ".2f"),
        ),
        "Errors in m; settled: tracks older than 20 pings. swaps a run. confirmed: pings from the "
        "first appearance, inclusive. The bound knows the turns. The paper's SMC-PHD has no "
        "identities; here its peaks are joined from ping to ping.",
    ),
)


def tasks(runs: int, seed: int) -> tuple[Task, ...]:
    """Return what the workers compute: a few runs of an environment each.

    Those of most trackers come first: short tasks at the end leave no worker idle.
    """
    parts = sorted(enumerate(CONDITIONS), key=lambda part: len(part[1][2]), reverse=True)
    return tuple(
        Task(
            clutter_runs,
            ClutterTask(condition, options, systems, batch.seeds, timed=batch.first_run == 0),
        )
        for part, (condition, options, systems) in parts
        for batch in run_batches(runs, seed, part, RUNS_TOGETHER[options.environment])
    )


def rows(results: Sequence[Sequence[ClutterRun]]) -> tuple[StudyRow, ...]:
    """Turn the results of the tasks into rows."""
    table = []
    every = [run for part in results for run in part]
    for condition, *_ in CONDITIONS:
        runs = [run for run in every if run.condition == condition]
        if not runs:
            continue
        for name in runs[0].systems:
            table.append(StudyRow(name, condition, system_metrics(runs, name)))
        bound = np.concatenate([run.bound_square_error for run in runs])
        metrics = {"rmse_m": np.nan, "settled_rmse_m": float(np.sqrt(np.mean(bound)))}
        table.append(StudyRow(BOUND, condition, metrics))
    return tuple(table)


def system_metrics(runs: Sequence[ClutterRun], name: str) -> dict[str, float]:
    """Return the figures of one tracker in one environment.

    Parameters
    ----------
    runs : sequence of ClutterRun
        All of the environment.
    name : str
        Of the tracker.
    """
    own = [run.systems[name] for run in runs]
    truth = np.array([run.true_count for run in runs])
    count = np.array([run.count for run in own])
    estimated = np.array([run.n_estimates for run in own])
    curve = np.mean(count, axis=0) - np.mean(truth, axis=0)
    metrics = {
        "count_curve_error": float(np.mean(np.abs(curve))),
        "count_error": float(np.mean(np.abs(count - truth))),
        "extracted_count_error": float(np.mean(np.abs(estimated - truth))),
        "count_bias": float(np.mean(count - truth)),
        "early_count_bias": float(np.mean((count - truth)[:, EARLY])),
        "ospa_m": float(np.mean([run.ospa for run in own])),
        "gospa_m": float(np.mean([run.gospa for run in own])),
        "rmse_m": _root_mean([run.square_error for run in own]),
        "settled_rmse_m": _root_mean([run.settled_square_error for run in own]),
        "cpu_ms": 1e3 * mean([run.seconds for run in own if np.isfinite(run.seconds)]),
        "held_share": float(np.mean([run.identities.held_share for run in own])),
    }
    return {**metrics, **_identity_metrics(own)}


def _identity_metrics(runs: Sequence[SystemRun]) -> dict[str, float]:
    scores = [run.identities for run in runs]
    return {
        "continuity": float(np.mean([score.continuity for score in scores])),
        "identity_swaps": float(np.mean([score.identity_swaps for score in scores])),
        "lost_tracks": float(np.mean([score.lost_tracks for score in scores])),
        "false_tracks_per_hour": float(np.mean([s.false_tracks_per_hour for s in scores])),
        "confirmation_delay_pings": float(
            np.nanmean([score.confirmation_delay_periods for score in scores])
        ),
    }


def _root_mean(squares: Sequence[FloatArray]) -> float:
    joined = np.concatenate(squares)
    return float(np.sqrt(np.mean(joined))) if joined.size else np.nan


def draw(
    results: Sequence[Sequence[ClutterRun]], rows: Sequence[StudyRow], directory: Path
) -> tuple[Path, ...]:
    """Write the paper's figures: scene, true number, single runs, numbers of all trackers."""
    every = [run for part in results for run in part]
    first = {run.condition: run for run in reversed(every)}
    one = first["environment 1"]
    pictures = [
        draw_scene(directory / "figure_4_scene.png", one.truth),
        draw_counts(directory / "figure_5_true_number.png", [one], ()),
        draw_tracks(directory / "figure_6_hpda.png", one, HPDA_PARTICLE),
        draw_tracks(directory / "figure_7_integrated.png", one, INTEGRATED),
    ]
    for number in (1, 2):
        condition = f"environment {number}"
        runs = [run for run in every if run.condition == condition]
        path = directory / f"figure_{7 + number}_number_environment_{number}.png"
        pictures.append(draw_counts(path, runs, PANELS))
    return tuple(pictures)


MULTI_TARGET_CLUTTER = StudyDefinition(
    name="multi-target-clutter",
    description="number, positions and identities of six targets in clutter, six trackers",
    default_runs=100,
    tasks=tasks,
    rows=rows,
    layouts=LAYOUTS,
    draw=draw,
)
