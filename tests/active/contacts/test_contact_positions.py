"""Protects: contacts are placed where they were reflected, also by a moving own ship."""

import numpy as np
import pytest

from sonar_tracking.active.contacts.contact_positions import place_contacts
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
