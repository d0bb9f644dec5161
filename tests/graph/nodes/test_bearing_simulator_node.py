"""The simulated stations serve the clock: frames when they are due, each in its namespace."""

from __future__ import annotations

import signal
from dataclasses import replace
from pathlib import Path

from sonar_tracking.graph.catalogue.topics import (
    BEARING_TRACKS,
    FREQUENCY_LINES,
    TRUE_BEARING_TRACKS,
    Topic,
)
from sonar_tracking.message_reading.array_reading import directions_from_message
from sonar_tracking.message_reading.field_reading import stamp_from_time
from sonar_tracking.message_reading.line_reading import frequency_lines_from_message
from sonar_tracking.records.bearings import AngleKind
from sonar_tracking.records.time import END_OF_DATA
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario
from sonar_tracking.simulation.sensors.bearing_simulation import BearingSimulation
from tests.graph.live_graph import Probe, node_process, stamps

NODE = "bearing_simulator"
MODULE = f"sonar_tracking.graph.nodes.{NODE}"
SECOND = 1_000_000_000
EPOCH = 1_767_225_600 * SECOND

SCENARIO = """
duration: 6.0
own_ship: {speed: 4.0}
bearing_sensors:
  - {frame_interval: 1.0}
  - {sensor_id: buoy, namespace: buoy, platform: fixed, angle_kind: azimuth, frame_interval: 2.0}
targets:
  - lines: [{frequency: 200.0}, {frequency: 300.0, present: [2.0, 4.0]}]
    motion: {kind: kinematic, position: [1000.0, 500.0], speed: 5.0}
"""


def of_buoy(topic: Topic) -> Topic:
    return replace(topic, name=f"buoy/{topic.name}")


STATION = (BEARING_TRACKS, FREQUENCY_LINES, TRUE_BEARING_TRACKS)
TOPICS = (*STATION, *map(of_buoy, STATION))


def test_every_station_publishes_its_frames_once_when_they_are_due(tmp_path: Path) -> None:
    path = tmp_path / "short.yaml"
    path.write_text(SCENARIO)
    probe = Probe()
    heard = {topic.name: probe.listen(topic) for topic in TOPICS}
    bearings, lines = heard[BEARING_TRACKS.name], heard[FREQUENCY_LINES.name]
    with node_process(MODULE, tmp_path / "log", use_sim_time=True, scenario=path) as process:
        probe.wait_matched(NODE, "/clock", "/flow/done", *(f"/{topic.name}" for topic in TOPICS))
        for number, (time, frames) in enumerate([(0.0, 0), (1.0, 1), (2.5, 2), (2.5, 2)], start=1):
            probe.tick(EPOCH + round(time * SECOND))
            probe.wait_for_count(
                lambda: sum(each.topic == "/clock" for each in probe.progress), number, "ticks"
            )
            probe.wait_for_count(bearings.__len__, frames, "frames")
            assert len(bearings) == frames
        probe.tick(EPOCH + 6 * SECOND)
        probe.wait(
            lambda: (
                all(
                    each[-1].next_stamp.sec > 2e9
                    for each in heard.values()
                    if each and hasattr(each[0], "next_stamp")
                )
                and len(bearings) == 6
            ),
            "end",
        )
        assert process.stop(signal.SIGINT) == 0
        assert "Traceback" not in process.output
    probe.close()
    sent = [EPOCH + number * SECOND for number in range(6)]
    for topic in STATION:
        assert stamps(heard[topic.name]) == sent
    for topic in map(of_buoy, STATION):
        assert stamps(heard[topic.name]) == sent[::2]
        following = [stamp_from_time(message.next_stamp) for message in heard[topic.name]]
        assert following == [*sent[2::2], END_OF_DATA]
    simulation = BearingSimulation(load_scenario(path))
    simulated = list(iter(simulation.next_frame, None))
    for frame, message, other in zip(simulated, bearings, lines, strict=True):
        expected = frame.reports[0]
        assert expected.bearings is not None and expected.lines is not None
        found = directions_from_message(message)
        assert found.measurement.tolist() == expected.bearings.measurement.tolist()
        frequency = frequency_lines_from_message(other).frequency
        assert frequency.tolist() == expected.lines.frequency.tolist()
    buoy = directions_from_message(heard["buoy/passive/bearing_tracks"][0])
    assert buoy.angle_kind is AngleKind.AZIMUTH and buoy.sensor.sensor_id == "buoy"


def test_a_scenario_without_stations_is_named_and_the_node_ends(tmp_path: Path) -> None:
    with node_process(MODULE, tmp_path / "log", use_sim_time=True, scenario="doa_fusion") as node:
        assert node.wait() == 1
        assert "doa_fusion has no section bearing_sensors" in node.output
