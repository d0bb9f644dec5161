"""The least error possible under a condition: of a tracker that is told everything."""

from __future__ import annotations

import numpy as np

from sonar_tracking.evaluation.monte_carlo.run_synthesis import true_bearings
from sonar_tracking.evaluation.monte_carlo.tracking_bound import tracking_bound
from sonar_tracking.evaluation.studies.mismatch_bearings.condition import Condition
from sonar_tracking.evaluation.studies.mismatch_bearings.runs import (
    TOLD_ANGLE_VARIANCE_DEG2,
    TOLD_RATE_VARIANCE_DEG2,
)
from sonar_tracking.filtering.constant_velocity import process_noise_matrix, transition_matrix
from sonar_tracking.passive.performance.fisher_information import stochastic_fisher_information

_SQUARE_DEGREE = np.radians(1.0) ** 2


def bound_deg2(condition: Condition) -> float:
    """Return the bound on the mean square error of the bearings, deg^2; NaN without targets.

    Parameters
    ----------
    condition : Condition
        Coherent sources count as incoherent ones.
    """
    scenario, estimator = condition.scenario, condition.estimator
    if not scenario.targets:
        return float("nan")
    times = np.arange(estimator.period, scenario.duration, estimator.period)
    angles, _ = true_bearings(scenario, times)
    levels = np.array([target.level_db for target in scenario.targets])
    information = stochastic_fisher_information(
        scenario.array.element_positions(),
        angles,
        scenario.array.wavenumber(),
        np.diag(10.0 ** (levels / 10.0)).astype(np.complex128),
        1.0,
        estimator.covariance_snapshots,
        condition.noise_covariance(),
    )
    variances = tracking_bound(
        information,
        transition_matrix(estimator.period),
        process_noise_matrix(condition.told_process_noise_deg2 * _SQUARE_DEGREE, estimator.period),
        np.diag([TOLD_ANGLE_VARIANCE_DEG2, TOLD_RATE_VARIANCE_DEG2]) * _SQUARE_DEGREE,
    )
    return float(np.mean(variances)) / _SQUARE_DEGREE
