"""The command as a user types it, in a ROS domain of its own."""

from __future__ import annotations

import io
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any
from unittest import mock

from sonar_tracking import cli
from sonar_tracking.stop_signals import STOP_SIGNALS
from tests.process_source import CopiedProcess
from tests.ros_domain import ros_domain

COMMAND = "sonar_tracking"
"""Module it runs."""
PATIENCE = 90.0
"""Longest wait for anything, s: generous, because machines may be busy."""


def environment(home: Path) -> dict[str, str]:
    """Return the environment of a command whose logs go below ``home``."""
    return {
        **os.environ,
        "ROS_DOMAIN_ID": str(ros_domain()),
        "ROS_HOME": str(home),
    }


def typed(*arguments: object, pictures: bool) -> list[str]:
    """Return the words; a graph is started without what RViz shows unless someone looks at it."""
    unseen = [] if pictures or arguments[0] not in ("run", "replay") else ["--no-display-topics"]
    return [*map(str, arguments), *unseen]


def run_command(
    home: Path, *arguments: object, pictures: bool = False
) -> subprocess.CompletedProcess[str]:
    """Run the command to its end; output and errors are in ``stdout``."""
    return run_words(typed(*arguments, pictures=pictures), environment(home))


def run_words(
    words: list[str], variables: dict[str, str], folder: Path = Path()
) -> subprocess.CompletedProcess[str]:
    """Run the command with these words, in an environment and a folder, to its end."""
    with tempfile.NamedTemporaryFile() as output:
        log = Path(output.name)
        process = CopiedProcess(COMMAND, words, variables, log, folder)
        try:
            code = process.wait(PATIENCE)
        finally:
            process.kill()
        return subprocess.CompletedProcess(words, code, log.read_text())


def refused(home: Path, *arguments: object) -> str:
    """Return what is said of a request that is refused with exit code 2, in this process.

    Nothing is to be started, so that no process of its own is needed, which costs its imports.
    """
    said = io.StringIO()
    handlers = {number: signal.getsignal(number) for number in STOP_SIGNALS}
    words = ["sonar-tracking", *map(str, arguments)]
    try:
        with (
            mock.patch.dict(os.environ, environment(home)),
            mock.patch.object(sys, "argv", words),
            redirect_stdout(io.StringIO()),
            redirect_stderr(said),
        ):
            assert _exit_code() == cli.REFUSED, said.getvalue()
    finally:
        for number, handler in handlers.items():
            signal.signal(number, handler)
    return said.getvalue()


def _exit_code() -> object:
    """Return the exit code of the command, which refuses its options by itself."""
    try:
        return cli.main()
    except SystemExit as end:
        return end.code


def report_of(path: Path) -> dict[str, Any]:
    """Return the JSON a command has written."""
    report: dict[str, Any] = json.loads(path.read_text())
    return report


def digests(report: dict[str, Any]) -> dict[str, str]:
    """Return the digest of each topic of a report."""
    return {name: topic["digest"] for name, topic in report["topics"].items()}


class RunningCommand:
    """A command that is interfered with while it runs.

    Parameters
    ----------
    home : Path
        Where logs go.
    arguments : object
        Command line.
    pictures : bool
        Whether a graph publishes what RViz and Foxglove show.
    """

    def __init__(self, home: Path, *arguments: object, pictures: bool = False) -> None:
        self._output = home / "output.txt"
        words = typed(*arguments, pictures=pictures)
        self._process = CopiedProcess(COMMAND, words, environment(home), self._output)

    @property
    def output(self) -> str:
        """Everything it has written so far."""
        return self._output.read_text()

    @property
    def own_output(self) -> str:
        """The same without what the middleware says.

        It complains where two processes claim a port of shared memory at once, and takes another.
        """
        lines = self.output.splitlines(keepends=True)
        return "".join(line for line in lines if "RTPS_TRANSPORT_SHM" not in line)

    def wait_for(self, condition: Callable[[], bool]) -> None:
        """Wait until something is the case while the command runs."""
        deadline = time.monotonic() + PATIENCE
        while not condition():
            assert self._process.poll() is None, self.output
            assert time.monotonic() < deadline, self.output
            time.sleep(0.1)  # some of them read a whole bag

    def wait_for_text(self, text: str) -> None:
        """Wait until it has written something."""
        self.wait_for(lambda: text in self.output)

    def node_processes(self, node: str = "") -> list[int]:
        """Return the processes of its nodes, or of one node."""
        found = []
        for stat in Path("/proc").glob("[0-9]*/stat"):
            try:
                parent = int(stat.read_text().rpartition(")")[2].split()[1])
                arguments = (stat.parent / "cmdline").read_bytes().decode()
            except (OSError, ValueError):
                continue
            if parent == self._process.pid and f"sonar_tracking.graph.nodes.{node}" in arguments:
                found.append(int(stat.parent.name))
        return found

    def kill_node(self, node: str) -> None:
        """Kill the process of one node."""
        (process,) = self.node_processes(node)
        os.kill(process, signal.SIGKILL)

    def interrupt(self, number: int = signal.SIGINT) -> None:
        """Press Ctrl-C, or send another signal."""
        os.kill(self._process.pid, number)

    def wait(self) -> int:
        """Wait for the end and return the exit code."""
        return self._process.wait(PATIENCE)

    def clean_up(self) -> None:
        """Leave no process behind."""
        nodes = self.node_processes()
        self._process.kill()
        self._process.wait(PATIENCE)
        for process in nodes:
            try:
                os.kill(process, signal.SIGKILL)
            except ProcessLookupError:
                continue
