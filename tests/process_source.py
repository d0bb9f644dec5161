"""Processes of tests begin as copies of one that has loaded what they need: seldom from nothing.

Most of the processor time of a short command, or of a node, goes into loading the interpreter and
modules. Each process of tests has one source, started at the first use, which has loaded them
once. A copy runs the same ``main`` of the same module in the environment, folder and log it is
told; it is a child of the process of the tests, which has its exit code and processor time. The
tests of installation, those of the start itself and runs of the longest tutorial begin from
nothing, as users do.

The source has the libraries of ROS too, which a run loads after its nodes have begun: of the
process of a node they are the larger part. The threads of their tracing, which wait for a program
that records them, are not copied, so that a copy has one thread as it would have from nothing.
"""

from __future__ import annotations

import atexit
import ctypes
import gc
import json
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from functools import cache, partial
from importlib import import_module
from pathlib import Path

from typer.testing import CliRunner

from sonar_tracking import cli
from sonar_tracking.bags.contents.message_definitions import installed_definition
from sonar_tracking.graph.catalogue import topics
from sonar_tracking.graph.message_writing.field_writing import message_class
from sonar_tracking.graph.orchestration.forked_node import SHARED, fork_node

LOADED = (
    *SHARED,
    "rclpy.experimental",
    "rclpy.node",
    "rclpy.serialization",
    "rich._emoji_codes",
    "scipy.special",
    "sonar_tracking.active.contact_tracker",
    "sonar_tracking.active.multi_target_tracker",
    "sonar_tracking.active.unresolved_tracks",
    "sonar_tracking.bags.mcap.mcap_storage",
    "sonar_tracking.evaluation.metrics.score_bag",
    "sonar_tracking.fusion.foreign_lists",
    "sonar_tracking.fusion.track_fusion_stage",
    "sonar_tracking.graph.message_writing.alignment_writing",
    "sonar_tracking.graph.message_writing.contact_writing",
    "sonar_tracking.graph.message_writing.line_writing",
    "sonar_tracking.graph.message_writing.position_writing",
    "sonar_tracking.graph.message_writing.simulated_writing",
    "sonar_tracking.graph.node_base.datum_topic",
    "sonar_tracking.graph.node_base.node_process",
    "sonar_tracking.graph.node_base.scenario_begin",
    "sonar_tracking.graph.node_base.sensor_simulator_node",
    "sonar_tracking.graph.node_base.simulator_node",
    "sonar_tracking.graph.node_base.sonar_node",
    "sonar_tracking.graph.nodes",
    "sonar_tracking.graph.orchestration.command_channel",
    "sonar_tracking.graph.orchestration.control_node",
    "sonar_tracking.graph.orchestration.player",
    "sonar_tracking.graph.orchestration.simulated_source",
    "sonar_tracking.graph.verbs.run_command",
    "sonar_tracking.graph.verbs.run_replay",
    "sonar_tracking.graph.verbs.run_scenario",
    "sonar_tracking.own_ship_interpolation",
    "sonar_tracking.passive.bearings.bearing_tracker_stage",
    "sonar_tracking.passive.bearings.independent_filters",
    "sonar_tracking.passive.bearings.joint_map_filters",
    "sonar_tracking.passive.bearings.projection_measurement",
    "sonar_tracking.passive.lines.line_tracker_stage",
    "sonar_tracking.passive.subspaces.exponential_covariance",
    "sonar_tracking.passive.subspaces.past",
    "sonar_tracking.passive.subspaces.subspace_stage",
    "sonar_tracking.simulation.sensors.active_sonar_simulation",
    "sonar_tracking.simulation.sensors.array_simulation",
    "sonar_tracking.simulation.sensors.bearing_simulation",
    "sonar_tracking.simulation.signals.near_targets",
    "sonar_tracking.simulation.world.world_simulation",
    "sonar_tracking.tma.tracker.tma_tracker_stage",
)
"""What commands and nodes load; no thread of it is one that a copy would miss."""

DRAWN_WITH = (
    "matplotlib.backends.backend_agg",
    "matplotlib.backends.backend_svg",
    "matplotlib.figure",
    "sonar_tracking.display.plot_bag",
)
"""What a command that draws loads besides; few do, so that only the first of them has it loaded."""

