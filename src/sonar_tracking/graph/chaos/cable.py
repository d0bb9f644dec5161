"""A cable that can be slow, lose packets or be unplugged: a process between the ends of a device.

Run as a program, with the file descriptor of a network device (TUN) and a seed: whatever the
device sends comes back by it, later or not at all. Each line of standard input, ``LOSS DELAY``
(a share of all packets, and seconds), says how from then on; its end ends the program.
"""

from __future__ import annotations

import heapq
import os
import random
import select
import sys
import time
from collections.abc import Callable

_LONGEST_PACKET = 65535


class Cable:
    """Packets on their way.

    Parameters
    ----------
    send : callable
        Takes a packet out at the end of its way.
    generator : random.Random
        Of what is lost.
    """

    def __init__(self, send: Callable[[bytes], None], generator: random.Random) -> None:
        self.loss = 0.0
        self.delay = 0.0
        self._send = send
        self._generator = generator
        self._packets: list[tuple[float, int, bytes]] = []
        self._taken = 0

    @property
    def next_due(self) -> float | None:
        """When the next packet arrives, s; None without one."""
        return self._packets[0][0] if self._packets else None

    def take(self, packet: bytes, now: float) -> None:
        """Take a packet at a time, s."""
        self._taken += 1
        if self._generator.random() >= self.loss:
            heapq.heappush(self._packets, (now + self.delay, self._taken, packet))

    def deliver(self, now: float) -> None:
        """Send what is due at a time, s, in its order."""
        while self._packets and self._packets[0][0] <= now:
            self._send(heapq.heappop(self._packets)[2])


def relay(device: int, orders: int, cable: Cable) -> None:
    """Pass packets of a device back to it until the orders end.

    Parameters
    ----------
    device : int
        File descriptor, not blocking.
    orders : int
        File descriptor of lines as the module describes them.
    cable : Cable
        Sends to the device.
    """
    text = b""
    while True:
        due = cable.next_due
        patience = None if due is None else max(due - time.monotonic(), 0.0)
        ready, _, _ = select.select([device, orders], [], [], patience)
        if orders in ready:
            received = os.read(orders, 4096)
            if not received:
                return
            *lines, text = (text + received).split(b"\n")
            for line in lines:
                cable.loss, cable.delay = (float(word) for word in line.split())
        if device in ready:
            cable.take(os.read(device, _LONGEST_PACKET), time.monotonic())
        cable.deliver(time.monotonic())


def main() -> None:
    """Relay as the arguments say."""
    device, seed = (int(word) for word in sys.argv[1:])

    def send(packet: bytes) -> None:
        os.write(device, packet)

    relay(device, sys.stdin.fileno(), Cable(send, random.Random(seed)))


if __name__ == "__main__":
    main()
