"""The yaw must take the shortest arc, whatever side of south it crosses."""

from __future__ import annotations

import math

import pytest

from sonar_tracking.own_ship_interpolation import interpolate_own_ship
from sonar_tracking.records.own_ship import OwnShipState


def state(stamp: int, x: float, yaw_deg: float) -> OwnShipState:
    return OwnShipState(stamp, (x, -x), math.radians(yaw_deg), (2.0 * x, 0.0), x)


@pytest.mark.parametrize(
    ("before_deg", "after_deg", "middle_deg"),
    [(10.0, 30.0, 20.0), (170.0, -170.0, 180.0), (-175.0, 165.0, 175.0), (-20.0, 10.0, -5.0)],
)
def test_halfway(before_deg: float, after_deg: float, middle_deg: float) -> None:
    middle = interpolate_own_ship(state(0, 0.0, before_deg), state(100, 4.0, after_deg), 0.5)
    assert middle.stamp == 50
    assert middle.position == (2.0, -2.0)
    assert middle.velocity == (4.0, 0.0)
    assert math.remainder(middle.yaw - math.radians(middle_deg), 2 * math.pi) == pytest.approx(0.0)


@pytest.mark.parametrize("fraction", [0.0, 1.0])
def test_the_ends_are_the_given_states(fraction: float) -> None:
    ends = (state(0, 1.0, 100.0), state(100, 3.0, -120.0))
    found = interpolate_own_ship(*ends, fraction)
    expected = ends[int(fraction)]
    assert found.position == expected.position and found.stamp == expected.stamp
    assert math.remainder(found.yaw - expected.yaw, 2 * math.pi) == pytest.approx(0.0)
