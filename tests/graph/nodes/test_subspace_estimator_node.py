"""Bad input to a live estimator: a sentence, exactly one output a sample time, and it lives on."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sonar_tracking.geometry import line_array
from sonar_tracking.graph.catalogue.topics import SNAPSHOTS, SUBSPACES
from sonar_tracking.graph.message_writing import array_writing
from sonar_tracking.records.bearings import ArraySnapshots, Sensor
from tests.graph.live_graph import PATIENCE, NodeProcess, Probe, node_process, stamps

NODE = "subspace_estimator"
MODULE = f"sonar_tracking.graph.nodes.{NODE}"
INPUT = f"{NODE}: input /array/snapshots"
SECOND = 1_000_000_000
BLOCK = SECOND // 10
N_SNAPSHOTS, N_ELEMENTS = 20, 8
NEWEST_RUN = 1_767_225_600 * SECOND
CLOCK_START = NEWEST_RUN


def block(start: int, number: int, elements: int = N_ELEMENTS) -> ArraySnapshots:
    """Block ``number`` of a run that starts at ``start``: one source in noise."""
    generator = np.random.default_rng(number)
    shape = (N_SNAPSHOTS, elements)
    noise = generator.normal(size=(*shape, 2)).view(np.complex128)[..., 0]
    stamp = start + number * BLOCK
    return ArraySnapshots(
        stamp=stamp,
        data=noise + 3.0,
        element_positions=line_array(elements, 0.5),
        sample_period=0.005,
        center_frequency=1500.0,
        bandwidth=10.0,
        sound_speed=1500.0,
        next_stamp=stamp + BLOCK,
    )


class Estimator:
    """A live estimator and the means to feed it."""

    def __init__(self, process: NodeProcess, probe: Probe) -> None:
        self.process = process
        self.probe = probe
        self.outputs = probe.listen(SUBSPACES)
        self.publisher = probe.publisher(SNAPSHOTS)
        self.sent = 0
        self._run = NEWEST_RUN
        self._clock = CLOCK_START

    def let_clock_run(self, condition: Callable[[], object], what: str) -> None:
        """Let ``/clock`` advance second by second until a condition holds.

        The clock inside rclpy subscribes best effort: a tick may be lost, so the next one does
        not wait for its answer for ever.
        """

        def told_after_tick() -> bool:
            answered = len(self.probe.diagnostics) > heard
            return bool(condition()) or answered or time.monotonic() > ticked + 1.0

        deadline = time.monotonic() + PATIENCE
        while not condition():
            assert time.monotonic() < deadline, f"not within {PATIENCE:g} s: {what}"
            heard = len(self.probe.diagnostics)
            self._clock += SECOND
            ticked = time.monotonic()
            self.probe.tick(self._clock)
            self.probe.wait(told_after_tick, f"state of the node after a second, for {what}")

    def new_run(self) -> int:
        """Return the start of a run that lies so far back that the node begins again."""
        self._run -= 1000 * SECOND
        self.outputs.clear()
        self.probe.diagnostics.clear()
        return self._run

    def send(self, *blocks: Any) -> None:
        """Publish blocks (or messages) and wait until the node has finished them."""
        for each in blocks:
            record = isinstance(each, ArraySnapshots)
            self.publisher.publish(array_writing.snapshots_to_message(each) if record else each)
            self.sent += 1
            self.probe.wait(
                lambda: self.probe.finished(NODE, "/array/snapshots") >= self.sent,
                f"message {self.sent} finished; output of the node:\n{self.process.output}",
            )

    def assert_one_output_each(self, first: int, last: int) -> None:
        """Every sample time from first to last has given exactly one output, in order."""
        self.probe.wait(
            lambda: self.outputs and stamps(self.outputs)[-1] >= last, f"output at {last}"
        )
        assert stamps(self.outputs) == list(range(first, last + 1, BLOCK))
        assert self.process.is_alive

    def assert_rejected(self, bad: Any, start: int, *parts: str) -> None:
        """Check that a bad block between good ones is named, and the good ones are all used."""
        self.send(*(block(start, number) for number in range(3)))
        self.send(bad)
        self.send(*(block(start, number) for number in range(4, 8)))
        self.probe.wait_sentence(INPUT, "rejected", *parts)
        self.assert_one_output_each(start + BLOCK, start + 7 * BLOCK)
        incomplete = [each for each in self.outputs if each.n_subspaces < 3]
        assert 1 <= len(incomplete) <= 2, "only what the bad block held is missing"
        assert self.outputs[-1].n_subspaces == 3


@pytest.fixture(scope="module")
def estimator(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Estimator]:
    log = tmp_path_factory.mktemp("estimator") / "log.txt"
    parameters = {
        "use_sim_time": True,
        "method": "covariance",
        "period": 0.1,
        "source_count": 2,
        "n_subspaces": 3,
        "update_snapshots": 5,
        "reset_after": 2.0,
    }
    probe = Probe()
    with node_process(MODULE, log, **parameters) as process:
        estimator = Estimator(process, probe)
        probe.wait_matched(NODE, "/array/snapshots", "/array/subspaces", "/clock", "/flow/done")
        probe.wait(lambda: estimator.publisher.get_subscription_count(), "probe matched")
        yield estimator
    probe.close()


def test_good_data_give_one_output_a_sample_time(estimator: Estimator) -> None:
    start = estimator.new_run()
    estimator.send(*(block(start, number) for number in range(6)))
    estimator.assert_one_output_each(start + BLOCK, start + 5 * BLOCK)
    assert (
        not any(estimator.probe.sentences(INPUT)[-1:])
        or "rejected" not in (estimator.probe.sentences(INPUT)[-1])
    )


@pytest.mark.parametrize("value", [np.nan, np.inf, complex(0.0, -np.inf)])
def test_samples_that_are_not_finite(estimator: Estimator, value: complex) -> None:
    start = estimator.new_run()
    bad = block(start, 3)
    bad.data[7, 2] = value
    estimator.assert_rejected(bad, start, "Element 2", "not a finite number")


def test_a_wrong_element_count(estimator: Estimator) -> None:
    start = estimator.new_run()
    bad = array_writing.snapshots_to_message(block(start, 3))
    bad.data = bad.data[:-2]
    estimator.assert_rejected(bad, start, "ArraySnapshots.data has 318 values", "need 320")


def test_zero_snapshots(estimator: Estimator) -> None:
    start = estimator.new_run()
    bad = replace(block(start, 3), data=np.empty((0, N_ELEMENTS), complex))
    estimator.assert_rejected(bad, start, "n_snapshots is 0: it was not filled in")


def test_changed_geometry(estimator: Estimator) -> None:
    start = estimator.new_run()
    good = block(start, 3)
    bad = replace(good, element_positions=1.1 * good.element_positions)
    estimator.assert_rejected(bad, start, "element_positions changed")


def test_fewer_elements_than_before(estimator: Estimator) -> None:
    start = estimator.new_run()
    estimator.assert_rejected(block(start, 3, elements=5), start, "element_positions changed")


def test_a_missing_block(estimator: Estimator) -> None:
    start = estimator.new_run()
    estimator.send(*(block(start, number) for number in (0, 1, 2, 4, 5, 6, 7)))
    estimator.probe.wait_sentence(INPUT, "0.100 s of data are missing", "check the source")
    estimator.assert_one_output_each(start + BLOCK, start + 7 * BLOCK)
    assert any(each.n_subspaces < 3 for each in estimator.outputs)


def test_a_duplicate(estimator: Estimator) -> None:
    start = estimator.new_run()
    estimator.send(*(block(start, number) for number in (0, 1, 1, 2, 3, 2, 4)))
    estimator.probe.wait_sentence(INPUT, "was ignored", "already received")
    estimator.assert_one_output_each(start + BLOCK, start + 4 * BLOCK)
    assert all(each.n_subspaces == 3 for each in estimator.outputs)


def test_a_stamp_a_little_back(estimator: Estimator) -> None:
    start = estimator.new_run()
    late = replace(block(start, 2), stamp=start + 4 * BLOCK // 3)
    estimator.send(*(block(start, number) for number in range(3)), late, block(start, 3))
    estimator.probe.wait_sentence(INPUT, "set aside", "0.067 s earlier", "in order")
    estimator.assert_one_output_each(start + BLOCK, start + 3 * BLOCK)
    assert all(each.n_subspaces == 3 for each in estimator.outputs)


def test_stamps_far_back_begin_again(estimator: Estimator) -> None:
    start = estimator.new_run()
    estimator.send(*(block(start, number) for number in range(4)))
    again = start - 500 * SECOND
    estimator.outputs.clear()
    estimator.send(*(block(again, number) for number in range(4)))
    estimator.probe.wait_sentence(INPUT, "went back by 500.300 s", "reset")
    estimator.assert_one_output_each(again + BLOCK, again + 3 * BLOCK)
    estimator.new_run()


def test_a_jump_ahead(estimator: Estimator) -> None:
    start = estimator.new_run()
    estimator.send(*(block(start, number) for number in (0, 1, 2, 3)))
    estimator.send(*(block(start, number) for number in range(8000, 8006)))
    estimator.probe.wait_sentence(INPUT, "799.600 s of data are missing")
    estimator.probe.wait(
        lambda: stamps(estimator.outputs)[-1] >= start + 8005 * BLOCK, "outputs after the jump"
    )
    assert len(estimator.outputs) < 50, "a long gap is not filled with empty estimates"
    assert estimator.outputs[-1].n_subspaces == 3


def test_a_dead_channel_is_named_and_the_others_are_used(estimator: Estimator) -> None:
    start = estimator.new_run()
    for number in range(6):
        dead = block(start, number)
        dead.data[:, 4] = 0.0
        estimator.send(dead)
    estimator.probe.wait_sentence(f"{NODE}: element 4", "Element 4 is silent", "check its cable")
    estimator.assert_one_output_each(start + BLOCK, start + 5 * BLOCK)
    assert all(each.n_subspaces == 3 for each in estimator.outputs)


def test_more_sources_than_elements(estimator: Estimator) -> None:
    start = estimator.new_run()
    estimator.send(*(block(start, number, elements=2) for number in range(3)))
    estimator.probe.wait_sentence(INPUT, "source_count is 2", "only 2 elements", "at most 1")
    start = estimator.new_run()
    estimator.send(*(block(start, number) for number in range(4)))
    estimator.assert_one_output_each(start + BLOCK, start + 3 * BLOCK)


def test_a_second_publisher_is_named_and_its_data_rejected(estimator: Estimator) -> None:
    start = estimator.new_run()
    estimator.send(*(block(start, number) for number in range(3)))
    intruder = Probe("intruder")
    try:
        second = intruder.publisher(SNAPSHOTS)
        intruder.wait(lambda: second.get_subscription_count() > 0, "intruder matched")
        estimator.let_clock_run(
            lambda: estimator.probe.matched(NODE)["/array/snapshots"] == "2", "the intruder matched"
        )
        foreign = replace(block(start, 3), sensor=Sensor("towed"))
        second.publish(array_writing.snapshots_to_message(foreign))
        estimator.sent += 1
        estimator.probe.wait_sentence(INPUT, "comes from sensor 'towed'", "'array'")
        estimator.let_clock_run(
            lambda: any(
                "2 publishers: /intruder, /probe" in text and "stop all but one" in text
                for text in estimator.probe.sentences(INPUT)
            ),
            "both publishers named",
        )
    finally:
        intruder.close()
    estimator.send(*(block(start, number) for number in range(3, 6)))
    estimator.assert_one_output_each(start + BLOCK, start + 5 * BLOCK)
    assert all(each.n_subspaces == 3 for each in estimator.outputs)


def test_a_stalled_input_is_named_while_the_clock_goes_on(estimator: Estimator) -> None:
    start = estimator.new_run()
    estimator.send(*(block(start, number) for number in range(3)))
    estimator.let_clock_run(
        lambda: any("nothing received for" in text for text in estimator.probe.sentences(INPUT)),
        "the stalled input",
    )
    estimator.probe.wait_sentence(INPUT, "check that its publisher is running")
    estimator.send(block(start, 3))
    estimator.assert_one_output_each(start + BLOCK, start + 3 * BLOCK)


def test_every_message_was_counted(estimator: Estimator) -> None:
    """Last: the ledger of the time master must balance, rejected messages included."""
    estimator.let_clock_run(
        lambda: estimator.probe.values(INPUT).get("finished") == str(estimator.sent),
        "numbers in the status",
    )
    assert estimator.probe.values(INPUT)["received"] == str(estimator.sent)
    announced = [p.count for p in estimator.probe.progress if p.topic == "/array/subspaces"]
    assert announced == sorted(set(announced))
    assert estimator.process.stop() == 0
    assert "Traceback" not in estimator.process.output
