"""Protects own ship's motion where odometry tells positions only, and where it tells all."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from nav_msgs.msg import Odometry

from sonar_tracking.errors import Notice, Severity
from sonar_tracking.graph.message_writing.array_writing import own_ship_to_message
from sonar_tracking.message_reading.array_reading import own_ship_from_message
from sonar_tracking.message_reading.own_ship_reading import OwnShipReader
from sonar_tracking.records.own_ship import OwnShipState

SECOND = 1_000_000_000
START = 1_767_225_600 * SECOND
COURSE = math.radians(150.0)
VELOCITY = 5.0 * np.array([math.cos(COURSE), math.sin(COURSE)])


def positions(
    count: int = 30, interval: int = SECOND, velocity: np.ndarray = VELOCITY
) -> Iterator[Any]:
    """Odometry that tells where own ship is, and nothing else."""
    for number in range(count):
        stamp = START + number * interval
        message = Odometry()
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp, SECOND)
        position = message.pose.pose.position
        position.x, position.y = (number * interval * 1e-9 * velocity).tolist()
        yield message


def test_what_odometry_tells_is_taken_as_it_is() -> None:
    """Bit for bit, at rest, astern and turning on the spot."""
    told: list[Notice] = []
    reader = OwnShipReader(told.append)
    for number, (speed, rate) in enumerate([(0.0, 0.0), (-2.0, 0.0), (0.0, 0.1), (3.0, 0.1)]):
        state = OwnShipState(START + number * SECOND, (7.0 * number, 1.0), 0.3, (speed, 0.0), rate)
        message = own_ship_to_message(state)
        assert reader(message) == own_ship_from_message(message)
    assert all(notice.severity is Severity.OK for notice in told)


def test_positions_that_move_tell_velocity_and_course() -> None:
    told: list[Notice] = []
    reader = OwnShipReader(told.append)
    states = [reader(message) for message in positions()]
    for state in states[1:]:
        assert state.yaw == pytest.approx(COURSE)
        assert state.velocity == pytest.approx((5.0, 0.0), abs=1e-9)
    assert all(state.yaw_rate == pytest.approx(0.0, abs=1e-9) for state in states[2:])
    assert told[-1].severity is Severity.WARN and "5.0 m/s" in told[-1].text


def test_an_orientation_that_was_set_is_kept() -> None:
    """Astern: the positions move against the heading."""
    reader = OwnShipReader()
    for message in positions():
        turn = message.pose.pose.orientation
        half = 0.5 * (COURSE + math.pi)
        turn.z, turn.w = math.sin(half), math.cos(half)
        state = reader(message)
    assert math.remainder(state.yaw - COURSE - math.pi, 2.0 * math.pi) == pytest.approx(0.0)
    assert state.velocity == pytest.approx((-5.0, 0.0), abs=1e-9)


def test_a_ship_at_rest_keeps_its_last_course() -> None:
    reader = OwnShipReader()
    *_, last = positions()
    for message in positions():
        reader(message)
    for _ in range(40):
        last.header.stamp.sec += 1
        state = reader(last)
        assert math.isfinite(state.yaw_rate)
    assert state.velocity == (0.0, 0.0)
    assert state.yaw == pytest.approx(COURSE)


def test_errors_of_positions_are_no_motion() -> None:
    """A moored ship, positions ten times a second with errors of a metre."""
    told: list[Notice] = []
    reader = OwnShipReader(told.append)
    generator = np.random.default_rng(1)
    for message in positions(300, SECOND // 10, np.zeros(2)):
        position = message.pose.pose.position
        position.x, position.y = generator.normal(0.0, 1.0, 2).tolist()
        state = reader(message)
    assert state.velocity == (0.0, 0.0)


def test_data_that_begin_again_forget_the_positions_before() -> None:
    reader = OwnShipReader()
    for message in positions():
        reader(message)
    first = next(positions())
    assert reader(first) == own_ship_from_message(first)
