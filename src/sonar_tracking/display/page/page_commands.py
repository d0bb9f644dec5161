"""Commands of operators, between the page and the records: what was asked, and what was done."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from sonar_tracking.display.page.page_frames import Frame, seconds_of, text_frame
from sonar_tracking.errors import InputError, shown
from sonar_tracking.message_reading.command_reading import command_from_message
from sonar_tracking.records.commands import CommandKind
from sonar_tracking.records.commands import OperatorCommand as CommandRecord

_NUMBERS = ("arrival_angle", "x", "y", "frequency", "bandwidth")
_COUNTS = ("id", "other_id", "side")
_TEXTS = ("topic", "sensor_id", "name")
_KINDS = {kind.name.lower(): kind for kind in CommandKind}


@dataclass
class _Time:
    sec: int = 0
    nanosec: int = 0


@dataclass
class _Header:
    stamp: _Time = field(default_factory=_Time)


@dataclass
class OperatorCommand:
    """What a page asks, with the fields of the message; unknown numbers are NaN.

    Attributes
    ----------
    command, id, other_id, side : int
        As in the message.
    topic, sensor_id, name : str
        As in the message.
    arrival_angle, x, y, frequency, bandwidth : float
        rad, m, m, Hz, Hz.
    header : object
        Without a stamp: it takes effect before the next datum.
    """

    command: int = 0
    topic: str = ""
    id: int = 0
    other_id: int = 0
    arrival_angle: float = math.nan
    x: float = math.nan
    y: float = math.nan
    side: int = 0
    frequency: float = math.nan
    bandwidth: float = math.nan
    sensor_id: str = ""
    name: str = ""
    header: _Header = field(default_factory=_Header)


def command_from_page(fields: Mapping[str, Any]) -> CommandRecord:
    """Return the command that a page has sent.

    Parameters
    ----------
    fields : mapping
        ``command``, a name of :class:`~sonar_tracking.records.commands.CommandKind` in small
        letters, and fields of the message ``OperatorCommand``.

    Raises
    ------
    InputError
        If it is none, or does not say enough.
    """
    kind = _KINDS.get(str(fields.get("command")))
    if kind is None:
        asked = shown(str(fields.get("command")))
        raise InputError(f"there is no command '{asked}'; there are {', '.join(_KINDS)}.")
    asked_for = OperatorCommand(command=int(kind))
    for name in (*_NUMBERS, *_COUNTS, *_TEXTS):
        value = fields.get(name)
        if value is not None:
            setattr(asked_for, name, _checked(name, value))
    return command_from_message(asked_for)


def _checked(name: str, value: Any) -> Any:
    if name in _TEXTS and isinstance(value, str):
        return value
    if name not in _TEXTS and isinstance(value, int | float) and not isinstance(value, bool):
        if name in _NUMBERS:
            return float(value)
        if 0 <= value < 1 << 63 and value == int(value):
            return int(value)
    raise InputError(f"{name} of a command cannot be {shown(repr(value))}.")


def command_frame(command: CommandRecord) -> Frame:
    """Return the frame of a command that takes effect."""
    return text_frame(
        "command",
        seconds_of(command.stamp),
        command=command.kind.name.lower(),
        topic=command.topic,
        id=command.id,
        other_id=command.other_id,
        arrival_angle=command.arrival_angle,
        x=command.position[0],
        y=command.position[1],
        side=int(command.side),
        frequency=command.line.frequency,
        bandwidth=command.line.bandwidth,
        sensor=command.line.sensor_id,
        name=command.name,
    )
