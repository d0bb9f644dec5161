"""The processes of the graph: started, watched, stopped in bounded time.

Every node is a process of its own with its own log file. Children live in their own session, so
that Ctrl-C reaches them through the orchestration, in order; they are told to end when the
orchestration dies. No ROS here.
"""

from __future__ import annotations

import ctypes
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from sonar_tracking.graph.orchestration.forked_node import ForkedNode, can_fork, fork_node
from sonar_tracking.graph.orchestration.orphaned_shared_memory import HeldPorts
from sonar_tracking.stop_signals import HUNG

STOP_STAGES = ((signal.SIGINT, 8.0), (signal.SIGTERM, 3.0), (signal.SIGKILL, 2.0))
LOG_TAIL_LINES = 10
_PR_SET_PDEATHSIG = 1
_POLL_SECONDS = 0.02


@dataclass(frozen=True)
class ProcessPlan:
    """How to start one node.

    Attributes
    ----------
    name : str
        Node name.
    module : str
        Python module to run.
    arguments : tuple of str
        Command line behind the module.
    environment : mapping of str to str
        The whole environment of the process.
    """

    name: str
    module: str
    arguments: tuple[str, ...] = ()
    environment: Mapping[str, str] = field(default_factory=dict)


@dataclass
class SupervisedProcess:
    """What is known of one node's process over its restarts.

    Attributes
    ----------
    plan : ProcessPlan
        How it was started last.
    log : Path
        Its log file.
    log_start : int
        Size of the log when its last process was started.
    exit_code : int or None
        Of the last process, negative = killed by that signal; None while it runs.
    restarts : int
        How often it was started again.
    cpu_seconds : float
        Processor time of its ended processes.
    unexpected_exits : int
        How often it ended without being told to.
    """

    plan: ProcessPlan
    log: Path
    popen: subprocess.Popen[bytes] | ForkedNode
    log_start: int = 0
    exit_code: int | None = None
    restarts: int = 0
    cpu_seconds: float = 0.0
    unexpected_exits: int = 0

    @property
    def has_done_its_work(self) -> bool:
        """Whether it ended when it was told to, be it that the middleware did not let it go."""
        return self.exit_code in (0, -HUNG)

    @property
    def end_in_words(self) -> str:
        """How the last process ended."""
        if self.exit_code is not None and self.exit_code < 0:
            return f"was killed by {signal.Signals(-self.exit_code).name}"
        return f"ended with exit code {self.exit_code}"


class ProcessSupervisor:
    """Starts, watches and stops the processes of the graph.

    Parameters
    ----------
    log_directory : Path
        Where each node's output goes, one file a node.
    """

    def __init__(self, log_directory: Path) -> None:
        self._log_directory = log_directory
        self._stopping = False
        self._ports_of_the_dead = HeldPorts()
        self.processes: dict[str, SupervisedProcess] = {}

    def start(self, plan: ProcessPlan) -> None:
        """Start a node, or start it again after it has ended."""
        log = self._log_directory / f"{plan.name}.log"
        log_start = log.stat().st_size if log.exists() else 0
        known = self.processes.get(plan.name)
        if known is not None:
            self._ports_of_the_dead.hold()
        popen = _spawn(plan, log)
        if known is None:
            self.processes[plan.name] = SupervisedProcess(plan, log, popen, log_start)
            return
        known.plan, known.popen, known.log_start, known.exit_code = plan, popen, log_start, None
        known.restarts += 1

    def poll(self) -> list[SupervisedProcess]:
        """Return the nodes that have ended since the last call, and were not told to."""
        ended = []
        for process in self.processes.values():
            if process.exit_code is None and _reap(process) and not self._stopping:
                process.unexpected_exits += 1
                ended.append(process)
        return ended

    def running(self) -> list[str]:
        """Return the names of the nodes whose process lives."""
        return [name for name, process in self.processes.items() if process.exit_code is None]

    def stop(self, names: list[str], hurry: Callable[[], bool] = lambda: False) -> None:
        """Stop nodes in bounded time: SIGINT, then SIGTERM, then SIGKILL.

        Parameters
        ----------
        names : list of str
            Nodes to stop.
        hurry : callable
            Polled while waiting; True skips to SIGKILL.
        """
        self._stopping = True
        for stage, patience in STOP_STAGES:
            waiting = [n for n in names if n in self.running()]
            for name in waiting:
                # Not Popen.send_signal: it would reap a process that has just ended, and with it
                # its processor time. Until it is reaped here its number stays its own.
                os.kill(self.processes[name].popen.pid, stage)
            deadline = time.monotonic() + patience
            while waiting and time.monotonic() < deadline:
                if hurry() and stage != signal.SIGKILL:
                    break
                time.sleep(_POLL_SECONDS)
                self.poll()
                waiting = [n for n in waiting if n in self.running()]
        self._ports_of_the_dead.release()

    def log_tail(self, name: str) -> str:
        """Return the last lines the last process of a node has written."""
        process = self.processes[name]
        text = process.log.read_bytes()[process.log_start :].decode(errors="replace")
        return "\n".join(text.splitlines()[-LOG_TAIL_LINES:])


def _spawn(plan: ProcessPlan, log: Path) -> subprocess.Popen[bytes] | ForkedNode:
    if can_fork(plan.module):
        return fork_node(plan.module, plan.arguments, plan.environment, log, _end_with_parent)
    command = [sys.executable, "-m", plan.module, *plan.arguments]
    with log.open("ab") as output:
        return subprocess.Popen(
            command,
            env=dict(plan.environment),
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
            start_new_session=True,
            preexec_fn=_end_with_parent,
        )


_libc = ctypes.CDLL(None)


def _end_with_parent() -> None:
    _libc.prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)


def _reap(process: SupervisedProcess) -> bool:
    """Collect exit code and processor time of a process that has ended."""
    pid, status, usage = os.wait4(process.popen.pid, os.WNOHANG)
    if pid == 0:
        return False
    process.exit_code = os.waitstatus_to_exitcode(status)
    process.popen.returncode = process.exit_code
    process.cpu_seconds += usage.ru_utime + usage.ru_stime
    return True
