"""Protects what a bearing track and its lines say of a target: variances, refusals, best lines."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sonar_tracking.records.bearings import AngleKind, BearingTracks, TrackStatus
from sonar_tracking.records.lines import FrequencyLines
from sonar_tracking.tma.targets.bearing_observations import UsableLine, lines_of, observation_of
from sonar_tracking.tma.targets.station_view import StationView
from sonar_tracking.tma.targets.target_records import MAXIMUM_LINES, TargetObservation
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration

VIEW = StationView("array", "map", (10.0, 20.0), (1.0, 2.0), axis=0.0, turn_rate=0.02)
DEFAULT = TmaTrackerConfiguration()


def bearing(**changes: Any) -> BearingTracks:
    """Return a list of one confirmed track, measured at 0.3 rad with 0.01 rad, changed."""
    unknown = np.full(1, np.nan)
    tracks = BearingTracks(
        stamp=1,
        id=np.array([7], dtype=np.uint64),
        status=np.array([TrackStatus.CONFIRMED], dtype=np.uint8),
        arrival_angle=unknown,
        arrival_angle_rate=unknown,
        covariance=np.full((1, 2, 2), np.nan),
        measurement=np.array([0.3]),
        measurement_variance=np.array([1e-4]),
        innovation=unknown,
        signal_to_noise_ratio=unknown,
        existence_probability=unknown,
        ambiguous=np.zeros(1, dtype=bool),
        angle_kind=AngleKind.AZIMUTH,
    )
    columns: dict[str, Any] = {name: np.array([value]) for name, value in changes.items()}
    return replace(tracks, **columns)


def observed(
    tracks: BearingTracks, configuration: TmaTrackerConfiguration = DEFAULT, turn_rate: float = 0.02
) -> tuple[TargetObservation, str]:
    return observation_of(tracks, 0, replace(VIEW, turn_rate=turn_rate), configuration)


@pytest.mark.parametrize("turn_rate", [0.02, -0.02])
def test_a_towed_array_adds_the_squared_angle_it_lags_behind_in_a_turn(turn_rate: float) -> None:
    towed = replace(DEFAULT, array_lag=10.0)  # 0.02 rad/s for 10 s: 0.2 rad
    observation, problem = observed(bearing(), towed, turn_rate)
    assert problem == ""
    assert observation.azimuth_variance == pytest.approx(1e-4 + 0.2**2)
    straight, _ = observed(bearing(), towed, 0.0)
    hull_mounted, _ = observed(bearing(), DEFAULT, turn_rate)
    assert straight.azimuth_variance == hull_mounted.azimuth_variance == pytest.approx(1e-4)


def test_no_bearing_is_taken_to_be_better_than_the_floor() -> None:
    observation, _ = observed(
        bearing(measurement_variance=1e-12),
        replace(DEFAULT, minimum_azimuth_deviation_deg=np.degrees(0.03), array_lag=10.0),
    )
    # What the turn adds comes on top of the floor.
    assert observation.azimuth_variance == pytest.approx(0.03**2 + 0.2**2)


def test_a_bearing_without_a_variance_gets_the_one_of_the_parameters_or_is_left_out() -> None:
    nameless = bearing(measurement_variance=np.nan)
    observation, problem = observed(nameless)
    assert observation.azimuths == ()
    assert "track 7 has the variance nan" in problem
    observation, problem = observed(nameless, replace(DEFAULT, azimuth_deviation_deg=2.0))
    assert observation.azimuths == pytest.approx((0.3,))
    assert problem == ""
    assert observation.azimuth_variance == pytest.approx(np.radians(2.0) ** 2)
    observation, _ = observed(bearing(), replace(DEFAULT, azimuth_deviation_deg=2.0))
    assert observation.azimuth_variance == pytest.approx(1e-4), "one that is given is kept"


@pytest.mark.parametrize(
    ("changes", "problem"),
    [
        ({"measurement": np.nan}, ""),  # nothing measured now: nothing wrong
        ({"measurement": np.inf}, "track 7 has the angle inf"),
        ({"measurement": np.inf, "status": TrackStatus.TENTATIVE}, ""),
        ({"measurement": 6.3}, "more than a full turn"),
        ({"measurement": -6.3}, "more than a full turn"),
        ({"measurement_variance": 0.0}, "variance 0 "),
        ({"measurement_variance": -1.0}, "variance -1 "),
        ({"measurement_variance": 10.0}, "variance 10 "),
    ],
)
def test_what_cannot_be_used_is_left_out_and_named(changes: dict[str, Any], problem: str) -> None:
    observation, said = observed(bearing(**changes))
    assert observation.azimuths == ()
    assert problem in said
    assert bool(said) == bool(problem)


def test_up_to_a_full_turn_is_a_legal_way_to_write_an_angle() -> None:
    observation, problem = observed(bearing(measurement=2.0 * np.pi))
    assert problem == ""
    assert observation.azimuths[0] == pytest.approx(0.0)


@pytest.mark.parametrize(
    ("height", "elevation", "variance", "used"),
    [
        (100.0, 0.2, 1e-4, True),
        (0.0, 0.2, 1e-4, True),  # without a height it is estimated
        (100.0, np.nan, 1e-4, False),
        (100.0, 0.2, 0.0, False),
        (100.0, 0.2, np.inf, False),
    ],
)
def test_an_elevation_is_used_if_it_can_be(
    height: float, elevation: float, variance: float, used: bool
) -> None:
    tracks = replace(
        bearing(), elevation=np.array([elevation]), elevation_variance=np.array([variance])
    )
    observation, _ = observed(tracks, replace(DEFAULT, target_height=height))
    expected = (elevation, variance) if used else (np.nan, np.nan)
    told = (observation.elevation, observation.elevation_variance)
    np.testing.assert_array_equal(told, expected)
    assert observation.height == height
    assert observation.height_deviation == (0.0 if height else 1000.0)


def frequency_lines(
    numbers: list[int], frequency: list[float], deviation: list[float]
) -> FrequencyLines:
    nothing = np.full(len(numbers), np.nan)
    return FrequencyLines(
        stamp=1,
        line_id=np.array(numbers, dtype=np.uint64),
        frequency=np.array(frequency),
        standard_deviation=np.array(deviation),
        signal_to_noise_ratio=nothing,
        integration_time=nothing,
        track_id=np.zeros(len(numbers), dtype=np.uint64),
        arrival_angle=nothing,
        arrival_angle_variance=nothing,
    )


@pytest.mark.parametrize(
    ("frequency", "deviation", "usable"),
    [
        (300.0, 0.1, True),
        (1e7, 0.1, True),
        (2e7, 0.1, False),
        (0.0, 0.1, False),
        (-300.0, 0.1, False),
        (300.0, 300.0, False),  # as wide as it is high
        (300.0, 2e-7, False),  # no clock is better than 1e-9
        (300.0, 4e-7, True),
        (300.0, np.nan, False),
        (np.nan, 0.1, False),
    ],
)
def test_impossible_lines_are_left_out_and_named(
    frequency: float, deviation: float, usable: bool
) -> None:
    heard, problem = lines_of(frequency_lines([3, 4], [frequency, 200.0], [deviation, 0.1]), [7, 7])
    assert [line.line_id for line in heard[7]] == ([3, 4] if usable else [4])
    assert ("line 3 " in problem) != usable


def test_lines_go_to_their_tracks_and_each_once() -> None:
    lines = frequency_lines([3, 4, 3, 3], [300.0, 200.0, 310.0, 320.0], [0.1] * 4)
    heard, problem = lines_of(lines, [7, 0, 8, 7])
    assert heard == {7: [UsableLine(3, 300.0, 0.1)], 8: [UsableLine(3, 310.0, 0.1)]}
    assert problem == "line 3 appears twice"


def test_the_relatively_sharpest_lines_are_kept_in_their_order() -> None:
    # 1 Hz at 1000 Hz tells more of the motion than 0.5 Hz at 100 Hz.
    number = MAXIMUM_LINES + 2
    frequency = [100.0 if row in (2, 5) else 1000.0 + row for row in range(number)]
    deviation = [0.5 if row in (2, 5) else 1.0 for row in range(number)]
    lines = frequency_lines(list(range(1, number + 1)), frequency, deviation)
    heard, problem = lines_of(lines, [7] * number)
    kept = [row + 1 for row in range(number) if row not in (2, 5)]
    assert [line.line_id for line in heard[7]] == kept
    assert problem == ""
    # Of equally sharp ones no more than can be used, the first.
    alike = frequency_lines(list(range(1, number + 1)), [500.0] * number, [0.1] * number)
    heard, _ = lines_of(alike, [7] * number)
    assert [line.line_id for line in heard[7]] == list(range(1, MAXIMUM_LINES + 1))
