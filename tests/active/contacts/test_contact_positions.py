"""Protects: contacts are placed where they were reflected, also by a moving own ship."""

import numpy as np
import pytest

from sonar_tracking.active.contacts.contact_positions import place_contacts, position_covariance
from sonar_tracking.records.contacts import Contacts


def test_contacts_are_placed_where_they_were_reflected() -> None:
    """A moving own ship hears the echo elsewhere than where it pinged."""
    target, speed = np.array([3000.0, 4000.0]), 1500.0
    velocity = np.array([8.0, -3.0])
    there = np.hypot(*target) / speed
    travel = there
    for _ in range(30):
        travel = there + np.hypot(*(target - travel * velocity)) / speed
    receiver = travel * velocity
    azimuth = np.arctan2(*(target - receiver)[::-1])
    placed = place_contacts(
        Contacts(
            stamp=1,
            range=np.array([0.5 * speed * travel]),
            azimuth=np.array([azimuth]),
            amplitude=np.zeros(0),
            range_standard_deviation=10.0,
            azimuth_standard_deviation=0.01,
            sensor_velocity=(8.0, -3.0),
        ),
        speed,
    )
    assert placed.position[0] == pytest.approx(target, abs=1e-6)
    assert placed.delay[0] == pytest.approx(there, abs=1e-9)
    distance = np.hypot(*(target - receiver))
    assert np.linalg.det(placed.covariance[0]) == pytest.approx((10.0 * 0.01 * distance) ** 2)


@pytest.mark.parametrize("azimuth", [0.0, 0.7, 2.5, -1.2])
def test_errors_along_the_line_of_sight_are_those_of_the_range(azimuth: float) -> None:
    """Whatever the direction; across it the azimuth's error grows with the distance."""
    contacts = Contacts(
        stamp=1,
        range=np.array([500.0, 2000.0]),
        azimuth=np.full(2, azimuth),
        amplitude=np.zeros(0),
        range_standard_deviation=np.array([10.0, 5.0]),
        azimuth_standard_deviation=0.01,
        sensor_position=(30.0, -40.0),
        sensor_velocity=(8.0, -3.0),
    )
    placed = place_contacts(contacts, 0.0)  # sound takes no time: the sensor is where it was
    ahead = np.array([np.cos(azimuth), np.sin(azimuth)])
    across = np.array([-np.sin(azimuth), np.cos(azimuth)])
    for row, (along, aside) in enumerate([(10.0, 5.0), (5.0, 20.0)]):
        covariance = placed.covariance[row]
        assert ahead @ covariance @ ahead == pytest.approx(along**2)
        assert across @ covariance @ across == pytest.approx(aside**2)
        assert ahead @ covariance @ across == pytest.approx(0.0, abs=1e-9)
        expected = np.array([30.0, -40.0]) + contacts.range[row] * ahead
        assert placed.position[row] == pytest.approx(expected)
    assert placed.delay.tolist() == [0.0, 0.0]


def test_near_the_sensor_the_direction_says_little_of_the_place() -> None:
    """What is at the sensor is seen anywhere around it, at the distance of the range error."""
    direction = np.array([[1.0, 0.0], [0.6, 0.8], [1.0, 0.0]])
    distance = np.array([5.0, 29.0, 31.0])
    covariance = position_covariance(direction, distance, 10.0, 0.01)
    assert covariance[0] == pytest.approx(100.0 * np.eye(2))
    assert covariance[1] == pytest.approx(100.0 * np.eye(2))
    assert covariance[2] == pytest.approx(np.diag([100.0, 0.31**2]))
