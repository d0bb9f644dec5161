"""Protects what is measured in subspaces: of when it is, and how far it is to be believed.

One source at broadside of 15 elements half a wavelength apart. Its bound on N snapshots of ratio s
is 6 (1 + 1 / (15 s)) / (N s pi^2 15 (15^2 - 1)).
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sonar_tracking.geometry import steering_vectors
from sonar_tracking.passive.bearings.bearing_measurement import (
    BearingMeasurement,
    measure_in_subspaces,
    nearest_subspace,
)
from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    SQUARE_DEGREE,
    BearingTrackerConfiguration,
)
from tests.passive.crossing_scene import POSITIONS, SAMPLE_PERIOD, WAVENUMBER
from tests.passive.estimate_scene import estimates_of

OFFSETS = SAMPLE_PERIOD * np.array([0.0, 2.0])
BOUND = 6.0 * (1.0 + 1.0 / 15.0) / (7.0 * np.pi**2 * 15.0 * 224.0)
"""Seven effective snapshots: beta = 0.75, their mean age is three snapshots."""


def measured(angle: float, rate: float = 0.0, **values: Any) -> BearingMeasurement:
    """Return what two subspaces of the source say of a prediction."""
    vector = steering_vectors(POSITIONS, np.zeros(1), WAVENUMBER)
    estimates = estimates_of(
        None, basis=np.stack([vector] * 2), time_offsets=OFFSETS, effective_snapshots=7.0
    )
    configuration = BearingTrackerConfiguration(
        **{"method": "ml_fusion", "measurement_variance_deg2": 4.0, **values}
    )
    predicted, rates = np.array([angle]), np.array([rate])
    return measure_in_subspaces(
        configuration, estimates, predicted, rates, np.ones((1, 1), dtype=complex)
    )


@pytest.mark.parametrize("angle", [-1e-4, 0.0, 1e-4])
def test_the_innovation_leads_from_the_prediction_to_the_source(angle: float) -> None:
    told = measured(angle)
    assert told.innovation == pytest.approx([-angle], abs=1e-7)
    assert told.angle == pytest.approx([0.0], abs=1e-7)
    assert told.age == 0.0


def test_a_given_variance_is_fused() -> None:
    """Independent: half. Two snapshots apart at beta = 0.75: (1 + 0.75^2) / 2."""
    independent = measured(0.0, fused_variance="independent")
    assert independent.variance == pytest.approx([2.0 * SQUARE_DEGREE])
    assert measured(0.0).variance == pytest.approx([4.0 * SQUARE_DEGREE * 0.78125])


def test_the_variance_of_the_data_is_their_bound() -> None:
    told = measured(0.0, measurement_variance_deg2=0.0, fused_variance="independent")
    assert told.variance == pytest.approx([0.5 * BOUND], rel=1e-3)


def test_a_moving_target_is_measured_where_it_was() -> None:
    """Three snapshots old, but on the mean one snapshot late: two snapshots before the stamp."""
    age, rate = 2.0 * SAMPLE_PERIOD, 0.5
    told = measured(age * rate, rate, measurement_variance_deg2=0.0)
    assert told.age == pytest.approx(age)
    assert told.angle == pytest.approx([0.0], abs=1e-9)
    assert told.innovation == pytest.approx([0.0], abs=1e-9)
    for fixed in ({"lag_correction": False, "measurement_variance_deg2": 0.0}, {}):
        assert measured(0.0, rate, **fixed).age == 0.0


def test_the_subspace_of_the_sample_time_is_the_nearest_one() -> None:
    basis = np.arange(3.0)[:, None, None] * np.ones((15, 2), dtype=complex)
    estimates = estimates_of(None, basis=basis, time_offsets=np.array([-0.02, 0.005, 0.01]))
    nearest = nearest_subspace(estimates)
    assert nearest.time_offsets.tolist() == [0.005]
    assert (nearest.basis.shape, nearest.basis[0, 0, 0]) == ((1, 15, 2), 1.0)
