"""Check of the fused variance: that of the mean over seven adjacent subspaces.

Five separated sources that do not move are seen through PAST. The angular innovations at the true
bearings are pure measurement error: their variance in one subspace, and that of their mean over
seven adjacent ones, are compared with what the paper's equation (14) claims and with what the
correlation of adjacent subspaces gives. Both claims start from the measured variance of one
subspace, so that only the fusion is judged.

References
----------
Ryu, Park, Choi (2003), eqs. 10 and 14.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sonar_tracking.evaluation.monte_carlo.batch_runner import RunBatch
from sonar_tracking.evaluation.monte_carlo.run_synthesis import snapshot_blocks, true_bearings
from sonar_tracking.evaluation.monte_carlo.study import StudyRow
from sonar_tracking.evaluation.studies.doa_fusion.systems import N_SUBSPACES
from sonar_tracking.passive.directions.angular_innovation import angular_innovations
from sonar_tracking.passive.directions.measurement_fusion import (
    correlated_variance_ratio,
    fused_measurement,
    independent_variance_ratio,
)
from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration
from sonar_tracking.passive.subspaces.subspace_stage import SubspaceStage
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.simulation.scenarios.bearing_motion import LinearMotion
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario
from sonar_tracking.simulation.scenarios.target import TargetConfiguration

FORGETTING_FACTORS = (0.86, 0.90, 0.95, 0.97, 0.99)

LEVELS_DB = (-5, 0)

BEARINGS_DEG = (-50.0, -25.0, 0.0, 25.0, 50.0)
"""More than three beamwidths apart."""

WARM_UP_PERIODS = 3
"""600 snapshots: the start from the identity is forgotten at every forgetting factor."""

SCORED_PERIODS = 6

BLOCK_SNAPSHOTS = 200


def static_scenario() -> Scenario:
    """Return the array of the doa-fusion scenario with five sources that do not move."""
    return replace(
        load_scenario("doa_fusion"),
        targets=tuple(
            TargetConfiguration(motion=LinearMotion(offset_deg=bearing)) for bearing in BEARINGS_DEG
        ),
        start=-float(WARM_UP_PERIODS),
        duration=float(WARM_UP_PERIODS + SCORED_PERIODS),
    )


def measure_batch(batch: RunBatch) -> FloatArray:
    """Measure innovations at the true bearings in every subspace.

    Parameters
    ----------
    batch : RunBatch
        Which runs.

    Returns
    -------
    ndarray, shape (n_factors, n_levels, n_runs, n_periods, n_subspaces, n_targets)
        rad.
    """
    scenario = static_scenario()
    angles = true_bearings(scenario, np.zeros(1))[0][0]
    stages = [
        SubspaceStage(
            SubspaceConfiguration(
                method="past",
                forgetting_factor=factor,
                period=1.0,
                source_count=len(angles),
                n_subspaces=N_SUBSPACES,
                covariance_snapshots=0,
            )
        )
        for factor in FORGETTING_FACTORS
    ]
    measured: list[list[FloatArray]] = [[] for _ in stages]
    for block in snapshot_blocks(scenario, batch.seeds, LEVELS_DB, BLOCK_SNAPSHOTS):
        for stage, innovations in zip(stages, measured, strict=True):
            for estimates in stage.update(block).estimates:
                complete = len(estimates.time_offsets) == N_SUBSPACES
                if estimates.stamp >= scenario.stamp(0.0) and complete:
                    innovations.append(
                        angular_innovations(
                            estimates.basis,
                            estimates.element_positions,
                            angles,
                            scenario.array.wavenumber(),
                        )
                    )
    return np.array([np.stack(innovations, axis=-3) for innovations in measured])


def fused_variance_rows(results: Sequence[FloatArray]) -> tuple[StudyRow, ...]:
    """Turn the innovations of all batches into rows.

    Parameters
    ----------
    results : sequence of ndarray, shape (n_factors, n_levels, n_runs, ...)
        What :func:`measure_batch` returned for each batch, rad.
    """
    innovations = np.concatenate(results, axis=2)
    period = 1.0 / static_scenario().array.snapshot_rate
    half = (N_SUBSPACES - 1) // 2
    offsets: FloatArray = np.linspace(-half * period, half * period, N_SUBSPACES, dtype=np.float64)
    return tuple(
        StudyRow(
            f"beta {factor:.2f}",
            f"static, {level} dB",
            variance_metrics(
                innovations[i, j],
                independent_variance_ratio(N_SUBSPACES),
                correlated_variance_ratio(offsets, period, factor),
            )
            | {"forgetting_factor": factor, "level_db": level},
        )
        for j, level in enumerate(LEVELS_DB)
        for i, factor in enumerate(FORGETTING_FACTORS)
    )


def variance_metrics(
    innovations: FloatArray, independent_ratio: float, correlated_ratio: float
) -> dict[str, float]:
    """Compare the variance of the fused measurement with the two claims.

    Parameters
    ----------
    innovations : ndarray, shape (n_runs, n_periods, n_subspaces, n_targets)
        At the true bearings, rad.
    independent_ratio, correlated_ratio : float
        Claimed variance of the fused measurement relative to that of one subspace.

    Returns
    -------
    dict of str to float
        Measured and claimed ratios; NIS of a filter that knows the variance of one subspace and
        believes the claim; claimed over measured variance.
    """
    middle = innovations[..., innovations.shape[-2] // 2, :]
    single = np.mean(np.var(middle, axis=(0, 1)))
    fused = np.mean(np.var(fused_measurement(innovations), axis=(0, 1)))
    ratio = float(fused / single)
    return {
        "variance_ratio": ratio,
        "independent_ratio": independent_ratio,
        "correlated_ratio": correlated_ratio,
        "nis_independent": ratio / independent_ratio,
        "nis_correlated": ratio / correlated_ratio,
        "claimed_over_measured_independent": independent_ratio / ratio,
        "claimed_over_measured_correlated": correlated_ratio / ratio,
        "standard_deviation_deg": float(np.degrees(np.sqrt(single))),
    }
