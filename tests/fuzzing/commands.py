"""Commands that operators might give a node at any time, sensible ones and others."""

from __future__ import annotations

from typing import Any

import numpy as np
from sonar_tracking_msgs.msg import OperatorCommand

from sonar_tracking.graph.chaos.message_mutation import mutated
from sonar_tracking.graph.message_writing.field_writing import time_from_stamp

SHARE = 0.2
"""Of the malformed messages that are accompanied by a command."""

ENDS = 0.05
"""Of the commands to end a track that name one: what has ended may not come back."""


def command(
    topic: str, stamp: int, known: list[int], generator: np.random.Generator
) -> OperatorCommand:
    """Return a command about a track list, one half of them malformed.

    Parameters
    ----------
    topic : str
        The list.
    stamp : int
        Of the newest data, ns.
    known : list of int
        Tracks of the list.
    generator : numpy.random.Generator
        Decides.
    """
    ids = [*known, 0, 1, 2**63]
    message: Any = OperatorCommand(
        command=int(generator.integers(0, 9)),
        topic=topic,
        id=ids[int(generator.integers(len(ids)))],
        other_id=ids[int(generator.integers(len(ids)))],
        arrival_angle=float(generator.uniform(-1.6, 1.6)),
        x=float(generator.uniform(-1e4, 1e4)),
        y=float(generator.uniform(-1e4, 1e4)),
        side=int(generator.integers(0, 3)),
        frequency=float(generator.uniform(10.0, 900.0)),
        bandwidth=float(generator.uniform(0.1, 50.0)),
        name="boat",
    )
    if message.command == OperatorCommand.END_TRACK and generator.random() > ENDS:
        message.id = 0
    offset = int(generator.integers(-(10**9), 3 * 10**9))
    message.header.stamp = time_from_stamp(max(stamp + offset, 0))
    return mutated(message, generator) if generator.random() < 0.5 else message
