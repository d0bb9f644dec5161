"""The simulated sonar serves the clock: a ping when its last echo is in, nothing twice."""

from __future__ import annotations

import signal
from pathlib import Path

import pytest
from sonar_tracking_msgs.msg import Progress

from sonar_tracking.graph.catalogue import run_identity
from sonar_tracking.graph.catalogue.topics import CONTACTS, TIME_TOPIC
from sonar_tracking.graph.message_writing.field_writing import time_from_stamp
from sonar_tracking.graph.node_base import quality_of_service
from sonar_tracking.message_reading.contact_reading import contacts_from_message
from sonar_tracking.message_reading.field_reading import stamp_from_time
from sonar_tracking.records.time import END_OF_DATA
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario
from sonar_tracking.simulation.sensors.active_sonar_simulation import ActiveSonarSimulation
from tests.graph.live_graph import Probe, node_process, stamps

NODE = "contact_simulator"
MODULE = f"sonar_tracking.graph.nodes.{NODE}"
SECOND = 1_000_000_000
EPOCH = 1_767_225_600 * SECOND

SCENARIO = """
duration: 25.0
active_sonar: {ping_interval: 5.0, maximum_range: 3000.0}
own_ship: {speed: 4.0}
targets:
  - motion: {kind: kinematic, position: [1000.0, 500.0], speed: 5.0}
  - present: [8.0, 18.0]
    motion: {kind: kinematic, position: [-1000.0, 500.0], speed: 5.0}
"""


@pytest.fixture
def scenario(tmp_path: Path) -> Path:
    path = tmp_path / "short.yaml"
    path.write_text(SCENARIO)
    return path


def test_a_ping_is_published_once_when_its_last_echo_is_in(tmp_path: Path, scenario: Path) -> None:
    probe = Probe()
    contacts = probe.listen(CONTACTS)
    with node_process(MODULE, tmp_path / "log", use_sim_time=True, scenario=scenario) as process:
        probe.wait_matched(NODE, "/clock", "/flow/done", f"/{CONTACTS.name}")

        def served() -> int:
            return sum(each.topic == "/clock" for each in probe.progress)

        ticks = [(0.0, 0), (3.9, 0), (4.0, 1), (8.9, 1), (9.0, 2), (9.0, 2)]
        for number, (time, pings) in enumerate(ticks, start=1):
            probe.tick(EPOCH + round(time * SECOND))
            probe.wait_for_count(served, number, "ticks served")
            probe.wait_for_count(contacts.__len__, pings, "pings")
            assert len(contacts) == pings
        probe.tick(EPOCH + 100 * SECOND)
        probe.wait(lambda: len(contacts) == 5, "the end of the data")
        assert process.stop(signal.SIGINT) == 0
        assert "Traceback" not in process.output
    probe.close()
    sent = [EPOCH + 5 * number * SECOND for number in range(5)]
    assert stamps(contacts) == sent
    following = [stamp_from_time(message.next_stamp) for message in contacts]
    assert following == [*sent[1:], END_OF_DATA]
    expected = [ping.contacts for ping in ActiveSonarSimulation(load_scenario(scenario))]
    for message, record in zip(contacts, expected, strict=True):
        assert contacts_from_message(message).range.tolist() == record.range.tolist()


def test_a_scenario_without_an_active_sonar_is_named_and_the_node_ends(tmp_path: Path) -> None:
    with node_process(MODULE, tmp_path / "log", use_sim_time=True, scenario="doa_fusion") as node:
        assert node.wait() == 1
        assert "doa_fusion has no section active_sonar" in node.output


def test_a_simulator_of_a_run_follows_the_time_of_that_run_alone(
    tmp_path: Path, scenario: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(run_identity.VARIABLE, "0123")
    probe = Probe()
    contacts = probe.listen(CONTACTS)
    time = probe.node.create_publisher(Progress, TIME_TOPIC, quality_of_service.CLOCK)

    def tell(who: str, seconds: float) -> None:
        told = Progress(node=who, topic="/clock")
        told.header.stamp = time_from_stamp(EPOCH + round(seconds * SECOND))
        time.publish(told)

    with node_process(MODULE, tmp_path / "log", use_sim_time=True, scenario=scenario):
        probe.wait_matched(NODE, "/clock", f"/{TIME_TOPIC}", f"/{CONTACTS.name}")
        probe.tick(EPOCH + 100 * SECOND)
        tell("orchestration", 100.0)
        tell("orchestration@4567", 100.0)
        tell("orchestration@0123", 4.0)
        probe.wait(lambda: bool(contacts), "the first ping")
        tell("orchestration@0123", 9.0)
        probe.wait(lambda: len(contacts) > 1, "the second ping")
    assert stamps(contacts) == [EPOCH, EPOCH + 5 * SECOND]
