"""Rewriting of a bag that is not whole, or that other tools cannot open."""

from __future__ import annotations

from pathlib import Path

from sonar_tracking.bags.contents.loss import MISSING_KEY, losses_to_json
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.bags.storage.writer import new_bag


def repair_bag(path: Path | str) -> Path:
    """Write what can be read of a bag into a whole one beside it.

    The original stays as it is; the new bag says what it lacked.

    Parameters
    ----------
    path : Path or str
        Directory or file to repair.

    Returns
    -------
    Path
        The new bag, ``<name>_repaired``; the same path where nothing is to be repaired.

    Raises
    ------
    ConfigurationError
        If nothing can be read, or the repaired bag exists already or cannot be written.
    """
    path = Path(path)
    bag = read_bag(path)
    if bag.recovery is None and bag.outdated is None:
        return path
    resolved = path.resolve()
    target = resolved.with_name(f"{resolved.stem}_repaired")
    missing = {MISSING_KEY: losses_to_json(bag.losses)} if bag.losses else {}
    with new_bag(target, bag.recording, {**bag.custom_data, **missing}) as writer:
        for topic in bag.topics.values():
            writer.add_topic(
                topic.name, topic.type_name, topic.definition, topic.role, topic.quality
            )
        for message in bag.messages():
            writer.write(message.topic, message.log_time, message.data)
    return target
