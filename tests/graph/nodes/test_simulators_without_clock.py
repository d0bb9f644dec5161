"""Without simulation time a scenario begins for all at the present, when somebody listens."""

from __future__ import annotations

import time
from itertools import pairwise
from pathlib import Path

import pytest

from sonar_tracking.graph.catalogue.topics import (
    BEARING_TRACKS,
    CONTACTS,
    ODOMETRY,
    SNAPSHOTS,
    TRUE_TRACKS,
)
from sonar_tracking.graph.message_writing.field_writing import time_from_stamp
from sonar_tracking.records.time import END_OF_DATA
from tests.graph.live_graph import Probe, node_process, stamps

SECOND = 1_000_000_000
REST = (
    "own_ship: {speed: 4.0}, targets: [{motion: {kind: kinematic, position: [1000.0, 500.0], "
    "speed: 5.0}}], start: 7.0, duration: 2.0}"
)
SIMULATED = {
    "array_simulator": (
        SNAPSHOTS,
        f"{{array: {{n_elements: 4, snapshot_rate: 100.0, block_snapshots: 20}}, {REST}",
    ),
    "contact_simulator": (
        CONTACTS,
        f"{{active_sonar: {{ping_interval: 0.2, sound_speed: 0.0}}, {REST}",
    ),
    "bearing_simulator": (BEARING_TRACKS, f"{{bearing_sensors: [{{frame_interval: 0.2}}], {REST}"),
}
WORLD = "sonar_tracking.graph.nodes.world_simulator"


@pytest.mark.parametrize("simulator", SIMULATED)
def test_it_begins_at_the_present_when_somebody_listens(simulator: str, tmp_path: Path) -> None:
    """Data, truth and own ship; the epoch of the scenario is that of recordings."""
    topic, text = SIMULATED[simulator]
    scenario = tmp_path / "scenario.yaml"
    scenario.write_text(text)
    probe = Probe("late_listener")
    module = f"sonar_tracking.graph.nodes.{simulator}"
    with (
        node_process(module, tmp_path / "log", scenario=scenario),
        node_process(WORLD, tmp_path / "world", scenario=scenario),
    ):
        probe.wait(lambda: probe.matched(simulator), "the simulator")
        probe.wait(lambda: probe.matched("world_simulator"), "the world")
        before, began = time.time_ns(), time.monotonic_ns()
        heard = {each.name: probe.listen(each) for each in (topic, TRUE_TRACKS, ODOMETRY)}
        data = heard[topic.name]
        end = time_from_stamp(END_OF_DATA)
        truth, odometry = heard[TRUE_TRACKS.name], heard[ODOMETRY.name]
        probe.wait(lambda: data and data[-1].next_stamp == end, "the end of the data")
        probe.wait(lambda: truth and truth[-1].next_stamp == end, "the end of the truth")
        probe.wait(lambda: stamps(odometry)[-1:] >= stamps(data)[-1:], "own ship at the end")
        after, elapsed = time.time_ns(), time.monotonic_ns() - began
    probe.close()
    told = stamps(data)
    # The clock of the machine may be set meanwhile, forwards or back: both of its courses count.
    assert min(before, after - elapsed) <= told[0]
    assert told[-1] <= max(after, before + elapsed)
    assert len(told) >= 10
    assert all(later - now == SECOND // 5 for now, later in pairwise(told))
    assert told[-1] in stamps(odometry)
    assert stamps(truth)[-1] == told[-1]


def test_a_sensor_without_a_world_says_what_it_waits_for(tmp_path: Path) -> None:
    topic, text = SIMULATED["contact_simulator"]
    scenario = tmp_path / "scenario.yaml"
    scenario.write_text(text)
    probe = Probe("listener")
    contacts = probe.listen(topic)
    module = "sonar_tracking.graph.nodes.contact_simulator"
    with node_process(module, tmp_path / "log", scenario=scenario):
        probe.wait_sentence("contact_simulator: scenario", "waits for world_simulator", "start it")
    assert contacts == []
    probe.close()
