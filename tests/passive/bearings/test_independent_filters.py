"""Protects the filters of single targets: their rows, their update by hand, what stops them."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.errors import Severity
from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.geometry import steering_vectors
from sonar_tracking.passive.bearings.bearing_measurement import BearingMeasurement
from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    SQUARE_DEGREE,
    BearingTrackerConfiguration,
)
from sonar_tracking.passive.bearings.independent_filters import (
    IndependentFilters,
    fused_subspace_filters,
    one_subspace_filters,
    projection_filters,
)
from tests.passive.crossing_scene import POSITIONS, WAVENUMBER
from tests.passive.estimate_scene import estimates_of

GIVEN = BearingTrackerConfiguration(
    method="ml_fusion", process_noise_deg2=0.3, measurement_variance_deg2=2.0
)
TARGET = KalmanState(np.array([[0.1, 0.02]]), np.array([np.diag([4.0, 1.0])]))


def told(angle: float, variance: float, age: float) -> IndependentFilters:
    """Return filters to which every estimate tells the same measurement."""
    measurement = BearingMeasurement(np.array([angle]), np.array([0.0]), np.array([variance]), age)
    return IndependentFilters(GIVEN, lambda *_: (measurement, ()))


def test_an_old_measurement_corrects_angle_and_rate() -> None:
    """H = [1, -2], S = 4 + 4 + 2 = 10, K = [0.4, -0.2], innovation 0.16 - 0.06 = 0.1."""
    after = told(0.16, 2.0, 2.0).update(TARGET, estimates_of(None), None)
    assert after.filters.mean == pytest.approx(np.array([[0.14, 0.0]]))
    assert after.filters.covariance[0] == pytest.approx(np.array([[2.4, 0.8], [0.8, 0.6]]))
    assert after.measurement is not None and after.notices == ()


def test_a_measurement_without_variance_is_not_used() -> None:
    after = told(0.16, np.nan, 0.0).update(TARGET, estimates_of(None), None)
    assert after.filters is TARGET and after.measurement is None
    assert [(one.severity, one.culprit) for one in after.notices] == [
        (Severity.ERROR, "measurement variance")
    ]


def test_one_unknown_variance_of_two_stops_both() -> None:
    both = BearingMeasurement(np.zeros(2), np.zeros(2), np.array([1.0, np.nan]), 0.0)
    filters = IndependentFilters(GIVEN, lambda *_: (both, ()))
    two = filters.extend(TARGET, TARGET)
    after = filters.update(two, estimates_of(None), None)
    assert after.filters is two and after.measurement is None


def test_rows_are_added_kept_and_predicted() -> None:
    filters = fused_subspace_filters(GIVEN)
    second = KalmanState(np.array([[0.5, -0.1]]), np.array([np.diag([9.0, 2.0])]))
    both = filters.extend(filters.start(TARGET), second)
    assert both.mean.tolist() == [[0.1, 0.02], [0.5, -0.1]]
    kept = filters.keep(both, np.array([1]))
    assert (kept.mean.tolist(), kept.covariance[0, 0, 0]) == ([[0.5, -0.1]], 9.0)
    later = filters.targets(filters.predict(both, 3.0))
    assert later.mean == pytest.approx(np.array([[0.16, 0.02], [0.2, -0.1]]))
    q = 0.3 * SQUARE_DEGREE
    expected = np.array([[9.0 + 9.0 * 2.0, 6.0], [6.0, 2.0]]) + q * np.array([[9, 4.5], [4.5, 3]])
    assert later.covariance[1] == pytest.approx(expected)


@pytest.mark.parametrize("make", [one_subspace_filters, fused_subspace_filters])
def test_without_a_subspace_nothing_is_measured(make: object) -> None:
    nothing = estimates_of(None, basis=np.empty((0, 15, 2), complex), time_offsets=np.empty(0))
    after = make(GIVEN).update(TARGET, nothing, None)  # type: ignore[operator]
    assert after.filters is TARGET
    assert [one.culprit for one in after.notices] == ["subspace"]


def test_one_subspace_or_the_mean_of_all() -> None:
    """The source is at 1e-4 rad at the sample time, at 0 and 5e-4 before and after it."""
    vectors = [steering_vectors(POSITIONS, np.array([a]), WAVENUMBER) for a in (0.0, 1e-4, 5e-4)]
    offsets = np.array([-0.01, 0.0, 0.01])
    estimates = estimates_of(None, basis=np.stack(vectors), time_offsets=offsets)
    target = KalmanState(np.array([[1e-4, 0.0]]), TARGET.covariance)
    for make, angle in [(one_subspace_filters, 1e-4), (fused_subspace_filters, 2e-4)]:
        measurement = make(GIVEN).update(target, estimates, None).measurement
        assert measurement is not None
        assert measurement.angle == pytest.approx([angle], abs=1e-6)


def test_a_fit_measures_in_the_middle_of_the_block() -> None:
    """The source was at 0.2 rad a quarter of a second before the stamp."""
    vector = steering_vectors(POSITIONS, np.array([0.2]), WAVENUMBER)
    covariance = np.eye(15) + 2.0 * vector @ vector.conj().T
    estimates = estimates_of(covariance, covariance_time_offset=-0.25, rank=1)
    target = KalmanState(np.array([[0.2026, 0.01]]), np.array([1e-4 * np.eye(2)]))
    sources = np.full((1, 1), 2.0, dtype=complex)
    for variance, age in [(0.0, 0.25), (2.0, 0.0)]:
        configuration = BearingTrackerConfiguration(
            method="coherent", measurement_variance_deg2=variance
        )
        measured = projection_filters(configuration).update(target, estimates, sources).measurement
        assert measured is not None
        assert measured.age == age
        assert measured.angle == pytest.approx([0.2], abs=1e-6)
        assert measured.innovation == pytest.approx([0.2 - (0.2026 - 0.01 * age)], abs=1e-6)
        bound = 6.0 * (1.0 + 1.0 / 30.0) / (200.0 * np.pi**2 * 15.0 * 224.0 * np.cos(0.2) ** 2)
        expected = variance * SQUARE_DEGREE if variance else bound
        assert measured.variance == pytest.approx([expected], rel=1e-3)
