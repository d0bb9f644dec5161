"""Processor time, memory and start of processes, as the system tells them. No ROS."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from pathlib import Path

_PROCESSES = Path("/proc")
_TICK = 1.0 / os.sysconf("SC_CLK_TCK")
_USER, _SYSTEM, _START = 11, 12, 19
"""Places of user time, system time and start in what follows the name of a process."""


@dataclass(frozen=True)
class ProcessFigures:
    """What the system tells of a process that lives.

    Attributes
    ----------
    started : float
        When, s after the start of the machine (CLOCK_BOOTTIME).
    cpu_seconds : float
        User and system time so far, s.
    memory_mb : float
        Most that was resident so far, 1e6 bytes.
    """

    started: float
    cpu_seconds: float
    memory_mb: float


def process_figures(process: int) -> ProcessFigures | None:
    """Return the figures of a process, None if it does not live."""
    folder = _PROCESSES / str(process)
    try:
        fields = (folder / "stat").read_text().rpartition(")")[2].split()
        status = (folder / "status").read_text()
    except OSError:
        return None
    peak = re.search(r"^VmHWM:\s+(\d+) kB", status, re.MULTILINE)
    if peak is None:
        return None
    return ProcessFigures(
        started=int(fields[_START]) * _TICK,
        cpu_seconds=(int(fields[_USER]) + int(fields[_SYSTEM])) * _TICK,
        memory_mb=int(peak[1]) * 1024e-6,
    )


def nodes_of_run(run: int) -> dict[str, int]:
    """Return the processes of the nodes a run has started, by name: that of the log they write."""
    try:
        children = (_PROCESSES / str(run) / "task" / str(run) / "children").read_text().split()
    except OSError:
        return {}
    found = {}
    for child in children:
        try:
            output = (_PROCESSES / child / "fd" / "1").readlink()
        except OSError:
            continue
        if output.suffix == ".log":
            found[output.stem] = int(child)
    return found
