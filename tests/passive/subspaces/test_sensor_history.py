"""A result that stands for an earlier instant has the sensor of that instant."""

import numpy as np
import pytest

from sonar_tracking.passive.subspaces.sensor_history import SensorHistory
from sonar_tracking.records.bearings import Sensor
from sonar_tracking.records.time import NANOSECONDS


def sensor(yaw_deg: float, x: float = 0.0, speed: float = 0.0) -> Sensor:
    half = np.radians(yaw_deg) / 2.0
    return Sensor(
        "tow", "tow/array", (x, 1.0, 0.0), (0.0, 0.0, np.sin(half), np.cos(half)), (speed, 0.0, 0.0)
    )


def yaw_deg(record: Sensor) -> float:
    return float(np.degrees(2.0 * np.arctan2(record.orientation[2], record.orientation[3])))


HISTORY = SensorHistory(
    ((0, sensor(170.0, 0.0, 4.0)), (2 * NANOSECONDS, sensor(-170.0, 10.0, 6.0)))
)


def test_between_blocks_pose_and_velocity_are_interpolated() -> None:
    """The turn goes the short way, through 180 deg."""
    middle = HISTORY.at(NANOSECONDS)
    assert middle.position == (5.0, 1.0, 0.0)
    assert middle.velocity == (5.0, 0.0, 0.0)
    assert abs(yaw_deg(middle)) == pytest.approx(180.0)
    assert HISTORY.at(0) == HISTORY.known[0][1]


def test_outside_the_blocks_the_sensor_moves_on() -> None:
    assert HISTORY.at(3 * NANOSECONDS).position == (16.0, 1.0, 0.0)
    assert HISTORY.at(-NANOSECONDS).position == (-4.0, 1.0, 0.0)
    assert yaw_deg(HISTORY.at(3 * NANOSECONDS)) == pytest.approx(-170.0)


def test_what_is_not_known_stays_unknown() -> None:
    history = SensorHistory(((0, Sensor()), (2 * NANOSECONDS, Sensor())))
    for stamp in (NANOSECONDS, 3 * NANOSECONDS):
        assert np.isnan(history.at(stamp).position).all()
        assert np.isnan(history.at(stamp).orientation).all()


def test_forgetting_does_not_change_what_is_asked_later() -> None:
    history = HISTORY.append(4 * NANOSECONDS, sensor(-160.0, 22.0))
    for seconds in (2.5, 3.0, 4.5):
        stamp = round(seconds * NANOSECONDS)
        assert history.since(round(2.5 * NANOSECONDS)).at(stamp) == history.at(stamp)
    assert len(history.since(round(2.5 * NANOSECONDS)).known) == 2
