"""Where own ship and its sensors are shown, against places one can find by hand.

Own ship goes north with 4 m/s from (100, 0); its +x is +y of the map.
"""

from __future__ import annotations

import math

import pytest

from sonar_tracking.records.bearings import Sensor
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.scene.rigid_pose import RigidPose, turned_about_z
from sonar_tracking.scene.scene_frames import (
    FrameTransform,
    HeardSensor,
    OwnShipPose,
    SceneFrames,
)

SECOND = 1_000_000_000
NORTH = math.pi / 2.0
SPEED = 4.0
MOUNTING = RigidPose((-30.0, 2.0, 0.0), turned_about_z(math.pi))
"""Of a towed array: 30 m astern, 2 m to port, its +x aft."""

NAN = math.nan


def own_ship(second: float, yaw: float = NORTH) -> OwnShipPose:
    position = (100.0, SPEED * second)
    state = OwnShipState(round(second * SECOND), position, yaw, (SPEED, 0.0), 0.0)
    return OwnShipPose(state, RigidPose((*position, 0.0), turned_about_z(yaw)))


def heard(
    second: float,
    position: tuple[float, float] = (NAN, NAN),
    yaw: float = NAN,
    speed: float = SPEED,
    frame: str = "own_ship/array",
    name: str = "array",
) -> HeardSensor:
    turn = turned_about_z(yaw) if math.isfinite(yaw) else (NAN,) * 4
    sensor = Sensor(name, frame, (*position, 0.0), turn, (0.0, speed, 0.0))
    return HeardSensor(round(second * SECOND), sensor, MOUNTING)


def aboard(second: float, ahead: float = 20.0) -> HeardSensor:
    """Return a sensor that tells its pose: ahead of own ship's reference, facing the bow."""
    return heard(second, (100.0, SPEED * second + ahead), NORTH)


def assert_pose(found: FrameTransform, parent: str, child: str, pose: RigidPose) -> None:
    assert (found.parent, found.child) == (parent, child)
    assert found.pose.position == pytest.approx(pose.position, abs=1e-9)
    assert found.pose.angle_to(pose) == pytest.approx(0.0, abs=1e-7)


def test_own_ship_is_where_odometry_has_it_at_its_stamp() -> None:
    (found,) = SceneFrames().own_ship_told(own_ship(3.0))
    assert found.stamp == 3 * SECOND
    assert_pose(
        found, "map", "own_ship/base_link", RigidPose((100.0, 12.0, 0.0), turned_about_z(NORTH))
    )


def test_frames_of_odometry_are_respected() -> None:
    (found,) = SceneFrames("ship_a/").own_ship_told(own_ship(0.0), "/odom", "hull")
    assert (found.parent, found.child) == ("odom", "ship_a/hull")


def test_each_instant_is_told_once_and_a_new_beginning_is_one() -> None:
    frames = SceneFrames()
    counts = [len(frames.own_ship_told(own_ship(second))) for second in (20, 20, 19, 21, 1, 2)]
    assert counts == [1, 0, 0, 1, 1, 1]


def test_a_sensor_without_pose_is_mounted_where_the_parameters_say() -> None:
    frames = SceneFrames()
    frames.own_ship_told(own_ship(0.0))
    assert frames.sensor_told(heard(0.0), odometry=True) == []
    assert_pose(frames.fixed["own_ship/array"], "own_ship/base_link", "own_ship/array", MOUNTING)


def test_a_sensor_that_moves_with_own_ship_is_mounted_by_the_difference_of_the_poses() -> None:
    frames = SceneFrames()
    for second in (0.0, 10.0):
        frames.own_ship_told(own_ship(second))
        assert frames.sensor_told(aboard(second), odometry=True) == []
    ahead = RigidPose((20.0, 0.0, 0.0))
    assert_pose(frames.fixed["own_ship/array"], "own_ship/base_link", "own_ship/array", ahead)


def test_a_message_waits_for_odometry_and_own_ship_is_interpolated() -> None:
    frames = SceneFrames()
    assert frames.sensor_told(aboard(5.0), odometry=True) == []
    frames.own_ship_told(own_ship(0.0))
    assert not frames.fixed
    frames.own_ship_told(own_ship(10.0))
    assert frames.fixed["own_ship/array"].pose.position == pytest.approx((20.0, 0.0, 0.0))


