"""Requests of operators become commands: stamped, let out, and the data held until all have them.

The stamp is one nanosecond after everything that has been let into the graph, so that no datum is
at it; no data at or after it go out until every tracker has the command. So the stamps alone say
between which data it takes effect, for all trackers, and in a replay of the recording. No ROS.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
from typing import Any, Protocol

from sonar_tracking.bags.contents.log_time import head_stamp
from sonar_tracking.errors import InputError
from sonar_tracking.graph.catalogue.command_kinds import check_command
from sonar_tracking.graph.catalogue.run_identity import CONTROL_NODE
from sonar_tracking.graph.orchestration.finished_stamps import FinishedStamps
from sonar_tracking.graph.orchestration.flow_ledger import FlowLedger
from sonar_tracking.graph.orchestration.stall_watch import LOST_SECONDS
from sonar_tracking.message_reading.command_reading import command_from_message
from sonar_tracking.records.commands import OperatorCommand
from sonar_tracking.records.time import UNKNOWN_STAMP

MOST_WAITING = 100
"""Requests that are kept until the clock moves next."""


class Outlet(Protocol):
    """Where commands go: the node of the orchestration, and who counts what it publishes."""

    finished: FinishedStamps
    notices: dict[str, str]

    def publish(self, topic: str, data: bytes) -> None:
        """Publish a serialised message."""
        ...


class CommandDesk:
    """The commands of one run.

    Parameters
    ----------
    topic : str
        Resolved name of the commands; empty = no node takes any.
    lists : mapping of str to str
        Resolved name of each track list that can be meant, to its name in the root namespace.
    consumers : collection of str
        Nodes that must have a command before the data go on.
    ledger : FlowLedger
        Told of every command; knows who has died.
    outlet : Outlet
        Publishes.
    published : callable
        Called with topic, bytes and wall time of every command.
    serialised : callable
        Returns the bytes of a command as a message.

    Attributes
    ----------
    given : int
        Commands made of requests so far.
    """

    def __init__(
        self,
        topic: str,
        lists: Mapping[str, str],
        consumers: Collection[str],
        ledger: FlowLedger,
        outlet: Outlet,
        published: Callable[[str, bytes, float], None],
        serialised: Callable[[OperatorCommand], bytes],
    ) -> None:
        self.topic = topic
        self.given = 0
        self._lists = lists
        self._consumers = consumers
        self._ledger = ledger
        self._outlet = outlet
        self._published = published
        self._serialised = serialised
        self._requests: deque[OperatorCommand] = deque()
        self._count = 0
        self._last = UNKNOWN_STAMP
        self._awaited: tuple[int, float] | None = None

    def take(self, message: Any) -> None:
        """Take a request; one that cannot be done is refused with a notice."""
        try:
            command = command_from_message(message)
            name = command.topic
            command = replace(command, topic=self._lists.get(name, name.lstrip("/")))
            if command.topic not in self._lists.values():
                there = ", ".join(self._lists.values()) or "none"
                raise InputError(f"nothing here tracks {name!r}; the track lists are {there}.")
            check_command(command)
            if len(self._requests) >= MOST_WAITING:
                raise InputError(f"{MOST_WAITING} others wait; send fewer.")
        except InputError as error:
            self._outlet.notices[f"{self.topic}: refused"] = f"a request was refused: {error}"
            return
        self._requests.append(command)

    def holds(self, reached: int | None, wall: float) -> bool:
        """Let out what was asked for, and return whether the data have to wait.

        Parameters
        ----------
        reached : int or None
            Last instant that any datum in the graph may have, ns; None = nothing has begun.
        wall : float
            Monotonic wall time, s.
        """
        if self._requests and reached is not None:
            for command in self._requests:
                stamp = max(reached, self._last) + 1
                self.let_out(self._serialised(replace(command, stamp=stamp)), wall)
            self.given += len(self._requests)
            self._requests.clear()
        return self._awaited is not None and not self._settled(self._awaited, wall)

    def let_out(self, data: bytes, wall: float) -> None:
        """Publish a command as bytes; the data wait from now on."""
        self._count += 1
        self._last = head_stamp(data)
        self._ledger.published(CONTROL_NODE, self.topic, self._count)
        self._outlet.publish(self.topic, data)
        self._published(self.topic, data, wall)
        self._awaited = (self._last, wall)

    def begin_again(self) -> None:
        """Forget the stamps of the commands so far: the data begin again earlier."""
        self._last = UNKNOWN_STAMP

    def _settled(self, awaited: tuple[int, float], wall: float) -> bool:
        """Return whether everybody who lives has the last command, or is not going to."""
        stamp, since = awaited
        alive = [name for name in self._consumers if name not in self._ledger.absent]
        reached = self._outlet.finished.everywhere([self.topic], {self.topic: alive})
        # Counts tell one pass of a loop from the next; stamps, what a node that was started again
        # has got of what is published to it again.
        behind = self._ledger.is_behind(self.topic) or reached is None or reached < stamp
        if alive and behind and wall - since < LOST_SECONDS:
            return False
        self._awaited = None
        return True
