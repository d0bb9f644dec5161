"""Commands of operators from messages, wherever they come from."""

from __future__ import annotations

import math
from typing import Any

from sonar_tracking.errors import InputError, shown
from sonar_tracking.message_reading.field_limits import check_magnitude
from sonar_tracking.message_reading.field_reading import real, stamp_from_time, type_name, unfilled
from sonar_tracking.records.commands import (
    LINE_BANDWIDTH,
    CommandKind,
    OperatorCommand,
    OwnShipLine,
)
from sonar_tracking.records.positions import TrackHypothesis

LONGEST_NAME = 64
"""Characters of the name of a target, or of a sensor."""

_OF_A_TRACK = (
    CommandKind.END_TRACK,
    CommandKind.MERGE_TRACKS,
    CommandKind.CHOOSE_SIDE,
    CommandKind.RENAME_TRACK,
)
_OF_A_LINE = (CommandKind.MARK_OWN_SHIP_LINE, CommandKind.UNMARK_OWN_SHIP_LINE)


def command_from_message(message: Any) -> OperatorCommand:
    """Return the command a message carries.

    Parameters
    ----------
    message : OperatorCommand
        Received, or decoded from a bag.

    Raises
    ------
    InputError
        When it says not what is to be done, or not enough to do it.
    """
    number = int(message.command)
    if number == 0:
        raise unfilled(message, "command", "is 0")
    if number not in [int(kind) for kind in CommandKind]:
        known = ", ".join(f"{kind.name} = {kind.value}" for kind in CommandKind)
        raise InputError(f"{type_name(message)}.command is {number}; give one of {known}.")
    side = int(message.side)
    if side not in [int(one) for one in TrackHypothesis]:
        raise InputError(f"{type_name(message)}.side is {side}; give LEFT = 1 or RIGHT = 2.")
    for name in ("topic", "sensor_id", "name"):
        if len(getattr(message, name)) > 4 * LONGEST_NAME:
            raise InputError(f"{type_name(message)}.{name} is longer than {4 * LONGEST_NAME}.")
    command = OperatorCommand(
        kind=CommandKind(number),
        topic=str(message.topic),
        stamp=stamp_from_time(message.header.stamp),
        id=int(message.id),
        other_id=int(message.other_id),
        arrival_angle=real(message, "arrival_angle"),
        position=(real(message, "x"), real(message, "y")),
        side=TrackHypothesis(side),
        line=OwnShipLine(
            real(message, "frequency"),
            _bandwidth(message),
            str(message.sensor_id),
        ),
        name=str(message.name),
    )
    _check(message, command)
    return command


def _bandwidth(message: Any) -> float:
    width = real(message, "bandwidth")
    return LINE_BANDWIDTH if width == 0.0 or math.isnan(width) else width


def _check(message: Any, command: OperatorCommand) -> None:
    """Refuse a command without what it needs."""
    if not command.topic:
        raise unfilled(message, "topic", "is empty")
    kind = command.kind
    if kind in _OF_A_TRACK and not command.id:
        raise unfilled(message, "id", f"is 0 in {kind.name}")
    if kind is CommandKind.MERGE_TRACKS and command.other_id in (0, command.id):
        raise InputError(
            f"{type_name(message)}.other_id is {command.other_id} and id {command.id} in "
            f"{kind.name}; give two tracks of the list."
        )
    if kind is CommandKind.CHOOSE_SIDE and command.side is TrackHypothesis.SINGLE:
        raise unfilled(message, "side", f"is 0 in {kind.name}")
    if kind is CommandKind.RENAME_TRACK and not 0 < len(command.name.strip()) <= LONGEST_NAME:
        raise InputError(
            f"{type_name(message)}.name is '{shown(command.name)}' in {kind.name}; give a name of "
            f"at most {LONGEST_NAME} characters."
        )
    if kind is CommandKind.START_TRACK:
        place = (command.arrival_angle, *command.position)
        if not any(map(math.isfinite, place)):
            raise InputError(
                f"{type_name(message)} does not say where in {kind.name}: give arrival_angle, or "
                "x and y, as finite numbers."
            )
        for name, value in zip(("arrival_angle", "x", "y"), place, strict=True):
            if math.isinf(value):
                check_magnitude(type_name(message), name, abs(value))
    if kind in _OF_A_LINE and not _is_positive(command.line):
        raise InputError(
            f"{type_name(message)}.frequency is {command.line.frequency:g} Hz and bandwidth "
            f"{command.line.bandwidth:g} Hz in {kind.name}; give a frequency above 0, and a "
            "bandwidth above 0 or none."
        )


def _is_positive(line: OwnShipLine) -> bool:
    values = (line.frequency, line.bandwidth)
    return all(math.isfinite(value) and value > 0.0 for value in values)