@pytest.mark.parametrize(
    ("position", "yaw", "why"),
    [((100.0, 60.0), NORTH, "farther ahead"), ((100.0, 60.0 - 20.0), 1.5, "turned")],
)
def test_a_sensor_that_leaves_its_place_is_shown_in_the_map(
    position: tuple[float, float], yaw: float, why: str
) -> None:
    """E.g. a towed array, which follows a turn late; it is not taken to be mounted again."""
    frames = SceneFrames()
    frames.own_ship_told(own_ship(0.0))
    frames.sensor_told(aboard(0.0), odometry=True)
    assert frames.fixed
    frames.own_ship_told(own_ship(5.0))
    (found,) = frames.sensor_told(heard(5.0, position, yaw), odometry=True)
    assert_pose(found, "map", "own_ship/array", RigidPose((*position, 0.0), turned_about_z(yaw)))
    assert not frames.fixed, why
    frames.own_ship_told(own_ship(6.0))
    assert len(frames.sensor_told(aboard(6.0), odometry=True)) == 1
    assert not frames.fixed


@pytest.mark.parametrize(
    ("position", "speed", "frame", "child"),
    [
        ((150.0, 0.0), 0.0, "map", "buoy"),  # near, but at rest
        ((900.0, 0.0), SPEED, "map", "buoy"),  # as fast, but far away
        ((150.0, 0.0), SPEED, "buoy/array", "buoy/array"),  # says whose it is
    ],
)
def test_a_sensor_that_is_not_own_ships_is_shown_in_the_map(
    position: tuple[float, float], speed: float, frame: str, child: str
) -> None:
    frames = SceneFrames()
    frames.own_ship_told(own_ship(0.0))
    buoy = heard(0.0, position, 0.5, speed, frame, "buoy")
    (found,) = frames.sensor_told(buoy, odometry=True)
    assert_pose(found, "map", child, RigidPose((*position, 0.0), turned_about_z(0.5)))
    assert not frames.fixed


def test_without_odometry_a_pose_in_a_message_is_enough_and_nothing_else_is_shown() -> None:
    frames = SceneFrames()
    (found,) = frames.sensor_told(heard(0.0, (7.0, 8.0), 0.5), odometry=False)
    assert_pose(found, "map", "own_ship/array", RigidPose((7.0, 8.0, 0.0), turned_about_z(0.5)))
    assert frames.sensor_told(heard(1.0), odometry=False) == []
    assert not frames.fixed


def test_the_pose_of_a_new_message_is_unknown_where_own_ship_is_elsewhere() -> None:
    new = heard(0.0, (0.0, 0.0), 0.0, speed=0.0, frame="map", name="")
    frames = SceneFrames()
    frames.own_ship_told(own_ship(0.0))
    assert frames.sensor_told(new, odometry=True) == []
    assert_pose(frames.fixed["own_ship/sensor"], "own_ship/base_link", "own_ship/sensor", MOUNTING)


def test_a_frame_is_that_of_one_sensor_and_never_own_ships_itself() -> None:
    frames = SceneFrames()
    frames.own_ship_told(own_ship(0.0))
    for name, frame in (("a", "own_ship/array"), ("b", "own_ship/array"), ("c", "map")):
        frames.sensor_told(heard(0.0, frame=frame, name=name), odometry=True)
    frames.sensor_told(heard(0.0, frame="own_ship/base_link", name="d"), odometry=True)
    assert set(frames.fixed) == {"own_ship/array", "own_ship/b", "own_ship/c", "own_ship/d"}


def test_two_graphs_in_one_world_have_two_own_ships() -> None:
    frames = SceneFrames("ship_a/")
    (found,) = frames.own_ship_told(own_ship(0.0))
    assert (found.parent, found.child) == ("map", "ship_a/own_ship/base_link")
    frames.sensor_told(heard(0.0), odometry=True)
    (fixed,) = frames.fixed.values()
    assert (fixed.parent, fixed.child) == (found.child, "ship_a/own_ship/array")
