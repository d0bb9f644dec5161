"""Protects the units of target motion analysis' parameters, and which do not fit together."""

from __future__ import annotations

import math

import pytest

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.tma.targets.tma_tracker_configuration import (
    TmaTrackerConfiguration,
    check_tma_tracker,
)


def test_degrees_become_radians_and_sound_may_be_seen_at_once() -> None:
    configuration = TmaTrackerConfiguration(
        minimum_azimuth_deviation_deg=0.5,
        azimuth_deviation_deg=2.0,
        mounting_yaw_deg=90.0,
        sound_speed=1480.0,
    )
    assert configuration.minimum_azimuth_deviation == pytest.approx(math.pi / 360.0)
    assert configuration.azimuth_deviation == pytest.approx(math.pi / 90.0)
    assert configuration.mounting_yaw == pytest.approx(math.pi / 2.0)
    assert configuration.propagation_speed == 1480.0
    assert TmaTrackerConfiguration(travel_time=False).propagation_speed == math.inf


def test_ranges_are_spaced_by_a_constant_factor() -> None:
    edges = TmaTrackerConfiguration(minimum_range=100.0, maximum_range=6400.0, n_ranges=3)
    assert edges.range_edges().tolist() == pytest.approx([100.0, 400.0, 1600.0, 6400.0])


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"minimum_range": 2000.0, "maximum_range": 2000.0}, "maximum_range 2000 m; the first"),
        ({"minimum_range": 2000.0, "maximum_range": 1000.0}, "maximum_range 1000 m; the first"),
        ({"manoeuvre_acceleration": 0.0099}, "manoeuvre_acceleration is 0.0099 m/s"),
    ],
)
def test_what_does_not_fit_is_refused(values: dict[str, float], sentence: str) -> None:
    with pytest.raises(ConfigurationError, match=sentence):
        check_tma_tracker(TmaTrackerConfiguration(**values))  # type: ignore[arg-type]


def test_what_just_fits_is_taken() -> None:
    check_tma_tracker(TmaTrackerConfiguration())
    check_tma_tracker(
        TmaTrackerConfiguration(
            minimum_range=1999.0,
            maximum_range=2000.0,
            acceleration=0.1,
            manoeuvre_acceleration=0.1,
        )
    )
