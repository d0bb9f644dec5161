"""Discovery, and transport of large messages, chosen per process.

A Fast DDS publisher hands a message to its receivers on the same machine through a shared memory
segment of its own. The segment of the default profile holds half a megabyte; anything larger is
cut into fragments, which costs five times the latency and, best effort, most of the messages. The
shipped profile gives a publisher of large messages a segment of 128 MB. Receivers need none.

By default a participant that has been there for half a second tells of itself every 3 s only, and
one that comes later may wait as long before it is known. The shipped profiles make that half a
second, and a tenth of a second in the first ten. A profile of the user's own goes before the one
for discovery. Of each profile there is one in ``config/fastdds/local`` for a graph that stays on
its machine (:mod:`sonar_tracking.graph.catalogue.discovery_range`). Those for several machines also
make good what a network loses: see ``quick_discovery.xml``.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from sonar_tracking.graph.catalogue.discovery_range import default_range, is_confined
from sonar_tracking.resources import find_resource

LARGE_MESSAGE_BYTES = 200_000
SEGMENT_BYTES = 128 * 2**20
LARGEST_MESSAGE_BYTES = 32 * 2**20
SHARED_MEMORY = Path("/dev/shm")

_PROFILES = "FASTRTPS_DEFAULT_PROFILES_FILE"
_PROFILES_OF_USER = (_PROFILES, "FASTDDS_DEFAULT_PROFILES_FILE")


@dataclass(frozen=True)
class TransportChoice:
    """Environment variables that select the transport.

    Attributes
    ----------
    large_publishers : mapping of str to str
        For the processes that publish array data.
    others : mapping of str to str
        For all other processes.
    warning : str
        One sentence if the transport is slower than it could be, else empty.
    """

    large_publishers: Mapping[str, str] = field(default_factory=dict)
    others: Mapping[str, str] = field(default_factory=dict)
    warning: str = ""


def choose_transport(
    largest_message_bytes: int, n_publishers: int, shared_memory: Path = SHARED_MEMORY
) -> TransportChoice:
    """Choose the transport by the size of the largest message and the free shared memory.

    Parameters
    ----------
    largest_message_bytes : int
        Size of the largest message of the graph.
    n_publishers : int
        Processes that publish messages of that kind.
    shared_memory : Path
        Where the system keeps shared memory segments.
    """
    discovery = node_environment()
    if largest_message_bytes < LARGE_MESSAGE_BYTES:
        return TransportChoice(discovery, discovery)
    warning = ""
    if largest_message_bytes > LARGEST_MESSAGE_BYTES:
        warning = (
            f"the largest message has {largest_message_bytes / 2**20:.0f} MB, more than the "
            f"{LARGEST_MESSAGE_BYTES / 2**20:.0f} MB that pass through shared memory at once: "
            "make the blocks shorter (array.block_snapshots)."
        )
    needed = n_publishers * SEGMENT_BYTES
    free = shutil.disk_usage(shared_memory).free if shared_memory.is_dir() else 0
    if free < needed:
        udp = _without_shared_memory(discovery)
        warning = (
            f"{shared_memory} has {free / 2**20:.0f} MB free and messages of "
            f"{largest_message_bytes / 2**20:.1f} MB want {needed / 2**20:.0f} MB: using UDP, "
            "which is slower; enlarge it (in Docker: --shm-size=512m)."
        )
        return TransportChoice(udp, udp, warning)
    large = {**discovery, _PROFILES: _shipped("large_messages")}
    return TransportChoice(large, discovery, warning)


def node_environment() -> dict[str, str]:
    """Return what the environment of a node lacks: the range of discovery, and its profile."""
    if any(name in os.environ for name in _PROFILES_OF_USER):
        return default_range()
    return {**default_range(), _PROFILES: _shipped("quick_discovery")}


def _without_shared_memory(discovery: Mapping[str, str]) -> dict[str, str]:
    if _PROFILES in discovery:
        return {**discovery, _PROFILES: _shipped("without_shared_memory")}
    return {"FASTDDS_BUILTIN_TRANSPORTS": "UDPv4", **discovery}


def _shipped(name: str) -> str:
    folder = "config/fastdds/local" if is_confined() else "config/fastdds"
    return str(find_resource(f"{folder}/{name}.xml"))
