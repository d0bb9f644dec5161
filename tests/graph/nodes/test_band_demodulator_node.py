"""A live band_demodulator: snapshots without gaps from good samples, bad ones named and missing."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sonar_tracking.graph.catalogue.topics import SAMPLES, SNAPSHOTS
from sonar_tracking.graph.message_writing.sample_writing import samples_to_message
from sonar_tracking.message_reading.array_reading import snapshots_from_message
from sonar_tracking.passive.lines.band_demodulator_stage import (
    BandDemodulatorConfiguration,
    BandDemodulatorStage,
)
from sonar_tracking.records.bearings import ArraySnapshots
from sonar_tracking.records.samples import ArraySamples
from sonar_tracking.records.time import END_OF_DATA, NANOSECONDS
from tests.graph.live_graph import NodeProcess, Probe, node_process, stamps
from tests.passive.sample_scene import EPOCH, RATE, Tone, blocks, element_samples

NODE = "band_demodulator"
MODULE = f"sonar_tracking.graph.nodes.{NODE}"
INPUT = f"{NODE}: input /array/samples"
CONFIGURATION = BandDemodulatorConfiguration(300.0, 4.0, 4)
SCENE = element_samples([Tone(300.4, 25.0, 30.0)], 5.0)


def expected(stream: list[ArraySamples]) -> list[ArraySnapshots]:
    """Return what the stage itself makes of samples as single precision carries them."""
    stage = BandDemodulatorStage(CONFIGURATION)
    rounded = [replace(each, data=each.data.astype(np.float32).astype(float)) for each in stream]
    return [block for each in rounded for block in stage.update(each)]


class Demodulator:
    """A live demodulator and the means to feed it."""

    def __init__(self, process: NodeProcess, probe: Probe) -> None:
        self.process = process
        self.probe = probe
        self.snapshots = probe.listen(SNAPSHOTS)
        self._publisher = probe.publisher(SAMPLES)
        self._start = EPOCH
        self._sent = 0

    def new_run(self) -> list[ArraySamples]:
        """Begin so far back that the node begins again; return the blocks of the scene."""
        self._start -= 1000 * NANOSECONDS
        self.snapshots.clear()
        self.probe.diagnostics.clear()
        return blocks(SCENE, stamp=self._start)

    def send(self, *sent: Any) -> None:
        """Publish blocks, or messages as they are, and wait until each is finished."""
        for each in sent:
            record = isinstance(each, ArraySamples)
            self._publisher.publish(samples_to_message(each) if record else each)
            self._sent += 1
            self.probe.wait(
                lambda: self.probe.finished(NODE, "/array/samples") >= self._sent,
                f"message {self._sent} finished; output of the node:\n{self.process.output}",
            )

    def assert_made(self, blocks_made: list[ArraySnapshots]) -> None:
        """Check that exactly these blocks have come, bit for bit."""
        self.probe.wait_for_count(self.snapshots.__len__, len(blocks_made), "blocks")
        assert stamps(self.snapshots) == [each.stamp for each in blocks_made]
        for message, block in zip(self.snapshots, blocks_made, strict=True):
            made = snapshots_from_message(message)
            np.testing.assert_array_equal(made.data, block.data)
            assert made.next_stamp == block.next_stamp
            assert made.sample_period == block.sample_period
        assert self.process.is_alive

    def assert_rejected(self, bad: Any, *parts: str) -> None:
        """Check that a bad block in the place of the tenth is named, and as good as lost."""
        good = self.new_run()
        self.send(*good[:10], bad(good[10]), *good[11:])
        self.probe.wait_sentence(INPUT, "rejected", *parts)
        self.assert_made(expected(good[:10] + good[11:]))


@pytest.fixture(scope="module")
def demodulator(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Demodulator]:
    log = tmp_path_factory.mktemp("demodulator") / "log.txt"
    parameters = {
        "use_sim_time": True,
        "center_frequency": 300.0,
        "bandwidth": 4.0,
    }
    probe = Probe()
    with node_process(MODULE, log, **parameters) as process:
        demodulator = Demodulator(process, probe)
        probe.wait_matched(NODE, "/array/samples", "/array/snapshots", "/flow/done")
        yield demodulator
    probe.close()


def test_snapshots_are_those_of_the_stage_to_the_end_of_the_data(demodulator: Demodulator) -> None:
    good = demodulator.new_run()
    demodulator.send(*good)
    demodulator.assert_made(expected(good))
    last = snapshots_from_message(demodulator.snapshots[-1])
    assert last.next_stamp == END_OF_DATA
    assert (last.center_frequency, last.bandwidth) == (300.0, 4.0)
    assert last.data.shape[1] == len(good[0].element_positions)


def test_samples_that_are_not_finite(demodulator: Demodulator) -> None:
    def bad(block: ArraySamples) -> ArraySamples:
        data = block.data.copy()
        data[3, 1] = np.nan
        return replace(block, data=data)

    demodulator.assert_rejected(bad, "Element 1 of sample 3", "not a finite number")


def test_a_wrong_number_of_values(demodulator: Demodulator) -> None:
    def bad(block: ArraySamples) -> Any:
        message = samples_to_message(block)
        message.n_samples += 1
        return message

    demodulator.assert_rejected(bad, "ArraySamples.data has 4000 values", "need 4016")


def test_another_sample_rate(demodulator: Demodulator) -> None:
    demodulator.assert_rejected(
        lambda block: replace(block, sample_rate=2.0 * RATE),
        "sample_rate changed from 1000 to 2000",
    )


def test_a_run_that_cannot_be_demodulated_is_refused_and_the_next_one_is_used(
    demodulator: Demodulator,
) -> None:
    """Of a longer array 4 Hz are no narrow band."""
    long = [
        replace(block, element_positions=20.0 * block.element_positions)
        for block in demodulator.new_run()[:2]
    ]
    demodulator.send(*long)
    demodulator.probe.wait_sentence(INPUT, "rejected", "bandwidth is 4 Hz", "must be below")
    good = demodulator.new_run()
    demodulator.send(*good)
    demodulator.assert_made(expected(good))


def test_it_ended_well(demodulator: Demodulator) -> None:
    """Last: everything announced, nothing unexpected."""
    announced = [p.count for p in demodulator.probe.progress if p.topic == "/array/snapshots"]
    assert announced == sorted(set(announced))
    assert demodulator.process.stop(signal.SIGINT) == 0
    assert "Traceback" not in demodulator.process.output