MESSAGES = (
    *{one.message_type: None for one in vars(topics).values() if isinstance(one, topics.Topic)},
    "rcl_interfaces/msg/Log",
    "rosgraph_msgs/msg/Clock",
    "service_msgs/msg/ServiceEventInfo",
    "type_description_interfaces/msg/TypeDescription",
)
"""The middleware loads a library for each package that has one of them."""

LONGEST_REQUEST = 100_000
"""Most of it is the environment, bytes."""
ROOM = 1000
"""For the command line that lists of processes show of a copy, bytes."""

_PR_SET_CHILD_SUBREAPER = 36
_libc = ctypes.CDLL(None)


class CopiedProcess:
    """A process of a test, with what tests use of :class:`subprocess.Popen`.

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
    folder : Path
        In which it runs.
    """

    def __init__(
        self,
        module: str,
        arguments: Sequence[str],
        environment: Mapping[str, str],
        log: Path,
        folder: Path = Path(),
    ) -> None:
        log.write_bytes(b"")
        places = str(log.resolve()), str(folder.resolve())
        request = [module, list(arguments), dict(environment), *places]
        self._name = module
        self.pid = _copy(json.dumps(request).encode())
        self.returncode: int | None = None

    def poll(self) -> int | None:
        """Return the exit code, or None while it runs."""
        if self.returncode is None:
            pid, status = os.waitpid(self.pid, os.WNOHANG)
            if pid:
                self.returncode = os.waitstatus_to_exitcode(status)
        return self.returncode

    def wait(self, timeout: float) -> int:
        """Return the exit code once it has ended, within a time in s."""
        deadline = time.monotonic() + timeout
        while (code := self.poll()) is None:
            if time.monotonic() > deadline:
                raise subprocess.TimeoutExpired(self._name, timeout)
            time.sleep(0.01)
        return code

    def send_signal(self, number: int) -> None:
        """Send a signal, unless it has ended."""
        if self.poll() is None:
            os.kill(self.pid, number)

    def kill(self) -> None:
        """End it whatever it does."""
        self.send_signal(signal.SIGKILL)


def _copy(request: bytes) -> int:
    """Return the number of a new process, which this one adopts."""
    source = _source()
    # Its parent ends at once: the nearest ancestor that has asked for orphans gets it.
    _libc.prctl(_PR_SET_CHILD_SUBREAPER, 1)
    try:
        source.send(request)
        return int(source.recv(LONGEST_REQUEST))
    finally:
        _libc.prctl(_PR_SET_CHILD_SUBREAPER, 0)


@cache
def _source() -> socket.socket:
    """Return what the source of this process is asked by."""
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    with theirs:
        source = subprocess.Popen(
            [sys.executable, __file__, str(theirs.fileno()), " " * ROOM],
            pass_fds=[theirs.fileno()],
            stdin=subprocess.DEVNULL,
        )

    def end() -> None:
        ours.close()
        source.wait()

    atexit.register(end)
    return ours


def _warm_up() -> None:
    """Load what copies need, and have done what takes long the first time."""
    gc.disable()  # what is loaded stays
    for each in LOADED:
        import_module(each)
    serialize = import_module("rclpy.serialization").serialize_message
    for message_type in MESSAGES:
        installed_definition(message_type)
        serialize(message_class(message_type)())
    CliRunner().invoke(cli.app, ["score", "nothing"])
    gc.enable()


def _answer(requests: socket.socket) -> None:
    """Make a copy for each request, until whoever asks is gone."""
    _warm_up()
    while request := requests.recv(LONGEST_REQUEST):
        module, arguments, environment, log, folder = json.loads(request)
        if arguments[:1] == ["plot"]:
            for each in DRAWN_WITH:
                import_module(each)
        end, begin = os.pipe()
        between = os.fork()
        if not between:
            try:
                copy = fork_node(
                    module, arguments, environment, Path(log), partial(os.chdir, folder)
                )
                os.write(begin, str(copy.pid).encode())
            finally:
                os._exit(0)
        os.waitpid(between, 0)
        os.close(begin)
        with os.fdopen(end) as number:
            requests.send(number.read().encode())


if __name__ == "__main__":
    sys.path[0] = ""  # as with python -m, and not the folder of this file
    _answer(socket.socket(fileno=int(sys.argv[1])))
