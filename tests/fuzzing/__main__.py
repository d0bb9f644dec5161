"""Feeds a node malformed messages: ``python -m tests.fuzzing NODE [--count N] [--seed S]``.

After each of them the third good message of its topic must be used and answered, whatever it was;
no message may end the node, take more than a second or fill the memory. What is found is printed
with the seed and number that repeat it; the exit code is 1 then.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from rclpy.logging import LoggingSeverity

from sonar_tracking.errors import Severity
from sonar_tracking.graph.chaos.message_mutation import mutated
from sonar_tracking.graph.node_base.stamp_check import seconds_text
from sonar_tracking.message_reading.field_reading import stamp_from_time
from tests.fuzzing import commands
from tests.fuzzing.chains import CHAINS
from tests.fuzzing.node_streams import (
    endless,
    good_messages,
    make_nodes,
)
from tests.fuzzing.sound_outputs import is_sound

LONGEST = 1.0
"""That a message may take, s of processor time."""

MOST_MEMORY = 500.0
"""MB."""

GOOD = 3
"""Good messages until all is well again."""


SILENT = {"/own_ship/odometry", "/passive/frequency_lines"}
"""Topics whose messages alone are not answered."""

COLLECTED = {"/array/snapshots": 10, "/array/samples": 60}
"""More messages of a topic until there must be an answer."""


class Fuzzer:
    """One node, its stream of good messages, and what was found."""

    def __init__(self, name: str, seed: int) -> None:
        self.node, in_front = make_nodes(name)
        messages = good_messages(self.node, in_front, CHAINS[name].length)
        self._stream = endless(messages)
        self._seed = seed
        self.found: Counter[str] = Counter()
        self.examples: dict[str, str] = {}
        self.slowest = 0.0
        self.number = 0
        self._unexpected = ""
        self._refused = False
        self._was_reset = False
        self._latest = 0
        self.node.node.get_logger().set_level(LoggingSeverity.FATAL)
        self.node.node.report = self._report  # type: ignore[method-assign]
        self.node.node.diagnostics.report = self._report  # type: ignore[method-assign]
        for topic, message in (next(self._stream) for _ in range(min(len(messages), 60))):
            self._feed(topic, message, "good")

    def step(self) -> None:
        """Feed one malformed message, and the good ones that follow it."""
        self.number += 1
        generator = np.random.default_rng([self._seed, self.number])
        topic, message = next(self._stream)
        bad = mutated(message, generator)
        inserted = generator.random() < 0.5
        self._command(topic)
        self._feed(topic, bad, "malformed", bad)
        if inserted:
            self._feed(topic, message, "good", bad)
        self._recover(topic, bad, GOOD - inserted)

    def _recover(self, topic: str, bad: Any, wanted: int) -> None:
        (source,) = (each for each in self.node.node.data_inputs if each.name == topic)
        self.node.outputs.clear()
        self._was_reset = False
        while wanted:
            name, good = next(self._stream)
            self._refused = False
            self._feed(name, good, "good", bad)
            wanted -= name == topic
        if self._refused:
            self._note("the third good message was refused", topic, bad)
        if source.guard.last_stamp != source.read_stamp(good):
            self._note("the third good message was set aside", topic, bad)
        if not self._answers(topic):
            self._note("no output within three good messages", topic, bad)

    def _answers(self, topic: str) -> bool:
        """Tell whether there is an output, soon: samples are collected for some blocks first.

        So they are after a reset by any topic: a list that ends the data, some seconds ahead of
        the rest, is well formed, and what follows it begins anew.
        """
        if topic in SILENT:
            return True
        collected = (each.name for each in self.node.node.data_inputs if self._was_reset)
        for _ in range(max(COLLECTED.get(name, 0) for name in (topic, *collected))):
            if self.node.outputs:
                break
            self._feed(*next(self._stream), "good")
        return any(is_sound(message) for _, message in self.node.outputs)

    def _feed(self, topic: str, message: Any, what: str, bad: Any = None) -> None:
        begin = time.process_time()
        self._unexpected = ""
        self._latest = stamp_from_time(message.header.stamp)
        try:
            self.node.feed(topic, message)
        except Exception as error:
            self._note(f"a {what} message ends the node: {type(error).__name__}", topic, bad)
        if self._unexpected:
            self._note(f"unexpected ({what}): {self._unexpected}", topic, bad)
        taken = time.process_time() - begin
        self.slowest = max(self.slowest, taken)
        if taken > LONGEST:
            self._note(f"a {what} message takes too long", topic, bad)

    def _command(self, topic: str) -> None:
        """Give the node a command now and then, sensible or not."""
        generator = np.random.default_rng([self._seed, self.number, 1])
        given = self.node.commanded_topic
        if given is None or generator.random() >= commands.SHARE:
            return
        made = commands.command(given, self._latest, self.node.known_tracks(), generator)
        try:
            self.node.command(made)
        except Exception as error:
            self._note(f"a command ends the node: {type(error).__name__}", topic, made)

    def _report(
        self,
        concern: str,
        culprit: str,
        severity: Severity,
        sentence: str,
        lasting: bool = False,
    ) -> None:
        self._was_reset |= "everything was reset" in sentence
        self._refused |= f"at {seconds_text(self._latest)}: rejected" in sentence
        if "please report" in sentence:
            self._unexpected = sentence.partition("unexpected ")[2][:150]

    def _note(self, what: str, topic: str, bad: Any) -> None:
        kind = f"{topic}: {what}"
        self.found[kind] += 1
        text = str(bad)
        self.examples.setdefault(kind, f"seed {self._seed}, number {self.number}: {text[:1500]}")


def peak_memory() -> float:
    """Return the most memory this process has had, MB; what its parent had does not count."""
    status = Path("/proc/self/status").read_text()
    (line,) = (each for each in status.splitlines() if each.startswith("VmHWM:"))
    return float(line.split()[1]) / 1024.0


def main() -> int:
    """Run the fuzzer and print what was found."""
    parser = argparse.ArgumentParser(prog="python -m tests.fuzzing", description=__doc__)
    parser.add_argument("node", choices=CHAINS)
    parser.add_argument("--count", type=int, default=1000, help="malformed messages")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--examples", action="store_true", help="print the first of each kind")
    given = parser.parse_args()
    fuzzer = Fuzzer(given.node, given.seed)
    begin = time.monotonic()
    for _ in range(given.count):
        fuzzer.step()
    memory = peak_memory()
    if memory > MOST_MEMORY:
        fuzzer.found["memory"] += 1
    summary = {
        "node": given.node,
        "seed": given.seed,
        "malformed": given.count,
        "found": dict(fuzzer.found.most_common()),
        "slowest_s": round(fuzzer.slowest, 3),
        "memory_mb": round(memory),
        "seconds": round(time.monotonic() - begin, 1),
    }
    print(json.dumps(summary, indent=1))
    if given.examples:
        for kind, example in fuzzer.examples.items():
            print(f"\n== {kind}\n{example}")
    return 1 if fuzzer.found else 0


if __name__ == "__main__":
    sys.exit(main())
