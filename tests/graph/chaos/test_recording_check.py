"""What a recording lacks is counted by what the living have published."""

from __future__ import annotations

import pytest

from sonar_tracking.graph.chaos.recording_check import longest_hole, messages_lost
from sonar_tracking.records.time import NANOSECONDS

TOPICS = {"simulator": ["/contacts", "/odometry"], "tracker": ["/tracks"]}
REPORT = {
    "nodes": {
        "simulator": {"messages_out": 5, "restarts": 0},
        "tracker": {"messages_out": 9, "restarts": 1},
    }
}


def test_messages_of_the_living_are_counted() -> None:
    assert messages_lost({"/contacts": [1, 2], "/odometry": [1, 2, 3]}, REPORT, TOPICS) == 0
    assert messages_lost({"/contacts": [1, 2]}, REPORT, TOPICS) == 3, "not those of the killed"


def test_a_hole_is_what_a_topic_lacks_beyond_its_period() -> None:
    whole = [second * NANOSECONDS for second in range(10)]
    assert longest_hole({"/contacts": whole}) == 0.0
    assert longest_hole({"/contacts": whole, "/tracks": whole[:4] + whole[7:]}) == pytest.approx(3)
