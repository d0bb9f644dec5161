"""Study doa-fusion: Table 1 of Ryu, Park and Choi (2003), with what the paper leaves out.

Five targets cross eight times in 40 s. Tracked by one subspace a second (RYU) and by the fusion of
seven (PROPOSED), as in the paper; by the two ablations that tell the effect of averaging from that
of the smaller claimed variance; by PROPOSED with the variance that accounts for the correlation of
adjacent subspaces; by PROPOSED when it has to find the bearings itself; and by one joint filter
that measures in the covariance of a block, causal or centred. The last row of each level is what
no tracker can beat. A second table shows the consistency of trackers that take their measurement
variance from the data, a third one checks the claimed fused variance.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from sonar_tracking.evaluation.monte_carlo.batch_runner import Task, run_batches
from sonar_tracking.evaluation.monte_carlo.bearing_histories import (
    BearingHistories,
    bearing_metrics,
    joined,
)
from sonar_tracking.evaluation.monte_carlo.run_synthesis import true_bearings
from sonar_tracking.evaluation.monte_carlo.study import StudyRow
from sonar_tracking.evaluation.monte_carlo.study_definition import (
    Column,
    StudyDefinition,
    TableLayout,
)
from sonar_tracking.evaluation.monte_carlo.tracking_bound import tracking_bound
from sonar_tracking.evaluation.studies.doa_fusion.calibrated_consistency import (
    CalibratedRuns,
    calibrated_batch,
)
from sonar_tracking.evaluation.studies.doa_fusion.figures import (
    draw_fused_variance,
    draw_levels,
    draw_run,
    failed_run,
    typical_run,
)
from sonar_tracking.evaluation.studies.doa_fusion.fused_variance import (
    fused_variance_rows,
    measure_batch,
)
from sonar_tracking.evaluation.studies.doa_fusion.joint_map_runs import (
    BLOCKS,
    JointRuns,
    joint_batch,
)
from sonar_tracking.evaluation.studies.doa_fusion.runs import (
    LEVELS_DB,
    STEP_TIMES,
    fusion_scenario,
    track_batch,
)
from sonar_tracking.evaluation.studies.doa_fusion.systems import (
    AUTOMATIC,
    INITIAL_ANGLE_VARIANCE_DEG2,
    INITIAL_RATE_VARIANCE_DEG2,
    PROPOSED,
    RYU,
    SYSTEMS,
)
from sonar_tracking.filtering.constant_velocity import process_noise_matrix, transition_matrix
from sonar_tracking.passive.performance.fisher_information import stochastic_fisher_information
from sonar_tracking.records.arrays import FloatArray

BOUND = "tracking bound"

BOUND_PROCESS_NOISE_DEG2 = 0.01
"""About (largest bearing acceleration x sample period)^2: what the targets really do, deg^2/s^3."""

PUBLISHED = {
    RYU: ((1.182, 73.0), (0.621, 94.0), (0.371, 98.0)),
    PROPOSED: ((0.454, 97.0), (0.279, 98.0), (0.192, 98.0)),
}
"""Table 1 of the paper: mean square error (deg^2) and success (%) at each level."""

LAYOUTS = (
    TableLayout(
        "Five crossing targets, 40 s",
        (
            Column("mse_deg2", "MSE", ".3f"),
            Column("success_percent", "success", ".0f"),
            Column("median_mse_deg2", "median", ".3f"),
            Column("rmse_deg", "RMSE", ".2f"),
            Column("nis_per_dimension", "NIS", ".3f"),
            Column("nees_per_dimension", "NEES", ".2f"),
            Column("rmse_over_bound", "/ bound", ".2f"),
        ),
        "MSE: deg², over successful runs (every error below 3 deg in the last 5 s; success in %). "
        "median: of the MSE over all runs. RMSE: deg, over all runs. NIS, NEES: per dimension, of "
        "successful runs; 1 = the claimed covariance is right, less = pessimistic. average only: "
        "the mean of 7 subspaces, believed no better than one. R/7 only: one subspace, believed as "
        "good as 7. correlated variance: PROPOSED, believing what the second table confirms. "
        "automatic start: PROPOSED, not given the first bearings. joint MAP: one filter over all "
        "targets, q 0.01 deg²/s³; causal: of the last 200 snapshots; centred: of 199 around the "
        "sample time, half a second late; default q: causal, not knowing that these targets turn. "
        "/ bound: root of the MSE over that of the bound.",
        condition="SNR",
    ),
    TableLayout(
        "The same targets, measurement variance from the data",
        (
            Column("mse_deg2", "MSE", ".3f"),
            Column("success_percent", "success", ".0f"),
            Column("nis_per_dimension", "NIS", ".2f"),
            Column("nees_per_dimension", "NEES", ".2f"),
            Column("nees_band_low", "from", ".2f"),
            Column("nees_band_high", "to", ".2f"),
        ),
        "R from the Fisher information, q 0.01 deg²/s³, beta 0.95. eq. 14: R/7 is believed; "
        "correlated: what the correlation of adjacent subspaces leaves. from, to: 95 % band of "
        "the NEES of a consistent filter in as many runs.",
        condition="calibrated",
    ),
    TableLayout(
        "Variance of the mean of 7 subspaces relative to one",
        (
            Column("variance_ratio", "measured", ".3f"),
            Column("independent_ratio", "eq. 14", ".3f"),
            Column("nis_independent", "NIS", ".2f"),
            Column("correlated_ratio", "correlated", ".3f"),
            Column("nis_correlated", "NIS", ".2f"),
        ),
        "Claims and the NIS of a filter that believes them. correlated: the mean of beta^|i-j|.",
    ),
)


def tasks(runs: int, seed: int) -> tuple[Task, ...]:
    """Return what the workers compute: tracked runs, those of other trackers, fused variances."""
    tracked = [Task(track_batch, batch) for batch in run_batches(runs, seed, part=0)]
    checked = [Task(measure_batch, batch) for batch in run_batches(runs, seed, part=1)]
    calibrated = [Task(calibrated_batch, batch) for batch in run_batches(runs, seed, part=0)]
    joint = [Task(joint_batch, batch) for batch in run_batches(runs, seed, part=0)]
    return (*tracked, *calibrated, *joint, *checked)


def rows(results: Sequence[Any]) -> tuple[StudyRow, ...]:
    """Turn the results of the tasks into rows."""
    calibrated = _histories(results, CalibratedRuns)
    histories = _tracked(results) | _histories(results, JointRuns)
    truth, _ = true_bearings(fusion_scenario(), STEP_TIMES)
    table: list[StudyRow] = []
    for index, level in enumerate(LEVELS_DB):
        condition = f"SNR {level} dB"
        bound = float(np.mean(bound_deg2(level)))
        for name in (*(system.name for system in SYSTEMS), AUTOMATIC, *BLOCKS):
            metrics = bearing_metrics(_at_level(histories[name], index), truth)
            metrics["rmse_over_bound"] = float(np.sqrt(metrics["mse_deg2"] / bound))
            table.append(StudyRow(name, condition, metrics, _published(name, index)))
        table.append(StudyRow(BOUND, condition, {"mse_deg2": bound, "rmse_deg": np.sqrt(bound)}))
    for index, level in enumerate(LEVELS_DB):
        for name, one in calibrated.items():
            metrics = bearing_metrics(_at_level(one, index), truth)
            table.append(StudyRow(name, f"calibrated, SNR {level} dB", metrics))
    return (*table, *fused_variance_rows(_checked(results)))


def bound_deg2(level_db: float) -> FloatArray:
    """Return the tracking bound along the true path.

    Parameters
    ----------
    level_db : float
        Signal power over noise power per element, dB.

    Returns
    -------
    ndarray, shape (n_steps, n_targets)
        deg^2, with the snapshots of a whole period a step.
    """
    scenario = fusion_scenario()
    angles, _ = true_bearings(scenario, STEP_TIMES)
    information = stochastic_fisher_information(
        scenario.array.element_positions(),
        angles,
        scenario.array.wavenumber(),
        10.0 ** (level_db / 10.0) * np.eye(angles.shape[1], dtype=np.complex128),
        1.0,
        scenario.array.snapshot_rate,
    )
    square_degree = np.radians(1.0) ** 2
    variances = tracking_bound(
        information,
        transition_matrix(1.0),
        process_noise_matrix(BOUND_PROCESS_NOISE_DEG2 * square_degree, 1.0),
        np.diag([INITIAL_ANGLE_VARIANCE_DEG2, INITIAL_RATE_VARIANCE_DEG2]) * square_degree,
    )
    return variances / square_degree


def draw(results: Sequence[Any], rows: Sequence[StudyRow], directory: Path) -> tuple[Path, ...]:
    """Write the figures: Figs. 2 and 3 of the paper, its table, and the fused variance."""
    histories = _tracked(results)
    truth, _ = true_bearings(fusion_scenario(), STEP_TIMES)
    angles = {name: histories[name].angle[0] for name in (RYU, PROPOSED)}
    typical = typical_run(list(angles.values()), truth)
    pictures = [
        draw_run(
            directory / "figure_2_typical_run.png",
            f"A typical run at SNR {LEVELS_DB[0]} dB (run {typical})",
            STEP_TIMES,
            truth,
            {name: angle[typical] for name, angle in angles.items()},
        )
    ]
    failed = failed_run(angles[RYU], angles[PROPOSED], truth)
    if failed is not None:
        pictures.append(
            draw_run(
                directory / "figure_3_failed_run.png",
                f"A run in which {RYU} fails, at SNR {LEVELS_DB[0]} dB (run {failed})",
                STEP_TIMES,
                truth,
                {name: angle[failed] for name, angle in angles.items()},
            )
        )
    pictures.append(draw_levels(directory / "table_1_levels.png", rows, LEVELS_DB))
    pictures.append(draw_fused_variance(directory / "fused_variance.png", rows))
    return tuple(pictures)


def _tracked(results: Sequence[Any]) -> dict[str, BearingHistories]:
    parts = [result for result in results if isinstance(result, dict)]
    return {name: joined([part[name] for part in parts]) for name in parts[0]}


def _histories(
    results: Sequence[Any], kind: type[CalibratedRuns] | type[JointRuns]
) -> dict[str, BearingHistories]:
    parts = [result.histories for result in results if isinstance(result, kind)]
    return {name: joined([part[name] for part in parts]) for name in parts[0]}


def _checked(results: Sequence[Any]) -> list[FloatArray]:
    return [result for result in results if isinstance(result, np.ndarray)]


def _at_level(histories: BearingHistories, index: int) -> BearingHistories:
    return BearingHistories(
        histories.angle[index],
        histories.nis[index],
        histories.nees[index],
        histories.swaps[index],
    )


def _published(system: str, index: int) -> dict[str, float]:
    if system not in PUBLISHED:
        return {}
    error, success = PUBLISHED[system][index]
    return {"mse_deg2": error, "success_percent": success}


DOA_FUSION = StudyDefinition(
    name="doa-fusion",
    description="fusion of adjacent signal subspaces against one subspace, five crossing targets",
    default_runs=100,
    tasks=tasks,
    rows=rows,
    layouts=LAYOUTS,
    draw=draw,
)
