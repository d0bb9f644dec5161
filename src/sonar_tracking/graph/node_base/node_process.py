"""Runs one node as a process of its own, until it is told to stop."""

from __future__ import annotations

import gc
import os
import signal
from collections.abc import Callable
from typing import Any, TypeVar

import rclpy
from rclpy.exceptions import ParameterException
from rclpy.executors import ExternalShutdownException
from rclpy.experimental import EventsExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.logging import get_logger
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.catalogue.transport_profile import node_environment
from sonar_tracking.graph.node_base.no_generators import do_without_generators
from sonar_tracking.stop_signals import STOP_SIGNALS, end_within, never_end

NodeType = TypeVar("NodeType", bound=Node)

PATIENCE = 0.2
"""Longest wait for an event before a stop request is noticed, s."""

LEAVING_SECONDS = 4.0
"""Longest time in which a node that has done its work leaves the graph, s."""


def run_node(
    make_node: Callable[[], NodeType], finish: Callable[[NodeType], None] | None = None
) -> int:
    """Spin a node until SIGINT, SIGTERM or a shutdown from outside; return the exit code.

    It is 1, after a sentence for each, if the parameters given to the node cannot be used. Unless
    the environment says otherwise, the node finds, and is found by, participants of this machine.

    What a node has to finish, it finishes in its own time; then it has to leave the graph within
    :data:`LEAVING_SECONDS`.

    The handlers only leave a note: however many signals arrive (a terminal sends one to every
    process, and the orchestration forwards its own), a callback is never torn apart.
    """
    os.environ.update(node_environment())
    do_without_generators()
    stop_requested = False

    def request_stop(_number: int, _frame: Any) -> None:
        nonlocal stop_requested
        stop_requested = True

    for number in STOP_SIGNALS:
        signal.signal(number, request_stop)
    node = None
    try:
        try:
            rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
        except (rclpy_implementation.RCLError, rclpy_implementation.UnknownROSArgsError) as error:
            raise ConfigurationError(f"ROS cannot read the arguments: {error}") from error
        node = make_node()
        # spin() of this executor does not return on a shutdown, nor does Python hear of a signal
        # before it returns; spin_once() does both, and costs little: it handled 82,000 messages a
        # second where the standard executor handled 8,000.
        executor = EventsExecutor()
        executor.add_node(node)
        # What was loaded stays: collections of garbage need not look at it again and again.
        gc.freeze()
        while rclpy.ok() and not stop_requested:
            executor.spin_once(timeout_sec=PATIENCE)
        executor.shutdown()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    except (ConfigurationError, ParameterException) as error:
        get_logger("sonar_tracking").fatal(f"{error}")
        return 1
    finally:
        if node is not None and finish is not None:
            finish(node)
        # The middleware has been seen to wait for itself when a participant left while another one
        # was discovered. The node has done its work by now.
        end_within(LEAVING_SECONDS)
        if node is not None:
            node.destroy_node()
        rclpy.try_shutdown()
        never_end()
    return 0
