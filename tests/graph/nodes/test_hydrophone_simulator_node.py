"""The hydrophone simulator serves the clock: the simulation's own samples, each block once."""

from __future__ import annotations

import signal
from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.graph.catalogue.topics import SAMPLES, TRUE_BEARING_TRACKS
from sonar_tracking.message_reading.sample_reading import samples_from_message
from sonar_tracking.records.time import END_OF_DATA
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario
from sonar_tracking.simulation.sensors.sample_simulation import SampleSimulation
from tests.graph.live_graph import Probe, node_process, stamps

NODE = "hydrophone_simulator"
MODULE = f"sonar_tracking.graph.nodes.{NODE}"
SECOND = 1_000_000_000
EPOCH = 1_767_225_600 * SECOND
BLOCK = SECOND // 4

SCENARIO = """
duration: 1.1
array: {n_elements: 4, spacing: 2.0, center_frequency: 300.0, bandwidth: 5.0}
hydrophones: {sample_rate: 1000.0, block_samples: 250}
targets:
  - lines: [{frequency: 250.0, level_db: 30.0}]
    motion: {kind: kinematic, position: [0.0, 900.0]}
"""
TOPICS = (SAMPLES, TRUE_BEARING_TRACKS)


@pytest.fixture
def scenario(tmp_path: Path) -> Path:
    path = tmp_path / "short.yaml"
    path.write_text(SCENARIO)
    return path


def test_blocks_are_those_of_the_simulation_and_come_when_they_are_due(
    tmp_path: Path, scenario: Path
) -> None:
    probe = Probe()
    heard = {topic.name: probe.listen(topic) for topic in TOPICS}
    with node_process(MODULE, tmp_path / "log", use_sim_time=True, scenario=scenario) as process:
        probe.wait_matched(NODE, "/clock", "/flow/done", *(f"/{topic.name}" for topic in TOPICS))

        def served() -> int:
            return sum(each.topic == "/clock" for each in probe.progress)

        # A block is due when its last sample lies in the past; a tick twice brings nothing.
        ticks = [(0, 0), (BLOCK - 1, 0), (BLOCK, 1), (3 * BLOCK, 3), (3 * BLOCK, 3)]
        for number, (time, n_blocks) in enumerate([*ticks, (100 * SECOND, 5)], start=1):
            probe.tick(EPOCH + time)
            probe.wait_for_count(served, number, "ticks served")
            probe.wait_for_count(heard[SAMPLES.name].__len__, n_blocks, "blocks")
            assert len(heard[SAMPLES.name]) == n_blocks

        samples = [samples_from_message(message) for message in heard[SAMPLES.name]]
        simulation = SampleSimulation(load_scenario(str(scenario)))
        for sent, simulated in zip(samples, iter(simulation.next_block, None), strict=True):
            assert sent.stamp == simulated.samples.stamp
            assert sent.next_stamp == simulated.samples.next_stamp
            np.testing.assert_array_equal(sent.data, simulated.samples.data)
        assert [len(each.data) for each in samples] == [250] * 4 + [100]
        assert samples[-1].next_stamp == END_OF_DATA
        starts = [EPOCH + number * BLOCK for number in range(5)]
        assert stamps(heard[TRUE_BEARING_TRACKS.name]) == starts
        assert process.stop(signal.SIGINT) == 0
        assert "Traceback" not in process.output
    probe.close()


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        (
            "array: {n_elements: 4}\n",
            ("no section hydrophones to simulate",),
        ),
        (
            SCENARIO.replace("frequency: 250.0", "frequency: 600.0"),
            ("600 Hz", "sample_rate above 1200 Hz"),
        ),
    ],
)
def test_a_scenario_that_cannot_be_simulated_is_named_and_the_node_ends(
    tmp_path: Path, text: str, parts: tuple[str, ...]
) -> None:
    bad = tmp_path / "bad.yaml"
    bad.write_text(text)
    with node_process(MODULE, tmp_path / "log", use_sim_time=True, scenario=bad) as process:
        assert process.wait() == 1
        assert all(part in process.output for part in (f"{NODE}.scenario: ", *parts))
        assert "Traceback" not in process.output
