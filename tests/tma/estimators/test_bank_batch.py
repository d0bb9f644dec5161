"""Protects the reductions over the hypotheses of each run, and that runs are given back whole."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.tma.estimators.bank_batch import RunRows, join_banks, separate_banks
from sonar_tracking.tma.estimators.error_models import ErrorEvidence, no_evidence
from sonar_tracking.tma.estimators.innovation_monitor import empty_windows
from sonar_tracking.tma.estimators.range_bank_state import RangeBankState
from sonar_tracking.tma.estimators.sensor_frame import TmaMeasurement
from tests.tma.estimators.test_hypothesis_bank import random_bank

ROWS = RunRows(np.array([2, 1, 3]))


def test_reductions_are_those_of_each_run() -> None:
    assert ROWS.owner.tolist() == [0, 0, 1, 2, 2, 2]
    assert ROWS.starts.tolist() == [0, 2, 3]
    values = np.array([[1.0, 10.0], [2.0, 20.0], [3.0, 30.0], [4.0, 40.0], [5.0, 50.0], [6.0, 6.0]])
    assert ROWS.sums(values).tolist() == [[3.0, 30.0], [3.0, 30.0], [15.0, 96.0]]
    logs = np.log([1.0, 3.0, 7.0, 0.5, 0.25, 0.25])
    assert np.exp(ROWS.log_sums(logs)) == pytest.approx([4.0, 7.0, 1.0])
    marked = np.array([True, False, True, False, False, False])
    assert ROWS.any(marked).tolist() == [True, True, False]
    assert ROWS.all(marked).tolist() == [False, True, False]


def test_runs_of_any_shape_are_joined_and_given_back() -> None:
    states, measurements = [], []
    shapes: list[tuple[int, ...]] = [(), (4,), (2, 3)]
    for shape in shapes:
        bank = random_bank(2, batch=shape)
        nothing = np.zeros(shape, np.int64)
        errors = no_evidence(shape, 2)
        errors = ErrorEvidence(errors.table + len(shape), errors.stamp + 7)
        windows, since = empty_windows(shape, 2), np.full(shape, 0.5 + len(shape))
        states.append(RangeBankState(0, bank, windows, errors, nothing, since))
        measurements.append(
            TmaMeasurement(
                stamp=3 * 10**9,
                position=np.full(2, float(len(shape))),
                velocity=np.zeros(2),
                azimuth=np.array([0.5, 1.5][: 1 + len(shape)][:2]),
                azimuth_variance=np.array(1e-4),
                frequency=np.array([100.0, np.nan]),
                frequency_deviation=np.array([0.1, np.nan]),
            )
        )
    batch = join_banks(states, measurements)
    n_components = states[0].bank.log_weight.shape[-1]
    assert batch.rows.counts.tolist() == [n_components] * 11
    assert batch.interval.tolist() == [3.0] * 11
    assert batch.measurement.position[:, 0].tolist() == (
        [0.0] * n_components + [1.0] * 4 * n_components + [2.0] * 6 * n_components
    )
    assert batch.measurement.azimuth.shape == (11 * n_components, 2)
    assert batch.measurement.azimuth[0].tolist() == [0.5, 0.5]
    assert batch.measurement.azimuth[-1].tolist() == [0.5, 1.5]
    for before, after in zip(states, separate_banks(states, batch, 9), strict=True):
        assert after.stamp == 9
        for name in ("mean", "covariance", "log_weight", "known"):
            np.testing.assert_array_equal(getattr(after.bank, name), getattr(before.bank, name))
        np.testing.assert_array_equal(after.errors.table, before.errors.table)
        np.testing.assert_array_equal(after.errors.stamp, before.errors.stamp)
        assert after.windows.lines.shape == before.windows.lines.shape
