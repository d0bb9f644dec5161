"""One run of a graph, measured from its command to its end."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from sonar_tracking.errors import SonarTrackingError
from sonar_tracking.evaluation.bench.stage_costs import ORCHESTRATION
from sonar_tracking.graph.bench.first_message import FirstMessage
from sonar_tracking.graph.bench.process_figures import (
    ProcessFigures,
    nodes_of_run,
    process_figures,
)
from sonar_tracking.graph.catalogue.topics import Topic

LOOK = 0.2
"""Between looks at the processes, s."""

PATIENCE = 300.0

FAILED = 1
"""Exit code of a run whose report tells of failures: it is measured all the same."""


class GraphNotMeasuredError(SonarTrackingError):
    """A run that is measured has failed."""


@dataclass(frozen=True)
class MeasuredRun:
    """What a run took.

    Attributes
    ----------
    report : mapping
        JSON of the run.
    spawned, data_flow, first_track : float
        When the last node process was started, data flowed, and a subscriber had the first list of
        tracks, s after the command; NaN = never.
    start_seconds, cpu_seconds, memory_mb : mapping of str to float
        Processor time until data flowed and in all, s, and the most memory that was resident, 1e6
        bytes, of each node and of the orchestration.
    """

    report: Mapping[str, Any]
    spawned: float
    data_flow: float
    first_track: float
    start_seconds: Mapping[str, float]
    cpu_seconds: Mapping[str, float]
    memory_mb: Mapping[str, float]


@dataclass
class _Watch:
    """What is known of the processes of a run while it lives."""

    run: subprocess.Popen[str]
    flow: float | None = None
    latest: dict[str, ProcessFigures] = field(default_factory=dict)
    at_flow: dict[str, float] = field(default_factory=dict)
    said: list[str] = field(default_factory=list)

    def listen(self) -> None:
        """Read what the run says until it ends; note when data flow."""
        if self.run.stdout is None:
            return
        with self.run.stdout as output:
            for line in output:
                self.said.append(line)
                if self.flow is None and "data flow" in line:
                    self.flow = time.monotonic()

    def look(self) -> None:
        """Take the figures of all processes."""
        for name, process in {**nodes_of_run(self.run.pid), ORCHESTRATION: self.run.pid}.items():
            figures = process_figures(process)
            if figures is not None:
                self.latest[name] = figures
        if self.flow is not None and not self.at_flow:
            self.at_flow = {name: each.cpu_seconds for name, each in self.latest.items()}


def measured_run(arguments: Sequence[str], tracks: Topic, folder: Path) -> MeasuredRun:
    """Run a graph and measure it.

    Parameters
    ----------
    arguments : sequence of str
        Verb and options of the command.
    tracks : Topic
        Lists of tracks whose first one is waited for.
    folder : Path
        For the report and the logs.

    Raises
    ------
    GraphNotMeasuredError
        If the run comes to no end of its own.
    """
    report = folder / "report.json"
    command = [
        *(sys.executable, "-m", "sonar_tracking", *arguments),
        *("--no-display", "--no-display-topics", "--json", str(report)),
    ]
    first = FirstMessage(tracks)
    booted, begun = time.clock_gettime(time.CLOCK_BOOTTIME), time.monotonic()
    run = subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
        env={**os.environ, "ROS_HOME": str(folder)},
    )
    watch = _Watch(run)
    listener = threading.Thread(target=watch.listen, daemon=True)
    listener.start()
    try:
        usage = _watched(watch, first, begun + PATIENCE)
    finally:
        first.close()
        if run.poll() is None:
            run.send_signal(signal.SIGINT)
            run.wait(PATIENCE)
    listener.join(PATIENCE)
    if run.returncode not in (0, FAILED) or not report.exists():
        said = "".join(watch.said[-5:]).strip()
        raise GraphNotMeasuredError(f"{' '.join(arguments)} gave no report: {said}")
    values = json.loads(report.read_text())
    nodes = {name: float(node["cpu_seconds"]) for name, node in values["nodes"].items()}
    started = [each.started for name, each in watch.latest.items() if name in nodes]
    return MeasuredRun(
        values,
        max(started, default=float("nan")) - booted,
        (watch.flow or float("nan")) - begun,
        (first.wall or float("nan")) - begun,
        watch.at_flow,
        # The system counts the ended nodes as their parent's.
        {**nodes, ORCHESTRATION: usage - sum(nodes.values())},
        {name: each.memory_mb for name, each in watch.latest.items()},
    )


def _watched(watch: _Watch, first: FirstMessage, deadline: float) -> float:
    """Look after a run until it ends; return its processor time and that of its nodes, s."""
    looked = 0.0
    while True:
        ended, status, usage = os.wait4(watch.run.pid, os.WNOHANG)
        if ended:
            watch.run.returncode = os.waitstatus_to_exitcode(status)
            return usage.ru_utime + usage.ru_stime
        first.wait(0.02)
        wall = time.monotonic()
        if wall - looked > LOOK or (watch.flow is not None and not watch.at_flow):
            looked = wall
            watch.look()
        if wall > deadline:
            raise GraphNotMeasuredError(
                f"A run of the bench has not ended after {PATIENCE:.0f} s and was stopped."
            )
