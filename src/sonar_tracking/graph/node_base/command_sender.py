"""Where operators' commands go from whoever shows the tracks: to a run, or to the trackers."""

from __future__ import annotations

from dataclasses import replace

from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.publisher import Publisher

from sonar_tracking.errors import InputError
from sonar_tracking.graph.catalogue.run_identity import own_identity
from sonar_tracking.graph.catalogue.topics import COMMANDS, REQUESTS, Topic
from sonar_tracking.graph.message_writing.command_writing import command_to_message
from sonar_tracking.graph.message_writing.field_writing import message_class
from sonar_tracking.graph.node_base import quality_of_service
from sonar_tracking.records.commands import OperatorCommand
from sonar_tracking.records.time import UNKNOWN_STAMP, nanoseconds

DISCOVERY = nanoseconds(5.0)
"""So long after its start a node may not know yet who else is there, ns of steady time."""

LEAD = nanoseconds(1.0)
"""Of a command before data that no run paces: all trackers have it by then, ns."""


class CommandSender:
    """Sends commands in the name of a node.

    A run moves its clock, and gives a command the stamp at which it takes effect. Where none does,
    as with hardware, the sender gives it one that is a little later than the newest data.

    Parameters
    ----------
    node : Node
        Who sends.
    """

    def __init__(self, node: Node) -> None:
        self._node = node
        self._requests = self._publisher(REQUESTS)
        self._commands: Publisher | None = None
        self._steady = Clock(clock_type=ClockType.STEADY_TIME)
        self._begin = self._steady.now().nanoseconds

    def send(self, command: OperatorCommand, newest: int = UNKNOWN_STAMP) -> None:
        """Send a command.

        Parameters
        ----------
        command : OperatorCommand
            What is to be done; its stamp is not used.
        newest : int
            Stamp of the newest data known here, ns; 0 = none, and where no run goes on the command
            takes effect before the next datum of each tracker.

        Raises
        ------
        InputError
            If it is too early to tell whether a run goes on; nothing is sent then.
        """
        if self._commands is None and self._is_alone():
            # Only now: a second publisher would keep a run from starting.
            self._commands = self._publisher(COMMANDS)
        if self._commands is None:
            message = command_to_message(replace(command, stamp=UNKNOWN_STAMP))
            self._requests.publish(message)
            return
        stamp = newest + LEAD if newest != UNKNOWN_STAMP else UNKNOWN_STAMP
        self._commands.publish(command_to_message(replace(command, stamp=stamp)))

    def _is_alone(self) -> bool:
        """Return whether no run gives commands their stamps."""
        if own_identity() or self._node.count_publishers(COMMANDS.name):
            return False
        if self._steady.now().nanoseconds - self._begin < DISCOVERY:
            raise InputError("it is not known yet who moves the clock; repeat it in some seconds.")
        return True

    def _publisher(self, topic: Topic) -> Publisher:
        return self._node.create_publisher(
            message_class(topic.message_type),
            topic.name,
            quality_of_service.publisher_profile(topic.kind),
        )
