"""The processes of a run, as the system lists them."""

from __future__ import annotations

import signal
from pathlib import Path

_PROCESSES = Path("/proc")


def node_processes(run: int, node: str) -> list[int]:
    """Return the processes of a node that a run has started."""
    return [
        process
        for process, (parent, arguments) in _listed().items()
        if parent == run and f"sonar_tracking.graph.nodes.{node}\0" in arguments
    ]


def has_begun(run: int) -> bool:
    """Tell whether a command has come to its first line: Python alone handles no SIGTERM."""
    try:
        status = (_PROCESSES / str(run) / "status").read_text()
    except OSError:
        return False
    caught = [line.split()[1] for line in status.splitlines() if line.startswith("SigCgt")]
    return bool(caught) and bool(int(caught[0], 16) >> (signal.SIGTERM - 1) & 1)


def nodes_of(folder: Path) -> list[int]:
    """Return the processes of nodes whose logs are below a folder, that of a run."""
    outputs = {process: _output_of(process) for process in _listed()}
    return [p for p, path in outputs.items() if path.suffix == ".log" and folder in path.parents]


def _output_of(process: int) -> Path:
    """Return where a process writes; an empty path if nobody may know."""
    try:
        return (_PROCESSES / str(process) / "fd" / "1").readlink()
    except OSError:
        return Path()


def _listed() -> dict[int, tuple[int, str]]:
    """Return parent and command line of every process that lives."""
    found = {}
    for stat in _PROCESSES.glob("[0-9]*/stat"):
        try:
            fields = stat.read_text().rpartition(")")[2].split()
            arguments = (stat.parent / "cmdline").read_bytes().decode(errors="replace")
        except OSError:
            continue
        if fields[0] != "Z":
            found[int(stat.parent.name)] = (int(fields[1]), arguments)
    return found
