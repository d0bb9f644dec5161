"""Protects when tracks end by themselves, and that parameters which do not fit are refused."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    SQUARE_DEGREE,
    BearingTrackerConfiguration,
    check_configuration,
    check_estimator,
)
from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration


@pytest.mark.parametrize(
    ("method", "variance_deg2", "start", "ends"),
    [
        ("joint_map", 0.0, "automatic", True),
        ("coherent", 0.0, "automatic", True),
        ("ml_fusion", 0.0, "automatic", True),
        ("joint_map", 0.0, "given", False),
        ("ml_fusion", 0.0, "given", False),
        ("ryu", 0.5, "automatic", False),  # as published: nobody knows how good a bearing is
        ("ml_fusion", 0.5, "automatic", False),
    ],
)
def test_tracks_end_where_nobody_said_that_they_stay(
    method: str, variance_deg2: float, start: str, ends: bool
) -> None:
    configuration = BearingTrackerConfiguration(
        method=method,
        measurement_variance_deg2=variance_deg2,
        start=start,
        initial_bearings_deg=() if start == "automatic" else (3.0,),
    )
    assert configuration.ends_tracks == ends


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"initial_bearings_deg": (3.0,)}, "need start = given"),
        ({"initial_rates_deg": (0.1,)}, "need start = given"),
        ({"start": "given"}, "initial_bearings_deg is empty"),
        ({"start": "given", "initial_rates_deg": (0.1,)}, "initial_bearings_deg is empty"),
        (
            {"start": "given", "initial_bearings_deg": (3.0, 4.0), "initial_rates_deg": (0.1,)},
            "one",
        ),
    ],
)
def test_first_bearings_are_given_or_found(values: dict[str, object], sentence: str) -> None:
    with pytest.raises(ConfigurationError, match=sentence):
        check_configuration(BearingTrackerConfiguration(**values))  # type: ignore[arg-type]


def test_one_rate_for_each_given_bearing() -> None:
    check_configuration(BearingTrackerConfiguration())
    given = BearingTrackerConfiguration(
        start="given", initial_bearings_deg=(3.0, 4.0), initial_rates_deg=(0.1, 0.0)
    )
    check_configuration(given)


def test_a_steady_bearing_has_never_more_process_noise_than_a_turning_one() -> None:
    configuration = BearingTrackerConfiguration(
        process_noise_deg2=0.1, steady_process_noise_deg2=0.001
    )
    assert configuration.process_noise_density == pytest.approx(0.1 * (np.pi / 180.0) ** 2)
    assert configuration.steady_process_noise_density == pytest.approx(0.001 * SQUARE_DEGREE)
    calm = BearingTrackerConfiguration(process_noise_deg2=1e-4, steady_process_noise_deg2=0.001)
    assert calm.steady_process_noise_density == pytest.approx(1e-4 * SQUARE_DEGREE)


@pytest.mark.parametrize(
    ("method", "estimator", "snapshots", "sentence"),
    [
        ("joint_map", "covariance", 100, ""),
        ("ml_fusion", "past", 0, ""),
        ("joint_map", "past", 100, "needs subspace_estimator.method covariance, but that is past"),
        ("coherent", "covariance", 0, "covariance_snapshots above zero"),
    ],
)
def test_what_measures_in_a_covariance_needs_one(
    method: str, estimator: str, snapshots: int, sentence: str
) -> None:
    tracker = BearingTrackerConfiguration(method=method)
    subspaces = SubspaceConfiguration(method=estimator, covariance_snapshots=snapshots)
    if sentence:
        with pytest.raises(ConfigurationError, match=sentence):
            check_estimator(tracker, subspaces)
    else:
        check_estimator(tracker, subspaces)
