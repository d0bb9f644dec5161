"""Nodes that begin as copies of the orchestration: what all of them load is loaded once.

Most of the processor time a node takes to start goes into loading the interpreter, numpy and the
definitions of messages. A copy of a process that has them shares them, in memory too. Only a
process with one thread can be copied safely, and the libraries of ROS start threads (those of its
tracing) when they are loaded: they come later, in each node by itself. Once the orchestration has
loaded them, and for modules that are not nodes of this package, a process is started from nothing
as usual. Both run the same code, ``main`` of the module, in the same environment.
"""

from __future__ import annotations

import ctypes
import gc
import importlib
import os
import runpy
import signal
import sys
import traceback
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import NoReturn

from sonar_tracking.stop_signals import STOP_SIGNALS

NODES = "sonar_tracking.graph.nodes."
SHARED = (
    "sonar_tracking.graph.catalogue.command_kinds",
    "sonar_tracking.graph.message_writing.array_writing",
    "sonar_tracking.graph.message_writing.progress_writing",
    "sonar_tracking.message_reading.array_reading",
    "sonar_tracking.message_reading.snapshot_bytes",
    "sonar_tracking.graph.node_base.event_time_join",
    "sonar_tracking.graph.node_base.stamp_guard",
    "sonar_tracking_msgs.msg",
    "diagnostic_msgs.msg",
    "rosgraph_msgs.msg",
    "rcl_interfaces.msg",
    "rcl_interfaces.srv",
    "type_description_interfaces.msg",
    "type_description_interfaces.srv",
    "ament_index_python.packages",
    "rosidl_generator_py",
    "xml.etree.ElementTree",
)
"""What nodes load, whatever they do, and what starts no thread."""

_THREADS = Path("/proc/self/task")
"""One entry a thread, those of libraries among them."""
_PR_SET_NAME = 15
_LONGEST_NAME = 15
_ARGUMENTS_BEGIN, _ARGUMENTS_END = 45, 46
"""Of the fields of ``/proc/self/stat`` behind the name of the command."""

_libc = ctypes.CDLL(None)


class ForkedNode:
    """A node that is a copy of this process.

    Attributes
    ----------
    pid : int
        Of the process.
    returncode : int or None
        Once somebody has waited for it.
    """

    def __init__(self, pid: int) -> None:
        self.pid = pid
        self.returncode: int | None = None


def can_fork(module: str) -> bool:
    """Return whether a module can be run by a copy of this process."""
    return module.startswith(NODES) and len(list(_THREADS.iterdir())) == 1


def fork_node(
    module: str,
    arguments: Sequence[str],
    environment: Mapping[str, str],
    log: Path,
    prepare: Callable[[], None],
) -> ForkedNode:
    """Start a node as a copy of this process.

    Parameters
    ----------
    module : str
        What it runs.
    arguments : sequence of str
        Its command line behind the module.
    environment : mapping of str to str
        Its whole environment.
    log : Path
        Where its output goes.
    prepare : callable
        Called in the new process before anything else.
    """
    for each in SHARED:
        importlib.import_module(each)
    # What garbage is looked for in is no longer shared.
    gc.freeze()
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    pid = os.fork()
    if pid:
        return ForkedNode(pid)
    try:
        prepare()
        _become(module, arguments, environment, log)
        code = _run(module)
    except BaseException:
        code = 1
        traceback.print_exc()
    _end(code)


def _become(
    module: str, arguments: Sequence[str], environment: Mapping[str, str], log: Path
) -> None:
    """Take off everything of the process this one is a copy of."""
    os.setsid()
    for number in STOP_SIGNALS:
        signal.signal(number, signal.SIG_DFL)
    output = os.open(log, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o644)
    nothing = os.open(os.devnull, os.O_RDONLY)
    for source, target in ((nothing, 0), (output, 1), (output, 2)):
        os.dup2(source, target)
    os.closerange(3, os.sysconf("SC_OPEN_MAX"))
    sys.stdout = open(1, "w", buffering=1, closefd=False)  # noqa: SIM115
    sys.stderr = open(2, "w", buffering=1, closefd=False)  # noqa: SIM115
    os.environ.clear()
    os.environ.update(environment)
    sys.argv = [module, *arguments]
    _show_as([Path(sys.executable).name, "-m", module, *arguments])


def _run(module: str) -> int:
    """Run a module as a program and return its exit code."""
    try:
        runpy.run_module(module, run_name="__main__", alter_sys=True)
    except SystemExit as end:
        if end.code is None or isinstance(end.code, int):
            return end.code or 0
        print(end.code, file=sys.stderr)
        return 1
    return 0


def _end(code: int) -> NoReturn:
    """Leave, without what the copied process would do at its end."""
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    os._exit(code)


def _show_as(command: Sequence[str]) -> None:
    """Let lists of processes show the command line of a node, as far as there is room for it."""
    name = command[2].rpartition(".")[2].encode()[:_LONGEST_NAME]
    _libc.prctl(_PR_SET_NAME, name)
    try:
        fields = Path("/proc/self/stat").read_text().rpartition(")")[2].split()
        begin, end = int(fields[_ARGUMENTS_BEGIN]), int(fields[_ARGUMENTS_END])
    except (OSError, IndexError, ValueError):
        return
    text = "\0".join(command).encode()[: end - begin - 1]
    if begin:
        ctypes.memmove(begin, text.ljust(end - begin, b"\0"), end - begin)
