"""The names operators gave to tracks in a recording."""

from __future__ import annotations

from sonar_tracking.bags.storage.bag_records import COMMANDS_TYPE, records_of, topics_of_type
from sonar_tracking.bags.storage.reader import Bag
from sonar_tracking.records.commands import CommandKind

_BELOW = "/operator/commands"


def operator_names(bag: Bag, rejected: list[str]) -> dict[tuple[str, int], str]:
    """Return the last name of each track that was given one, by its topic and identifier.

    Commands know a topic as in a graph without a namespace: theirs is that of their own topic.

    Parameters
    ----------
    bag : Bag
        The recording.
    rejected : list of str
        Takes a sentence for each command that does not hold what it says.
    """
    names = {}
    for topic in topics_of_type(bag, COMMANDS_TYPE):
        namespace = topic.removesuffix(_BELOW) if topic.endswith(_BELOW) else ""
        for command in records_of(bag, topic, rejected):
            if command.kind is CommandKind.RENAME_TRACK:
                track = f"{namespace}/{command.topic.lstrip('/')}"
                names[track, command.id] = command.name.strip()
    return names
