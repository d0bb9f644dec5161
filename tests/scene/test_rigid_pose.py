"""Poses of frames in frames, against turns one can do by hand."""

from __future__ import annotations

import math

import pytest

from sonar_tracking.scene.rigid_pose import RigidPose, turned_about_z, unit_quaternion

QUARTER = math.pi / 2.0
NORTHWARD = RigidPose((100.0, 50.0, -20.0), turned_about_z(QUARTER))
"""A ship at (100, 50), 20 m deep, that heads north: its +x is +y of the map."""


def assert_equal(found: RigidPose, expected: RigidPose) -> None:
    assert found.position == pytest.approx(expected.position, abs=1e-12)
    assert found.angle_to(expected) == pytest.approx(0.0, abs=1e-7)


def test_a_sensor_ahead_of_a_northbound_ship_is_north_of_it() -> None:
    sensor = RigidPose((30.0, 5.0, 2.0), turned_about_z(QUARTER))
    # 30 m ahead is 30 m north, 5 m to port is 5 m west; its own +x points to port, i.e. west.
    placed = RigidPose((95.0, 80.0, -18.0), turned_about_z(math.pi))
    assert_equal(sensor.placed_in(NORTHWARD), placed)
    assert_equal(placed.seen_from(NORTHWARD), sensor)


def test_a_ship_on_its_side_has_its_port_above() -> None:
    rolled = RigidPose(orientation=(math.sin(QUARTER / 2.0), 0.0, 0.0, math.cos(QUARTER / 2.0)))
    assert RigidPose((0.0, 3.0, 0.0)).placed_in(rolled).position == pytest.approx((0.0, 0.0, 3.0))


def test_between_two_headings_the_turn_is_the_shorter_one() -> None:
    # From 170 to -170 degrees by way of 180; the quaternions are on opposite sides.
    first = RigidPose((0.0, 0.0, 0.0), turned_about_z(math.radians(170.0)))
    second = RigidPose((8.0, -4.0, 2.0), turned_about_z(math.radians(-170.0)))
    middle = RigidPose((4.0, -2.0, 1.0), turned_about_z(math.pi))
    assert_equal(first.towards(second, 0.5), middle)
    assert_equal(first.towards(second, 0.0), first)
    assert_equal(first.towards(second, 1.0), second)


def test_an_angle_between_two_poses_is_the_same_whatever_the_sign_of_the_quaternion() -> None:
    turned = RigidPose(orientation=turned_about_z(0.3))
    opposite = RigidPose(orientation=tuple(-value for value in turned.orientation))  # type: ignore[arg-type]
    assert RigidPose().angle_to(turned) == pytest.approx(0.3)
    assert RigidPose().angle_to(opposite) == pytest.approx(0.3)


@pytest.mark.parametrize("values", [(0.0,) * 4, (math.nan,) * 4, (math.inf, 0.0, 0.0, 1.0)])
def test_no_orientation_is_none(values: tuple[float, float, float, float]) -> None:
    assert unit_quaternion(values) is None
    assert unit_quaternion((0.0, 0.0, 0.0, 2.0)) == (0.0, 0.0, 0.0, 1.0)
