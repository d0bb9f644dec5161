"""What a cable does to packets: it delays them in their order, and loses a share of them."""

from __future__ import annotations

import os
import random
import socket
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from sonar_tracking.graph.chaos.cable import Cable, relay


def test_packets_arrive_after_the_delay_in_their_order() -> None:
    arrived: list[bytes] = []
    cable = Cable(arrived.append, random.Random(1))
    cable.delay = 0.05
    assert cable.next_due is None
    cable.take(b"first", 10.0)
    cable.take(b"second", 10.0)
    assert cable.next_due == pytest.approx(10.05)
    cable.deliver(10.049)
    assert arrived == []
    cable.deliver(10.05)
    assert arrived == [b"first", b"second"]
    assert cable.next_due is None


def test_a_packet_that_is_not_delayed_does_not_wait_for_those_that_were() -> None:
    arrived: list[bytes] = []
    cable = Cable(arrived.append, random.Random(1))
    cable.delay = 1.0
    cable.take(b"slow", 0.0)
    cable.delay = 0.0
    cable.take(b"quick", 0.5)
    cable.deliver(0.5)
    assert arrived == [b"quick"]


@pytest.mark.parametrize("loss", [0.0, 0.1, 1.0])
def test_the_share_that_was_asked_for_is_lost(loss: float) -> None:
    arrived: list[bytes] = []
    cable = Cable(arrived.append, random.Random(2))
    cable.loss = loss
    for _ in range(2000):
        cable.take(b"packet", 0.0)
    cable.deliver(0.0)
    lost = 1.0 - len(arrived) / 2000
    # Four standard deviations of a binomial share.
    assert abs(lost - loss) <= 4.0 * (loss * (1.0 - loss) / 2000) ** 0.5


def test_a_relay_follows_its_orders_until_they_end() -> None:
    device, far = socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)
    orders, ordering = os.pipe()
    with device, far:
        far.settimeout(5.0)

        def send(packet: bytes) -> None:
            device.send(packet)

        cable = Cable(send, random.Random(3))
        thread = threading.Thread(target=relay, args=(device.fileno(), orders, cable))
        thread.start()
        far.send(b"there and back")
        assert far.recv(64) == b"there and back"
        os.write(ordering, b"1.0 0")
        os.write(ordering, b".25\n")
        os.close(ordering)
        thread.join(5.0)
        assert not thread.is_alive()
    os.close(orders)
    assert (cable.loss, cable.delay) == (1.0, 0.25)


LOOPBACK = """
import socket, time
from sonar_tracking.graph.chaos.network import Network

network = Network(seed=4)
heard = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
heard.bind(("127.0.0.1", 0))
says = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

def sent(count, patience):
    delays = []
    for _ in range(count):
        says.sendto(str(time.monotonic()).encode(), heard.getsockname())
    heard.settimeout(patience)
    try:
        while len(delays) < count:
            begin = float(heard.recv(64))
            delays.append(time.monotonic() - begin)
    except TimeoutError:
        pass
    return delays

print(len(sent(1, 10.0)))
network.slow()
time.sleep(0.2)
delays = sent(200, 1.0)
print(len(delays), min(delays))
network.part()
time.sleep(0.2)
print(len(sent(20, 0.5)))
network.quicken()
time.sleep(0.2)
print(len(sent(20, 5.0)))
"""


@pytest.mark.skipif(
    os.geteuid() != 0 or not Path("/dev/net/tun").exists(),
    reason="a network of one's own takes root and /dev/net/tun",
)
def test_all_that_programs_of_the_network_say_to_each_other_goes_by_the_cable() -> None:
    done = subprocess.run(
        [sys.executable, "-c", LOOPBACK], capture_output=True, text=True, timeout=60.0, check=False
    )
    if "network of their own" in done.stderr:
        pytest.skip(done.stderr.splitlines()[-1])
    assert done.returncode == 0, done.stderr
    through, slow, parted, quick = (line.split() for line in done.stdout.splitlines())
    assert through == ["1"]
    assert 150 <= int(slow[0]) <= 198
    assert float(slow[1]) >= 0.05
    assert parted == ["0"]
    assert quick == ["20"]
