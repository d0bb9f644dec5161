"""A network of its own for the runs of one program, which can be slow, lose packets, or part.

The namespace of the program is left for a new one, whose only link is the loopback; what delays and
loses on it is ``netem`` of the kernel. That takes root (or ``CAP_SYS_ADMIN``) and the programs
``ip`` and ``tc`` of iproute2.
"""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.resources import find_resource

DELAY_MS, LOSS_PERCENT = 50, 10
"""Of every packet, and of all packets, while the network is disturbed."""

_CLONE_NEWNET = 0x40000000
_LINK = "lo"


def enter() -> None:
    """Leave the network for one of this process and its children; nodes use UDP alone there.

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
    _command("ip", "link", "set", _LINK, "up")
    profile = find_resource("config/fastdds/without_shared_memory.xml")
    os.environ["FASTRTPS_DEFAULT_PROFILES_FILE"] = str(profile)


def disturb(parted: bool) -> None:
    """Let the network delay and lose packets; or all of them, if it is parted."""
    loss = 100 if parted else LOSS_PERCENT
    delay = ["delay", f"{DELAY_MS}ms", "loss", f"{loss}%", "limit", "100000"]
    _command("tc", "qdisc", "replace", "dev", _LINK, "root", "netem", *delay)


def mend() -> None:
    """Let everything through again, at once."""
    _command("tc", "qdisc", "replace", "dev", _LINK, "root", "netem")


def _command(*words: str) -> None:
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise ConfigurationError(f"{' '.join(words)}: {done.stderr.strip()}")
