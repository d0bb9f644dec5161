"""What operators tell a tracker: received at any time, carried out in event time."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

from rclpy.node import Node

from sonar_tracking.errors import InputError, Notice, Severity
from sonar_tracking.graph.catalogue.command_kinds import check_command
from sonar_tracking.graph.catalogue.topics import COMMANDS, Topic
from sonar_tracking.graph.message_writing.field_writing import message_class
from sonar_tracking.graph.node_base import quality_of_service
from sonar_tracking.graph.node_base.diagnostics import UNEXPECTED, Diagnostics
from sonar_tracking.graph.node_base.pending_commands import PendingCommands
from sonar_tracking.graph.node_base.progress_reporter import ProgressReporter
from sonar_tracking.graph.node_base.stamp_check import seconds_text
from sonar_tracking.message_reading.command_reading import command_from_message
from sonar_tracking.message_reading.field_reading import stamp_from_time
from sonar_tracking.records.commands import CommandKind, OperatorCommand
from sonar_tracking.records.time import UNKNOWN_STAMP

OPERATOR = "operator commands"
"""Concern: commands that could not be carried out, or not at their time."""

CarryOut = Callable[[OperatorCommand], Iterable[Notice]]


class CommandInput:
    """Subscription of one tracker to the commands of operators.

    Parameters
    ----------
    node : Node
        The node.
    topic : Topic or None
        Its track list: commands about others are for other nodes; None = it takes none at all.
    progress : ProgressReporter
        Told of every command at once, since the clock waits for it.
    diagnostics : Diagnostics
        Told of what cannot be done.
    carry_out : callable
        Does what a command says; raises InputError if that cannot be done.
    """

    def __init__(
        self,
        node: Node,
        topic: Topic | None,
        progress: ProgressReporter,
        diagnostics: Diagnostics,
        carry_out: CarryOut,
    ) -> None:
        self._progress = progress
        self._diagnostics = diagnostics
        self._carry_out = carry_out
        self._pending = PendingCommands()
        self._received = self._done = self._refused = 0
        self._name = node.resolve_topic_name(COMMANDS.name)
        if topic is None:
            return
        self._topic = topic.name
        self._names = {topic.name, node.resolve_topic_name(topic.name)}
        diagnostics.add(OPERATOR, self._values)
        node.create_subscription(
            message_class(COMMANDS.message_type),
            COMMANDS.name,
            self._receive,
            quality_of_service.ALL_COMMANDS,
        )

    def carry_out_due(self, stamp: int, taken_up: int = UNKNOWN_STAMP) -> None:
        """Carry out what is to be done before a datum.

        Parameters
        ----------
        stamp : int
            Of the datum, ns.
        taken_up : int
            Up to when the state just taken up from another process holds everything, ns; 0 = none.
        """
        if taken_up != UNKNOWN_STAMP:
            self._pending.continue_from(taken_up)
        for command, late in self._pending.due(stamp):
            self._do(command)
            if late:
                since = f"stamped {seconds_text(command.stamp)}" if command.stamp else "unstamped"
                sentence = (
                    f"{command.kind.name}, {since}, takes effect only now, before the data at "
                    f"{seconds_text(stamp)}; a replay of a recording may differ there. Give it a "
                    "later stamp, or let a run give it one."
                )
                self._diagnostics.report(
                    OPERATOR, f"late {self._received}", Severity.WARN, sentence
                )

    def begin_again(self) -> None:
        """Forget what was for data that begin again earlier."""
        self._pending.begin_again()

    def _values(self) -> dict[str, object]:
        """Return the numbers of the status of the commands."""
        return {"received": self._received, "carried_out": self._done, "refused": self._refused}

    def _receive(self, message: Any) -> None:
        self._received += 1
        stamp = stamp_from_time(message.header.stamp)
        if message.topic in self._names:
            self._take(message, stamp)
        self._progress.report(self._name, self._received, stamp)

    def _take(self, message: Any, stamp: int) -> None:
        try:
            command = replace(command_from_message(message), topic=self._topic)
            check_command(command)
        except Exception as error:
            self._refuse(f"a command at {seconds_text(stamp)} was rejected: {error}")
            return
        if command.kind is not CommandKind.RENAME_TRACK:
            self._pending.add(command)

    def _do(self, command: OperatorCommand) -> None:
        try:
            for notice in self._carry_out(command):
                self._diagnostics.report(OPERATOR, notice.culprit, notice.severity, notice.text)
            self._done += 1
        except InputError as error:
            self._refuse(f"{command.kind.name} could not be done: {error}")
        except Exception as error:
            sentence = (
                f"{command.kind.name} could not be done: an unexpected {type(error).__name__}: "
                f"{error}; please report it with the recording."
            )
            self._diagnostics.report(UNEXPECTED, sentence, Severity.ERROR, sentence)

    def _refuse(self, sentence: str) -> None:
        self._refused += 1
        self._diagnostics.report(OPERATOR, f"refused {self._refused}", Severity.WARN, sentence)
