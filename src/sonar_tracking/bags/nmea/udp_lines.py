"""Lines of sentences as they come in datagrams (UDP)."""

from __future__ import annotations

import re
import socket
import struct
from collections import OrderedDict
from ipaddress import ip_address

from sonar_tracking.bags.nmea.sentences import lines_of
from sonar_tracking.errors import ConfigurationError

MOST_AT_ONCE = 1000
"""Datagrams that are read before others have a turn."""

_LONGEST_DATAGRAM = 65_536
_MOST_SENDERS = 64
_ROOM = 1 << 20
"""For datagrams that wait, bytes."""

_WHOLE = re.compile(rb"\*[0-9A-Fa-f]{2}\s*$")


class UdpLines:
    """Listens at a port; a sentence that a sender cuts in two is put together.

    Parameters
    ----------
    address : str
        Of this machine, e.g. 0.0.0.0 for all of its own and for broadcasts; or of a group.
    port : int
        UDP port.

    Raises
    ------
    ConfigurationError
        If nobody can listen there.
    """

    def __init__(self, address: str, port: int) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _ROOM)
        self._socket.setblocking(False)
        self._begun: OrderedDict[object, bytes] = OrderedDict()
        try:
            self._socket.bind((address, port))
            if ip_address(address).is_multicast:
                group = struct.pack("=4sl", socket.inet_aton(address), socket.INADDR_ANY)
                self._socket.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, group)
        except (OSError, ValueError) as error:
            self._socket.close()
            reason = getattr(error, "strerror", None) or error
            raise ConfigurationError(
                f"address {address}, port {port}: nobody can listen there ({reason}); give 0.0.0.0 "
                "or an IPv4 address of this machine, and a port that is free."
            ) from error

    def read(self) -> list[bytes]:
        """Return the lines that have come, without waiting."""
        lines: list[bytes] = []
        for _ in range(MOST_AT_ONCE):
            try:
                data, sender = self._socket.recvfrom(_LONGEST_DATAGRAM)
            except OSError:  # nothing has come, or an earlier answer of ours was refused
                break
            lines += lines_of(self._continued(data, sender))
        return lines

    def close(self) -> None:
        """Listen no more."""
        self._socket.close()

    def _continued(self, data: bytes, sender: object) -> bytes:
        """Return what is whole of the bytes of a sender; the rest waits for its next datagram."""
        data = self._begun.pop(sender, b"") + data
        if data.endswith((b"\n", b"\r")) or _WHOLE.search(data):
            return data
        end = max(data.rfind(b"\n"), data.rfind(b"\r")) + 1
        self._begun[sender] = data[end:][-_LONGEST_DATAGRAM:]
        if len(self._begun) > _MOST_SENDERS:
            return data[:end] + b"\n" + self._begun.popitem(last=False)[1]
        return data[:end]
