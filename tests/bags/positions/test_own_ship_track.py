"""Protects own ship's state between surveyed positions: frame of its velocity, course, rates."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.bags.positions.own_ship_track import interpolated, own_ship_at
from sonar_tracking.bags.positions.surveyed_positions import SurveyedPositions
from sonar_tracking.motion import azimuth_from_compass
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.time import NANOSECONDS

START = 1_700_000_000 * NANOSECONDS


def state_at(surveyed: SurveyedPositions, time: float) -> OwnShipState:
    """Return the state some seconds after the first position."""
    stamps = np.array([START + round(time * NANOSECONDS)])
    return own_ship_at(surveyed, stamps).state(0)


def survey(position: FloatArray, heading_deg: FloatArray, step: float = 10.0) -> SurveyedPositions:
    """Return positions every ``step`` seconds, with compass headings or NaN."""
    stamps = START + np.arange(len(position)) * round(step * NANOSECONDS)
    return SurveyedPositions(stamps, position, azimuth_from_compass(heading_deg))


@pytest.mark.parametrize(
    ("heading_deg", "ahead", "port"),
    [
        (0.0, 4.0, -3.0),  # bow north, set to the east: to starboard
        (90.0, 3.0, 4.0),  # bow east: the motion to the north is to port
        (180.0, -4.0, 3.0),
        (270.0, -3.0, -4.0),
    ],
)
def test_a_ship_that_is_set_moves_across_her_bow(
    heading_deg: float, ahead: float, port: float
) -> None:
    moved = np.outer(10.0 * np.arange(3), [3.0, 4.0])  # 3 m/s east, 4 m/s north
    surveyed = survey(moved, np.full(3, heading_deg))
    state = state_at(surveyed, 14.0)
    assert state.velocity == pytest.approx((ahead, port))
    assert state.position == pytest.approx((42.0, 56.0))
    assert state.yaw_rate == pytest.approx(0.0)


def test_without_a_heading_the_bow_points_where_the_ship_goes() -> None:
    surveyed = survey(np.outer(10.0 * np.arange(3), [3.0, 4.0]), np.full(3, np.nan))
    state = state_at(surveyed, 5.0)
    assert state.yaw == pytest.approx(np.arctan2(4.0, 3.0))
    assert state.velocity == pytest.approx((5.0, 0.0))


def test_a_ship_at_rest_keeps_her_last_heading_and_has_the_first_one_before_she_sails() -> None:
    north = np.array([0.0, 0.0, 0.0, 50.0, 100.0, 100.0, 100.0, 100.0])
    surveyed = survey(np.stack([np.zeros(8), north], axis=-1), np.full(8, np.nan))
    for time in (0.0, 25.0, 70.0, 100.0):
        assert state_at(surveyed, time).yaw == pytest.approx(np.pi / 2.0)
    drifting = survey(np.outer(0.1 * np.arange(3), [0.0, 1.0]), np.full(3, np.nan))
    assert state_at(drifting, 5.0).yaw == 0.0, "1 cm/s tells no course: east, as if at rest"


def test_a_turn_through_west_has_the_short_way_round() -> None:
    # Compass 260, 270, 280: azimuths -170, 180 and 170 degrees, falling by 1 degree a second.
    surveyed = survey(np.zeros((3, 2)), np.array([260.0, 270.0, 280.0]))
    state = state_at(surveyed, 12.0)
    assert np.degrees(state.yaw) == pytest.approx(178.0)
    assert np.degrees(state.yaw_rate) == pytest.approx(-1.0)


def test_values_are_linear_between_the_known_ones_and_beyond() -> None:
    known, values = np.array([0.0, 1.0, 3.0]), np.array([[0.0], [2.0], [10.0]])
    wanted = np.array([-1.0, 0.0, 0.5, 1.0, 2.0, 3.0, 4.0])
    value, rate = interpolated(known, values, wanted)
    assert value[:, 0].tolist() == [-2.0, 0.0, 1.0, 2.0, 6.0, 10.0, 14.0]
    # At 1 s the rate weighs the two slopes, 2 and 4, each by the other one's interval.
    assert rate[[0, 1, 3, 5, 6], 0] == pytest.approx([2.0, 2.0, 8.0 / 3.0, 4.0, 4.0])


def test_one_position_is_a_ship_at_rest() -> None:
    surveyed = survey(np.array([[7.0, -8.0]]), np.array([90.0]))
    state = state_at(surveyed, 33.0)
    assert (state.position, state.velocity) == ((7.0, -8.0), (0.0, 0.0))
    assert (state.yaw, state.yaw_rate) == (0.0, 0.0)
