"""What operators may tell the trackers, by the track list that is meant (no ROS import)."""

from __future__ import annotations

from collections.abc import Mapping

from sonar_tracking.errors import InputError, shown
from sonar_tracking.graph.catalogue.topics import (
    ACTIVE_TRACKS,
    BEARING_TRACKS,
    FUSED_TRACKS,
    PASSIVE_TRACKS,
)
from sonar_tracking.records.commands import CommandKind, OperatorCommand

COMMAND_KINDS: Mapping[str, tuple[CommandKind, ...]] = {
    BEARING_TRACKS.name: (
        CommandKind.START_TRACK,
        CommandKind.END_TRACK,
        CommandKind.MERGE_TRACKS,
        CommandKind.RENAME_TRACK,
    ),
    ACTIVE_TRACKS.name: (
        CommandKind.START_TRACK,
        CommandKind.END_TRACK,
        CommandKind.MERGE_TRACKS,
        CommandKind.RENAME_TRACK,
    ),
    PASSIVE_TRACKS.name: (
        CommandKind.END_TRACK,
        CommandKind.CHOOSE_SIDE,
        CommandKind.MARK_OWN_SHIP_LINE,
        CommandKind.UNMARK_OWN_SHIP_LINE,
        CommandKind.RENAME_TRACK,
    ),
    FUSED_TRACKS.name: (
        CommandKind.END_TRACK,
        CommandKind.MERGE_TRACKS,
        CommandKind.RENAME_TRACK,
    ),
}
"""Track list, as in a graph without a namespace, to the commands about it."""


def check_command(command: OperatorCommand) -> None:
    """Refuse a command that is none of its track list.

    Parameters
    ----------
    command : OperatorCommand
        About one of :data:`COMMAND_KINDS`.

    Raises
    ------
    InputError
        Naming those there are.
    """
    kinds = _kinds_of(command.topic)
    if kinds is None:
        raise InputError(
            f"no tracker takes commands about '{shown(command.topic)}'; there are "
            f"{', '.join(COMMAND_KINDS)}."
        )
    if command.kind not in kinds:
        raise InputError(
            f"{command.kind.name} cannot be done to {command.topic}; there are "
            f"{', '.join(kind.name for kind in kinds)}."
        )


def _kinds_of(topic: str) -> tuple[CommandKind, ...] | None:
    """Return the commands about a track list, which may be that of a station; None = of none."""
    ends = [name for name in COMMAND_KINDS if topic == name or topic.endswith(f"/{name}")]
    return COMMAND_KINDS[max(ends, key=len)] if ends else None
