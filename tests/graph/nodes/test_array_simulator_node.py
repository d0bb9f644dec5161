"""The simulator serves the clock: everything due, nothing twice, nothing before its time."""

from __future__ import annotations

import signal
from itertools import islice
from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.graph.catalogue import resumption
from sonar_tracking.graph.catalogue.topics import SNAPSHOTS, TRUE_BEARING_TRACKS
from sonar_tracking.message_reading.array_reading import snapshots_from_message
from sonar_tracking.records.time import END_OF_DATA
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario
from sonar_tracking.simulation.sensors.array_simulation import ArraySimulation
from tests.graph.live_graph import Probe, node_process, stamps

NODE = "array_simulator"
MODULE = f"sonar_tracking.graph.nodes.{NODE}"
SECOND = 1_000_000_000
EPOCH = 1_767_225_600 * SECOND
BLOCK = SECOND // 10

SCENARIO = """
duration: 1.05
array: {n_elements: 4, snapshot_rate: 200.0, block_snapshots: 20}
targets:
  - motion: {kind: linear}
"""
TOPICS = (SNAPSHOTS, TRUE_BEARING_TRACKS)


@pytest.fixture
def scenario(tmp_path: Path) -> Path:
    path = tmp_path / "short.yaml"
    path.write_text(SCENARIO)
    return path


def test_everything_due_is_published_once_whatever_the_ticks(
    tmp_path: Path, scenario: Path
) -> None:
    probe = Probe()
    heard = {topic.name: probe.listen(topic) for topic in TOPICS}
    with node_process(MODULE, tmp_path / "log", use_sim_time=True, scenario=scenario) as process:
        probe.wait_matched(NODE, "/clock", "/flow/done", *(f"/{topic.name}" for topic in TOPICS))

        def served() -> int:
            return sum(each.topic == "/clock" for each in probe.progress)

        ticks = [(0, 0), (9, 0), (10, 1), (15, 1), (52, 5), (52, 5)]
        for number, (tenths_of_block, blocks) in enumerate(ticks, start=1):
            probe.tick(EPOCH + tenths_of_block * BLOCK // 10)
            probe.wait_for_count(served, number, "ticks served")
            probe.wait_for_count(heard[SNAPSHOTS.name].__len__, blocks, "blocks")
            assert len(heard[SNAPSHOTS.name]) == blocks
        probe.tick(EPOCH + 100 * SECOND)
        probe.wait(lambda: len(heard[SNAPSHOTS.name]) == 11, "the end of the data")

        snapshots = heard[SNAPSHOTS.name]
        assert stamps(snapshots) == [EPOCH + number * BLOCK for number in range(11)]
        assert [message.n_snapshots for message in snapshots] == [20] * 10 + [10]
        assert snapshots[-1].next_stamp.sec * SECOND == END_OF_DATA
        assert stamps(heard[TRUE_BEARING_TRACKS.name]) == stamps(snapshots)
        announced = [p.count for p in probe.progress if p.topic == "/array/snapshots"]
        assert announced == list(range(1, 12))
        assert process.stop(signal.SIGINT) == 0
        assert "Traceback" not in process.output
    probe.close()


def test_a_simulator_started_again_goes_on_at_the_clock(tmp_path: Path) -> None:
    """It repeats only what may have been lost with the process before it."""
    probe = Probe()
    heard = probe.listen(SNAPSHOTS)
    log = tmp_path / "log"
    with node_process(MODULE, log, use_sim_time=True, scenario="doa_fusion", flow_depth=8):
        probe.wait_matched(NODE, "/clock", "/array/snapshots")
        probe.tick(EPOCH + 20 * SECOND)
        probe.wait(lambda: len(heard) >= 4, "blocks")
        probe.tick(EPOCH + 20 * SECOND + BLOCK)
        probe.wait(lambda: len(heard) >= 5, "the next block")
        assert stamps(heard)[-1] == EPOCH + 20 * SECOND
        assert len(heard) == 5
    probe.close()


def test_a_simulator_in_the_place_of_a_killed_one_takes_its_simulation_up(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The data go on to the last bit behind what was received, from the checkpoint of the run."""
    monkeypatch.setenv(resumption.CHECKPOINT, str(tmp_path / "checkpoint"))
    whole = iter(ArraySimulation(load_scenario("doa_fusion")).next_block, None)
    expected = {block.snapshots.stamp: block.snapshots.data for block in islice(whole, 35)}
    received = sorted(expected)[24]
    probe = Probe()
    heard = probe.listen(SNAPSHOTS)
    with node_process(MODULE, tmp_path / "log", use_sim_time=True, scenario="doa_fusion"):
        probe.wait_matched(NODE, "/clock", "/array/snapshots")
        probe.tick(min(expected))
        probe.tick(received + 6 * BLOCK)
        probe.wait(lambda: len(heard) == 30, "the first blocks")
    monkeypatch.setenv(resumption.VARIABLE, str(received))
    assert b"ArraySimulation" in (tmp_path / "checkpoint").read_bytes()
    probe.diagnostics.clear()
    with node_process(MODULE, tmp_path / "log", use_sim_time=True, scenario="doa_fusion"):
        probe.wait_matched(NODE, "/clock", "/array/snapshots")

        def repeated() -> bool:
            probe.tick(received + 6 * BLOCK)  # the probe may not have found the new process yet
            return len(heard) == 35

        probe.wait(repeated, "what was not received")
        probe.tick(received + 11 * BLOCK)
        probe.wait(lambda: len(heard) == 40, "the blocks behind what was received")
    assert stamps(heard[30:]) == sorted(expected)[25:35]
    for message in heard[30:]:
        block = snapshots_from_message(message)
        np.testing.assert_array_equal(block.data, expected[block.stamp])
    probe.close()


def test_a_malformed_scenario_is_named_and_the_node_ends(tmp_path: Path) -> None:
    bad = tmp_path / "bad.yaml"
    bad.write_text("duration: 10\narray: {n_elements: [4\n")
    with node_process(MODULE, tmp_path / "log", use_sim_time=True, scenario=bad) as process:
        assert process.wait() == 1
        for part in (f"{NODE}.scenario: ", "bad.yaml", "line 3", "not valid YAML"):
            assert part in process.output
        assert "Traceback" not in process.output
