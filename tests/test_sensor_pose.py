"""Protects: a pose that nobody has set is not taken for one, and one that was set is not lost.

Own ship is 740 m from the origin, heads north-east and turns; the sensor is 10 m ahead.
"""

import math

import numpy as np
import pytest

from sonar_tracking.errors import Severity
from sonar_tracking.motion import KinematicState
from sonar_tracking.sensor_pose import (
    LARGEST_DISTANCE,
    PlanePose,
    is_no_turn,
    is_unset,
    judge_pose,
    mounted_pose,
    yaw_of,
)

SHIP = KinematicState(
    position=np.array([740.0, 0.0]),
    velocity=np.array([3.0, 3.0]),
    azimuth=np.array(math.pi / 4.0),
    turn_rate=np.array(0.1),
)
MOUNTED = mounted_pose(SHIP, 10.0, 0.0, math.pi)
NEW = PlanePose((0.0, 0.0), (0.0, 0.0), 0.0)


AT_REST = (0.0, 0.0, 0.0)
NO_TURN = (0.0, 0.0, 0.0, 1.0)
NOWHERE = (math.nan,) * 3


@pytest.mark.parametrize(
    ("position", "orientation", "velocity", "unset"),
    [
        (AT_REST, NO_TURN, AT_REST, True),
        ((0.0, -0.0, 0.0), (0.0,) * 4, AT_REST, True),
        (AT_REST, NO_TURN, NOWHERE, True),
        ((0.0, 0.0, -5.0), NO_TURN, AT_REST, False),
        ((1e-9, 0.0, 0.0), NO_TURN, AT_REST, False),
        (AT_REST, (0.0, 0.0, 1e-9, 1.0), AT_REST, False),
        (AT_REST, (0.0, 0.0, 0.0, -1.0), AT_REST, False),
        (AT_REST, NO_TURN, (3.0, 0.0, 0.0), False),
        (NOWHERE, NO_TURN, AT_REST, False),
        (AT_REST, (math.nan,) * 4, AT_REST, False),
    ],
)
def test_only_the_pose_of_a_new_message_is_unset(
    position: tuple[float, ...],
    orientation: tuple[float, ...],
    velocity: tuple[float, ...],
    unset: bool,
) -> None:
    """A sensor at the origin may tell its depth, or turn; own ship may begin there, moving."""
    assert is_unset(position, orientation, velocity) == unset


def test_yaws() -> None:
    assert yaw_of((0.0, 0.0, math.sin(0.4), math.cos(0.4))) == pytest.approx(0.8)
    assert math.isnan(yaw_of((0.0, 0.0, 0.0, 0.0))) and math.isnan(yaw_of((math.nan,) * 4))
    assert is_no_turn((0.0, 0.0, 0.0, 1.0)) and not is_no_turn((0.0, 0.0, 0.0, -1.0))


def test_a_mounted_sensor_swings_with_the_ship() -> None:
    """Ten metres ahead of the turning point at 0.1 rad/s: 1 m/s to port."""
    diagonal = math.sqrt(0.5)
    assert MOUNTED.position == pytest.approx((740.0 + 10.0 * diagonal, 10.0 * diagonal))
    assert MOUNTED.velocity == pytest.approx((3.0 - diagonal, 3.0 + diagonal))
    assert MOUNTED.yaw == pytest.approx(1.25 * math.pi)


def test_own_ship_elsewhere_makes_an_unset_pose_unknown() -> None:
    verdict = judge_pose(NEW, True, MOUNTED, odometry=True)
    assert verdict.unknown and verdict.notice is not None
    assert verdict.notice.severity is Severity.WARN and "747 m" in verdict.notice.text


def test_own_ship_at_rest_at_the_same_place_makes_it_true() -> None:
    verdict = judge_pose(NEW, True, NEW, odometry=True)
    assert not verdict.unknown
    assert verdict.notice is not None and verdict.notice.severity is Severity.OK


def test_own_ship_at_the_same_place_but_turned_makes_it_unknown() -> None:
    turned = PlanePose((0.0, 0.0), (0.0, 0.0), 0.1)
    assert judge_pose(NEW, True, turned, odometry=True).unknown
    needless = PlanePose((0.0, 0.0), (0.0, 0.0), math.nan)  # azimuths in map need no yaw
    assert not judge_pose(needless, True, turned, odometry=True).unknown


def test_own_ship_that_passes_by_makes_it_unknown() -> None:
    """A sensor on own ship that moves does not rest, wherever it is."""
    passing = PlanePose((0.0, 0.0), (3.0, 3.0), 0.0)
    assert judge_pose(NEW, True, passing, odometry=True).unknown


def test_without_any_odometry_it_is_true_and_said() -> None:
    verdict = judge_pose(NEW, True, None, odometry=False)
    assert not verdict.unknown
    assert verdict.notice is not None and "no own_ship/odometry" in verdict.notice.text


def test_before_the_first_odometry_it_is_unknown() -> None:
    verdict = judge_pose(NEW, True, None, odometry=True)
    assert verdict.unknown and verdict.notice is None


def test_on_another_platform_it_is_true_and_said() -> None:
    verdict = judge_pose(NEW, True, MOUNTED, odometry=True, another_platform="buoy/array")
    assert not verdict.unknown
    assert verdict.notice is not None and "buoy/array is not own ship's" in verdict.notice.text
    for odometry in (True, False):
        alone = judge_pose(NEW, True, None, odometry, another_platform="buoy/array")
        assert not alone.unknown and alone.notice is None


@pytest.mark.parametrize(
    ("told", "words"),
    [
        (PlanePose((741.0, LARGEST_DISTANCE + 20.0), MOUNTED.velocity, MOUNTED.yaw), "513 m from"),
        (PlanePose(MOUNTED.position, MOUNTED.velocity, MOUNTED.yaw + 1.0), "57 degrees"),
        (PlanePose(MOUNTED.position, (0.0, 0.0), MOUNTED.yaw), "sensor_velocity is zero"),
    ],
)
def test_a_pose_that_was_set_is_used_and_its_contradiction_said(
    told: PlanePose, words: str
) -> None:
    verdict = judge_pose(told, False, MOUNTED, odometry=True)
    assert not verdict.unknown
    assert verdict.notice is not None and verdict.notice.severity is Severity.WARN
    assert words in verdict.notice.text


@pytest.mark.parametrize("yaw", [MOUNTED.yaw, MOUNTED.yaw + 0.5, math.nan])
def test_a_pose_that_was_set_and_agrees_is_all_well(yaw: float) -> None:
    near = PlanePose((MOUNTED.position[0] + 300.0, 0.0), MOUNTED.velocity, yaw)
    verdict = judge_pose(near, False, MOUNTED, odometry=True)
    assert not verdict.unknown
    assert verdict.notice is not None and verdict.notice.severity is Severity.OK
    assert judge_pose(near, False, None, odometry=True).notice is None
