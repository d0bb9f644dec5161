"""Handles the events of a node one after the other, without a word in between.

``spin`` of the executor for events does not return on a shutdown, and ``spin_once`` does after each
event, which costs a quarter of what the executor takes. Spinning until a future is complete that
never will be does neither: it returns after a time, or as soon as it is told to.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rclpy.context import Context
from rclpy.experimental import EventsExecutor
from rclpy.node import Node


class EventLoop:
    """The events of a node.

    Parameters
    ----------
    node : Node
        Its events are handled.
    context : Context, optional
        Of the node; default: that of the process.
    """

    def __init__(self, node: Node, context: Context | None = None) -> None:
        self._executor: Any = EventsExecutor(context=context)
        self._executor.add_node(node)
        self._end = _End()

    def run_once(self, patience: float) -> None:
        """Handle one event, waiting for it at most so many seconds."""
        self._executor.spin_once(timeout_sec=patience)

    def run(self, seconds: float) -> None:
        """Handle all events for some time, s, or until one of them calls :meth:`stop`."""
        self._executor.spin_until_future_complete(self._end, timeout_sec=seconds)

    def stop(self) -> None:
        """Let :meth:`run` return after the present event."""
        self._end.come()

    def shutdown(self) -> None:
        """Handle no more events."""
        self._executor.shutdown()


class _End:
    """What the executor takes for a future; its completion may come any number of times."""

    def __init__(self) -> None:
        self._callbacks: list[Callable[[Any], None]] = []

    def add_done_callback(self, callback: Callable[[Any], None]) -> None:
        self._callbacks = [callback]

    def remove_done_callback(self, callback: Callable[[Any], None]) -> None:
        self._callbacks = []

    def done(self) -> bool:
        return False

    def come(self) -> None:
        for callback in self._callbacks:
            callback(self)
