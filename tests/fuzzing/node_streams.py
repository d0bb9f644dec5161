"""Nodes in this process, and the good messages that they get in a scenario."""

from __future__ import annotations

import copy
import importlib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from itertools import count
from typing import Any

import rclpy
from rclpy.publisher import Publisher
from rclpy.serialization import deserialize_message

from sonar_tracking.graph.catalogue.node_catalogue import NODES
from sonar_tracking.graph.message_writing.field_writing import time_from_stamp
from sonar_tracking.graph.node_base.simulator_node import SimulatorNode
from sonar_tracking.graph.node_base.sonar_node import SonarNode
from sonar_tracking.message_reading.field_reading import stamp_from_time
from sonar_tracking.records.time import END_OF_DATA, UNKNOWN_STAMP, nanoseconds
from tests.fuzzing.chains import CHAINS

Message = tuple[str, Any]
"""Topic, with the message."""


@dataclass
class NodeInProcess:
    """A node whose outputs are kept instead of published."""

    node: SonarNode
    outputs: list[Message]

    def feed(self, topic: str, message: Any) -> None:
        """Give it a message, as its subscription would."""
        for source in self.node.data_inputs:
            if source.name == topic:
                self.node._receive(source, message)

    @property
    def commanded_topic(self) -> str | None:
        """The track list that operators may tell it something about."""
        topic = NODES[self.node.get_name()].commanded_topic
        return None if topic is None else topic.name

    def known_tracks(self) -> list[int]:
        """Return the tracks of its last list."""
        lists = [one.id for _, one in self.outputs if hasattr(one, "existence_probability")]
        return [int(number) for number in lists[-1]] if lists else []

    def command(self, message: Any) -> None:
        """Give it a command, as its subscription would."""
        self.node._commands._receive(message)

    def topics(self) -> set[str]:
        """Return what it subscribes to."""
        return {source.name for source in self.node.data_inputs}


def make_nodes(name: str) -> tuple[NodeInProcess, list[NodeInProcess]]:
    """Return a node of the catalogue with default parameters, and those in front of it."""
    scenario, in_front, _ = CHAINS[name]
    arguments = []
    for each in (*in_front, name):
        arguments += ["-p", f"{each}:use_sim_time:=true"]
        if NODES[each].section:
            arguments += ["-p", f"{each}:scenario:={scenario}"]
    rclpy.init(args=["--ros-args", *arguments])
    return _make_node(name), [_make_node(each) for each in in_front]


def _make_node(name: str) -> NodeInProcess:
    module = importlib.import_module(NODES[name].module)
    kinds: list[Any] = [
        value
        for value in vars(module).values()
        if isinstance(value, type)
        and issubclass(value, SonarNode)
        and value.__module__ == module.__name__
    ]
    (kind,) = kinds
    node: Any = kind()
    outputs: list[Message] = []
    for output in node.data_outputs:
        output.publish = partial(_keep, outputs, output.publisher)
    node.warm_up()
    return NodeInProcess(node, outputs)


def _keep(outputs: list[Message], publisher: Publisher, message: Any) -> None:
    if isinstance(message, bytes):
        message = deserialize_message(message, publisher.msg_type)
    outputs.append((publisher.topic_name, message))


def good_messages(
    node: NodeInProcess, in_front: list[NodeInProcess], length: float
) -> list[Message]:
    """Return what a node gets during the first seconds of the scenario, in order."""
    messages: list[Message] = []
    for each in in_front:
        if isinstance(each.node, SimulatorNode):
            each.node.serve(each.node._next.start_stamp + nanoseconds(length))
        for topic, message in list(messages):
            each.feed(topic, message)
        messages += each.outputs
    wanted = node.topics()
    found = [(topic, message) for topic, message in messages if topic in wanted]
    return sorted(found, key=lambda each: stamp_from_time(each[1].header.stamp))


def endless(messages: list[Message]) -> Iterator[Message]:
    """Return the messages again and again, later each time; the data never end."""
    ends: dict[str, list[int]] = {}
    for topic, message in messages:
        ends.setdefault(topic, []).append(stamp_from_time(message.header.stamp))
    begin = max(stamps[0] for stamps in ends.values())
    end = min(stamps[-1] for stamps in ends.values())
    within = [each for each in messages if begin <= stamp_from_time(each[1].header.stamp) < end]
    length = end - begin
    for turn in count():
        for topic, message in within:
            later = copy.copy(message)  # what is not changed here is not changed by anyone
            later.header = copy.deepcopy(message.header)
            later.header.stamp = time_from_stamp(
                stamp_from_time(message.header.stamp) + turn * length
            )
            if hasattr(message, "next_stamp"):
                due = stamp_from_time(message.next_stamp)
                if due not in (UNKNOWN_STAMP, END_OF_DATA):
                    later.next_stamp = time_from_stamp(due + turn * length)
                else:
                    later.next_stamp = time_from_stamp(UNKNOWN_STAMP)
            yield topic, later
