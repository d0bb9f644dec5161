"""Commands that a tracker has received and not carried out: in event time. Pure stamps, no ROS.

A command takes effect before the first datum at or after its stamp. Whoever moves the clock lets
such data go only when every tracker has the command, so that the stamps alone decide, in a replay
as in the run. Without one, a command may come after such a datum: it takes effect before the next.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from sonar_tracking.records.commands import OperatorCommand
from sonar_tracking.records.time import UNKNOWN_STAMP


class DueCommand(NamedTuple):
    """A command whose turn it is.

    Attributes
    ----------
    command : OperatorCommand
        What is to be done.
    late : bool
        Whether data at or after its stamp were processed without it.
    """

    command: OperatorCommand
    late: bool


class PendingCommands:
    """Commands in the order of their stamps; of one stamp, in the order they came."""

    def __init__(self) -> None:
        self._waiting: list[OperatorCommand] = []
        self._done = UNKNOWN_STAMP

    def add(self, command: OperatorCommand) -> None:
        """Take a command that was received."""
        self._waiting.append(command)

    def due(self, stamp: int) -> Iterator[DueCommand]:
        """Return what is to be done before a datum at a stamp, ns: those without a stamp last."""
        if not self._waiting:
            self._done = stamp
            return
        due = [one for one in self._waiting if one.stamp <= stamp]
        self._waiting = [one for one in self._waiting if one.stamp > stamp]
        done, self._done = self._done, stamp
        for command in sorted(due, key=lambda one: one.stamp or stamp):
            yield DueCommand(command, command.stamp <= done)

    def continue_from(self, stamp: int) -> None:
        """Go on with a state in which everything up to a stamp, ns, has been done."""
        self._waiting = [
            one for one in self._waiting if one.stamp > stamp or one.stamp == UNKNOWN_STAMP
        ]
        self._done = stamp

    def begin_again(self) -> None:
        """Forget what was for data that begin again earlier."""
        self._waiting = [one for one in self._waiting if one.stamp <= self._done]
        self._done = UNKNOWN_STAMP
