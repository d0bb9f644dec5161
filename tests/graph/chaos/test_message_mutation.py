"""Malformed messages are made from good ones, which stay as they are, and from a seed alone."""

from __future__ import annotations

import array
import copy
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rclpy")

from nav_msgs.msg import Odometry
from sonar_tracking_msgs.msg import ArraySnapshots, Contacts

from sonar_tracking.graph.chaos.message_mutation import mutated


def contacts() -> Contacts:
    message = Contacts(sensor_id="sonar", range=[500.0, 700.0], azimuth=[0.1, 0.2])
    message.header.stamp.sec = 1000
    return message


def text(message: Any) -> str:
    return str(message)


MESSAGES = [contacts(), Odometry(), ArraySnapshots(data=array.array("f", [1.0] * 8))]


@pytest.mark.parametrize("message", MESSAGES, ids=lambda message: type(message).__name__)
def test_the_good_message_stays_and_the_malformed_ones_differ(message: Any) -> None:
    before = copy.deepcopy(message)
    malformed = [mutated(message, np.random.default_rng(seed)) for seed in range(200)]
    assert message == before
    assert len({text(each) for each in malformed}) > 100
    assert all(type(each) is type(message) for each in malformed)


def test_the_same_seed_gives_the_same_message() -> None:
    first, again = (text(mutated(contacts(), np.random.default_rng(5))) for _ in range(2))
    assert first == again


@pytest.mark.slow
def test_every_field_is_changed_now_and_then() -> None:
    good = contacts()
    changed: set[str] = set()
    for seed in range(2000):
        bad = mutated(good, np.random.default_rng(seed))
        changed |= {
            name
            for name in good.get_fields_and_field_types()
            if text(getattr(bad, name)) != text(getattr(good, name))
        }
    assert changed == set(good.get_fields_and_field_types())
