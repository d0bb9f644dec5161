"""A network of its own for the runs of one program, which can be slow, lose packets, or part.

The namespace of the program is left for a new one, whose only link is the loopback: it is taken
down to part all nodes from each other, and ``netem`` of the kernel makes it slow. That takes root
(or ``CAP_SYS_ADMIN``) and the programs ``ip`` and ``tc`` of iproute2.
"""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.catalogue.discovery_range import PEERS, RANGE
from sonar_tracking.resources import find_resource

DELAY_MS, LOSS_PERCENT = 50, 10
"""Of every packet, and of all packets, while the network is slow."""

_CLONE_NEWNET = 0x40000000
_LINK = "lo"


def enter(slowed: bool) -> None:
    """Leave the network for one of this process and its children; nodes use UDP alone there.

    Parameters
    ----------
    slowed : bool
        Whether it is to be slow later, which is tried.

    Raises
    ------
    ConfigurationError
        If this machine, or its user, may not.
    """
    for program in ("ip", "tc"):
        if shutil.which(program) is None:
            raise ConfigurationError(
                f"delay and partition need the program {program}; install iproute2."
            )
    if ctypes.CDLL(None, use_errno=True).unshare(_CLONE_NEWNET) != 0:
        raise ConfigurationError(
            f"delay and partition need a network of their own ({os.strerror(ctypes.get_errno())}); "
            "run them as root."
        )
    join()
    if slowed:
        slow()
        quicken()
    profile = find_resource("config/fastdds/without_shared_memory.xml")
    os.environ["FASTRTPS_DEFAULT_PROFILES_FILE"] = str(profile)
    # Confined to this machine, ROS would talk by shared memory whatever the profile says.
    os.environ |= {RANGE: "SUBNET", PEERS: "127.0.0.1"}


def slow() -> None:
    """Let the network delay every packet, and lose some.

    Raises
    ------
    ConfigurationError
        If the kernel has no ``netem``.
    """
    words = ["delay", f"{DELAY_MS}ms", "loss", f"{LOSS_PERCENT}%", "limit", "100000"]
    _command("tc", "qdisc", "replace", "dev", _LINK, "root", "netem", *words)


def quicken() -> None:
    """Let everything through again, at once."""
    _command("tc", "qdisc", "del", "dev", _LINK, "root")


def part() -> None:
    """Let nothing through."""
    _command("ip", "link", "set", _LINK, "down")


def join() -> None:
    """Let everything through."""
    _command("ip", "link", "set", _LINK, "up")


def _command(*words: str) -> None:
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        hint = "; this kernel lacks netem (module sch_netem)" if "netem" in words else ""
        raise ConfigurationError(f"{' '.join(words)}: {done.stderr.strip()}{hint}.")
