"""How far the processes of a graph look for each other: this machine, unless the environment says.

A ROS 2 graph is open to whoever finds it, and by default everybody on the subnet does. What this
package starts stays on its machine instead, until one of the variables of :data:`CHOICES` asks for
more. ``LOCALHOST`` alone only means that nobody is looked for elsewhere: a machine that names this
one in its own ``ROS_STATIC_PEERS`` would still be let in. Where no other machine is asked for, the
sockets are therefore bound to the loopback interface, by the profiles in ``config/fastdds/local``.
"""

from __future__ import annotations

import os
from collections.abc import Mapping

RANGE = "ROS_AUTOMATIC_DISCOVERY_RANGE"
PEERS = "ROS_STATIC_PEERS"
SERVER = "ROS_DISCOVERY_SERVER"
LOCALHOST_ONLY = "ROS_LOCALHOST_ONLY"
LOCALHOST = "LOCALHOST"

CHOICES = (RANGE, SERVER, LOCALHOST_ONLY)
"""Variables with which a person chooses the range; none is overruled."""


def default_range(environment: Mapping[str, str] = os.environ) -> dict[str, str]:
    """Return the variables that keep a graph on its machine; none if its user has chosen.

    Static peers are reached in addition to this machine, so they go together with the default.
    """
    return {} if any(environment.get(name) for name in CHOICES) else {RANGE: LOCALHOST}


def is_confined(environment: Mapping[str, str] = os.environ) -> bool:
    """Tell whether no participant of another machine is asked for, defaults included."""
    if environment.get(PEERS) or environment.get(SERVER):
        return False
    asked = {**environment, **default_range(environment)}
    return asked.get(RANGE) == LOCALHOST or asked.get(LOCALHOST_ONLY) == "1"


def range_in_words(environment: Mapping[str, str] = os.environ) -> str:
    """Return one line that says who can find the graph."""
    asked = {**environment, **default_range(environment)}
    if asked.get(SERVER):
        return f"discovery: whoever asks the server {asked[SERVER]} ({SERVER})"
    if asked.get(LOCALHOST_ONLY) == "1" or asked.get(RANGE) == LOCALHOST:
        if asked.get(PEERS):
            return f"discovery: this machine and {asked[PEERS]} ({PEERS})"
        return f"discovery: this machine only ({RANGE} opens it)"
    chosen = asked.get(RANGE) or "SUBNET"
    return f"discovery: {chosen} ({RANGE}): other machines can publish to this graph"
