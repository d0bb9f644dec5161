"""A network of its own for the runs of one program, which can be slow, lose packets, or part.

The namespace of the program is left for a new one, in which whatever a program sends to this
machine goes by a device (TUN) whose other end is a :mod:`~sonar_tracking.graph.chaos.cable`. That
takes root (or ``CAP_SYS_ADMIN``) and the program ``ip`` of iproute2, but nothing of the kernel
that is not in all of them.
"""

from __future__ import annotations

import ctypes
import fcntl
import os
import shutil
import struct
import subprocess
import sys
from pathlib import Path

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.catalogue.discovery_range import PEERS, RANGE
from sonar_tracking.resources import find_resource

DELAY, LOSS = 0.05, 0.1
"""Of every packet, s, and the share of all packets, while the network is slow."""

_CLONE_NEWNET = 0x40000000
_TUNSETIFF, _IFF_TUN, _IFF_NO_PI = 0x400454CA, 0x1, 0x1000
_DEVICE = "cable"
_TABLE = "100"


class Network:
    """The network of this process and its children from now on; nodes use UDP alone in it.

    Parameters
    ----------
    seed : int
        Of what is lost.

    Raises
    ------
    ConfigurationError
        If this machine, or its user, may not.
    """

    def __init__(self, seed: int) -> None:
        if shutil.which("ip") is None:
            raise ConfigurationError("delay and partition need the program ip; install iproute2.")
        try:
            if ctypes.CDLL(None, use_errno=True).unshare(_CLONE_NEWNET) != 0:
                raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))
            device = _open_device()
            _route_by_device()
        except OSError as error:
            raise ConfigurationError(
                f"delay and partition need a network of their own ({error}); run them as root, "
                "on a machine that has /dev/net/tun."
            ) from error
        self._cable = subprocess.Popen(
            [sys.executable, "-m", "sonar_tracking.graph.chaos.cable", str(device), str(seed)],
            stdin=subprocess.PIPE,
            pass_fds=(device,),
        )
        profile = find_resource("config/fastdds/without_shared_memory.xml")
        os.environ["FASTRTPS_DEFAULT_PROFILES_FILE"] = str(profile)
        # Confined to this machine, ROS would talk by shared memory whatever the profile says.
        os.environ |= {RANGE: "SUBNET", PEERS: "127.0.0.1"}

    def slow(self) -> None:
        """Delay every packet from now on, and lose some."""
        self._order(LOSS, DELAY)

    def quicken(self) -> None:
        """Let everything through from now on, at once."""
        self._order(0.0, 0.0)

    def part(self) -> None:
        """Let nothing through from now on."""
        self._order(1.0, 0.0)

    def _order(self, loss: float, delay: float) -> None:
        orders = self._cable.stdin
        assert orders is not None
        orders.write(f"{loss} {delay}\n".encode())
        orders.flush()


def _open_device() -> int:
    device = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK)
    request = struct.pack("16sH", _DEVICE.encode(), _IFF_TUN | _IFF_NO_PI)
    fcntl.ioctl(device, _TUNSETIFF, request)
    return device


def _route_by_device() -> None:
    """Send what programs address to this machine by the device, and take in what comes by it."""
    for link in ("lo", _DEVICE):
        _ip("link", "set", link, "up")
    for name, value in (("route_localnet", 1), ("accept_local", 1), ("rp_filter", 0)):
        Path(f"/proc/sys/net/ipv4/conf/{_DEVICE}/{name}").write_text(f"{value}\n")
    Path("/proc/sys/net/ipv4/conf/all/rp_filter").write_text("0\n")
    _ip("route", "add", "127.0.0.0/8", "dev", _DEVICE, "src", "127.0.0.1", "table", _TABLE)
    # "iif lo" is what the programs of this machine send, not what comes by the device.
    _ip("rule", "add", "pref", "10", "iif", "lo", "lookup", _TABLE)
    _ip("rule", "add", "pref", "20", "lookup", "local")
    _ip("rule", "del", "pref", "0")


def _ip(*words: str) -> None:
    done = subprocess.run(["ip", *words], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise ConfigurationError(f"ip {' '.join(words)}: {done.stderr.strip()}.")
