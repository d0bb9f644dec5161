"""Whether the Fast DDS discovery servers that the environment names are there (no ROS import).

Without its server a node finds nobody, and says nothing. A server does not answer strangers, so
what can be told is that nobody listens: the name is unknown, the machine refuses, or it is silent
on its own link. A firewall that drops what it does not know looks like a server: that is told when
nodes have waited for each other in vain.
"""

from __future__ import annotations

import errno
import os
import re
import socket
import time
from collections.abc import Mapping
from pathlib import Path

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.catalogue.discovery_range import SERVER

DEFAULT_PORT = 11811
REFUSAL_SECONDS = 0.3
"""Time in which the system tells that a port is closed, s."""
NEIGHBOUR_SECONDS = 2.0
"""Time in which a machine of the own link answers, s."""

_ARP_TABLE = Path("/proc/net/arp")
_ENTRY = re.compile(
    r"((?P<transport>UDPv4|UDPv6|TCPv4|TCPv6):)?(\[(?P<bracketed>[^\]]+)\]|(?P<plain>[^:\[\]]+))"
    r"(:(?P<port>\d+))?"
)


def check_discovery_server(environment: Mapping[str, str] = os.environ) -> None:
    """Refuse to go on if none of the discovery servers is there.

    Raises
    ------
    ConfigurationError
        If ``ROS_DISCOVERY_SERVER`` cannot be read, or nobody listens at any of its addresses.
    """
    value = environment.get(SERVER, "")
    problems = {entry: server_problem(entry) for entry in _entries(value)}
    if problems and all(problems.values()):
        found = "; ".join(f"{entry}: {problem}" for entry, problem in problems.items())
        raise ConfigurationError(
            f"{SERVER} is {value!r}, but there is no server ({found}): start it "
            f"(fast-discovery-server), correct the address, or unset {SERVER}."
        )


def silence_in_words(environment: Mapping[str, str] = os.environ) -> str:
    """Return a sentence for nodes that do not find each other by way of a server, else nothing."""
    servers = ", ".join(_entries(environment.get(SERVER, "")))
    if not servers:
        return ""
    return (
        f" They ask the discovery server {servers} ({SERVER}): see whether it runs, and whether a "
        "firewall before it drops what they send."
    )


def server_problem(entry: str) -> str:
    """Return why there can be no server at an address, in a few words; empty = there may be one.

    Parameters
    ----------
    entry : str
        E.g. ``"192.168.1.5:11811"``, ``"TCPv4:[10.0.0.1]:5100"``; without a port, 11811.
    """
    match = _ENTRY.fullmatch(entry)
    port = int(match["port"] or DEFAULT_PORT) if match else 0
    if match is None or not 0 < port < 65536:
        return "not an address; write HOST:PORT"
    stream = (match["transport"] or "").startswith("TCP")
    kind = socket.SOCK_STREAM if stream else socket.SOCK_DGRAM
    host = match["bracketed"] or match["plain"]
    try:
        family, _, _, _, address = socket.getaddrinfo(host, port, type=kind)[0]
    except socket.gaierror:
        return "no such host"
    with socket.socket(family, kind) as probe:
        try:
            if stream:
                probe.settimeout(NEIGHBOUR_SECONDS)
                probe.connect(address)
            else:
                probe.connect(address)
                _await_refusal(probe, str(address[0]))
        except OSError as error:
            return error.strerror or "no answer"
    return ""


def _entries(value: str) -> list[str]:
    """Return the addresses; an empty place stands for a server identifier that is not used."""
    return [entry.strip() for entry in value.split(";") if entry.strip()]


def _await_refusal(probe: socket.socket, address: str) -> None:
    """Send an empty RTPS message; raise OSError if the system says that nobody can get it."""
    probe.send(b"RTPS\x02\x03\x01\x0f" + bytes(12))
    probe.settimeout(REFUSAL_SECONDS)
    deadline = time.monotonic() + NEIGHBOUR_SECONDS
    while True:
        try:
            probe.recv(1)
        except TimeoutError:
            if not _is_silent_neighbour(address):
                return
            if time.monotonic() > deadline:
                raise OSError(errno.EHOSTUNREACH, "no such machine on the network") from None
        else:
            return


def _is_silent_neighbour(address: str) -> bool:
    """Tell whether a machine of the own link has not said yet that it is there."""
    if not _ARP_TABLE.exists():
        return False
    rows = [line.split() for line in _ARP_TABLE.read_text().splitlines()[1:]]
    return any(row[0] == address and int(row[2], 16) == 0 for row in rows)
