"""The loop handles all events for as long as it is told to, and ends when it is told to."""

from __future__ import annotations

import time
from collections.abc import Iterator

import pytest
import rclpy
from rclpy.context import Context
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from sonar_tracking.graph.node_base.event_loop import EventLoop

NEVER = 60.0


@pytest.fixture
def node() -> Iterator[Node]:
    context = Context()
    rclpy.init(context=context, signal_handler_options=SignalHandlerOptions.NO)
    node = Node("looped", context=context)
    yield node
    node.destroy_node()
    rclpy.shutdown(context=context)


def test_it_handles_events_until_it_is_told_to_stop(node: Node) -> None:
    loop = EventLoop(node, node.context)
    handled = []

    def handle() -> None:
        handled.append(time.monotonic())
        if len(handled) % 3 == 0:
            loop.stop()

    timer = node.create_timer(0.001, handle)
    begun = time.monotonic()
    loop.run(NEVER)
    assert len(handled) == 3
    loop.run(NEVER)
    assert len(handled) == 6 and time.monotonic() - begun < NEVER
    timer.cancel()
    loop.stop()  # while it does not run, this is no word for the next time
    loop.run(0.01)
    assert len(handled) == 6
    loop.shutdown()
