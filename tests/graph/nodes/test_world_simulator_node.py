"""The world tells own ship and the truth once at every instant that a sensor needs, when it is."""

from __future__ import annotations

import signal
from pathlib import Path

from sonar_tracking.graph.catalogue.topics import ODOMETRY, TRUE_TRACKS
from sonar_tracking.message_reading.field_reading import stamp_from_time
from sonar_tracking.records.time import END_OF_DATA
from tests.graph.live_graph import Probe, node_process, stamps

NODE = "world_simulator"
MODULE = f"sonar_tracking.graph.nodes.{NODE}"
SECOND = 1_000_000_000
EPOCH = 1_767_225_600 * SECOND

SCENARIO = """
duration: 12.0
own_ship: {speed: 4.0}
active_sonar: {ping_interval: 6.0, maximum_range: 3000.0}
bearing_sensors:
  - {sensor_id: buoy, namespace: buoy, platform: fixed, frame_interval: 3.0}
targets:
  - motion: {kind: kinematic, position: [1000.0, 500.0], speed: 5.0}
  - present: [5.0, 10.0]
    motion: {kind: kinematic, position: [-1000.0, 500.0], speed: 5.0}
"""
# Pings at 0 and 6 s take 4 s; frames at 0, 3, 6 and 9 s.
OWN_SHIP = [0, 3, 4, 6, 9, 10]
TRUTH = [0, 3, 6, 9]


def test_every_instant_is_told_once_when_it_is_there(tmp_path: Path) -> None:
    path = tmp_path / "short.yaml"
    path.write_text(SCENARIO)
    probe = Probe()
    odometry, truth = probe.listen(ODOMETRY), probe.listen(TRUE_TRACKS)
    with node_process(MODULE, tmp_path / "log", use_sim_time=True, scenario=path) as process:
        probe.wait_matched(
            NODE, "/clock", "/flow/done", f"/{ODOMETRY.name}", f"/{TRUE_TRACKS.name}"
        )

        def served() -> int:
            return sum(each.topic == "/clock" for each in probe.progress)

        ticks = [(0.0, 1, 1), (3.9, 2, 2), (4.0, 3, 2), (9.0, 5, 4), (9.0, 5, 4), (100.0, 6, 4)]
        for number, (time, states, pictures) in enumerate(ticks, start=1):
            probe.tick(EPOCH + round(time * SECOND))
            probe.wait_for_count(served, number, "ticks served")
            probe.wait_for_count(odometry.__len__, states, "states of own ship")
            probe.wait_for_count(truth.__len__, pictures, "pictures of the truth")
            assert (len(odometry), len(truth)) == (states, pictures)
        assert process.stop(signal.SIGINT) == 0
        assert "Traceback" not in process.output
    probe.close()
    assert stamps(odometry) == [EPOCH + time * SECOND for time in OWN_SHIP]
    assert [message.pose.pose.position.y for message in odometry] == [4.0 * t for t in OWN_SHIP]
    assert stamps(truth) == [EPOCH + time * SECOND for time in TRUTH]
    following = [stamp_from_time(message.next_stamp) for message in truth]
    assert following == [*stamps(truth)[1:], END_OF_DATA]
    assert [list(message.id) for message in truth] == [[1], [1], [1, 2], [1, 2]]


def test_a_malformed_scenario_is_named_and_the_node_ends(tmp_path: Path) -> None:
    bad = tmp_path / "bad.yaml"
    bad.write_text("duration: 10\nown_ship: {speed: fast}\n")
    with node_process(MODULE, tmp_path / "log", use_sim_time=True, scenario=bad) as process:
        assert process.wait() == 1
        assert all(part in process.output for part in (f"{NODE}.scenario: ", "own_ship.speed"))
        assert "Traceback" not in process.output
