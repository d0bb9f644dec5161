"""One run of a scenario that suffers faults, and what came of it."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.chaos.fault_plan import (
    DELAYED,
    ENDS_THE_RUN,
    OF_THE_NETWORK,
    Fault,
    FaultKind,
)
from sonar_tracking.graph.chaos.network import Network
from sonar_tracking.graph.chaos.outcome import Outcome
from sonar_tracking.graph.chaos.recording_check import (
    longest_hole,
    messages_lost,
    recorded_stamps,
)
from sonar_tracking.graph.chaos.run_processes import has_begun, node_processes, nodes_of
from sonar_tracking.graph.chaos.track_identities import (
    LISTS_AFTER,
    TrackList,
    identities,
    longest_delay,
)
from sonar_tracking.graph.chaos.track_watch import TrackWatch
from sonar_tracking.graph.chaos.watched_graph import WatchedGraph

STALL = 20.0
"""A list that is so much later than due has stalled, s of the wall clock."""

PATIENCE = 90.0
"""Longest wait for a run to begin, to find its tracks, or to end, s."""

ORPHAN_PATIENCE = 10.0
"""By then all nodes of a run that is over have ended, s."""

REFUSED = 2
"""Exit code of a run that was not started."""

LOOK = 0.05
"""Between looks at a run, s."""


@dataclass
class DisturbedRun:
    """A run as a process of its own, in the domain of this one.

    Attributes
    ----------
    graph : WatchedGraph
        What is run, and watched of it.
    rate : float
        Seconds of data a second.
    folder : Path
        Where its bag, its output and its logs go.
    reference : callable
        Returns the lists of an undisturbed run, asked for only where a track was lost.
    network : Network or None
        What the run communicates by; None if no fault is of the network.
    """

    graph: WatchedGraph
    rate: float
    folder: Path
    reference: Callable[[], Sequence[TrackList]]
    network: Network | None
    outcomes: list[Outcome] = field(default_factory=list)
    _windows: list[tuple[Outcome, list[TrackList], list[TrackList]]] = field(default_factory=list)
    _truth: list[TrackList] = field(default_factory=list)

    def suffer(self, faults: Sequence[Fault]) -> list[Outcome]:
        """Start the run, let the faults happen, end it and return what came of each.

        Raises
        ------
        ConfigurationError
            If the run is refused, for example since another one goes on in the domain.
        """
        kind = faults[0].kind
        self.folder.mkdir(parents=True, exist_ok=True)
        log = self.folder / "output.txt"
        with log.open("w") as output:
            run = subprocess.Popen(
                self._command(),
                stdout=output,
                stderr=subprocess.STDOUT,
                start_new_session=True,
                env={**os.environ, "ROS_HOME": str(self.folder)},
            )
        try:
            if kind in ENDS_THE_RUN:
                self._end_by(run, faults[0], log)
            else:
                self._disturb(run, faults, log)
        finally:
            if run.poll() is None:
                os.kill(run.pid, signal.SIGINT)
                _ended(run)
            if self.network is not None:
                self.network.quicken()
        if run.returncode == REFUSED:
            said = log.read_text(errors="replace").strip()
            raise ConfigurationError(said.removeprefix("sonar-tracking: "))
        _until(lambda: not nodes_of(self.folder), ORPHAN_PATIENCE)
        for outcome in self.outcomes:
            outcome.traceback = "Traceback" in log.read_text(errors="replace")
            outcome.orphans = bool(nodes_of(self.folder))
        if kind not in ENDS_THE_RUN and self.outcomes:
            self._judge()
            self._check_recording(self.outcomes[0])
        return self.outcomes

    def _command(self) -> list[str]:
        return [
            *(sys.executable, "-m", "sonar_tracking", "run", self.graph.scenario),
            *("--rate", f"{self.rate:g}", "--no-display"),
            *("--record", str(self.folder / "bag")),
            *("--json", str(self.folder / "report.json")),
        ]

    def _end_by(self, run: subprocess.Popen[bytes], fault: Fault, log: Path) -> None:
        outcome = Outcome(fault)
        if fault.kind is FaultKind.START:
            outcome.stalled = not self._flows(run, log)
        else:
            _until(lambda: has_begun(run.pid) or run.poll() is not None, PATIENCE)
            time.sleep(fault.seconds)
        killed = fault.kind is FaultKind.ORCHESTRATION
        if run.poll() is None:
            os.kill(run.pid, signal.SIGKILL if killed else signal.SIGINT)
        _ended(run)
        outcome.exit_code = run.returncode
        self.outcomes.append(outcome)

    @staticmethod
    def _flows(run: subprocess.Popen[bytes], log: Path) -> bool:
        """Wait until data flow; return whether they do."""

        def flows() -> bool:
            return "data flow" in log.read_text(errors="replace")

        return _until(lambda: flows() or run.poll() is not None, PATIENCE) and flows()

    def _disturb(self, run: subprocess.Popen[bytes], faults: Sequence[Fault], log: Path) -> None:
        if not self._flows(run, log):
            self.outcomes.append(Outcome(faults[0], stalled=True))
            return
        watch = TrackWatch(self.graph.tracks, self.graph.inputs if _malformed(faults) else ())
        try:
            for fault in faults:
                if not self._is_steady(run, watch):
                    return
                watch.spin(fault.seconds)
                if run.poll() is None:
                    self._one(run, fault, watch)
        finally:
            self._truth = watch.truth
            watch.close()

    @staticmethod
    def _is_steady(run: subprocess.Popen[bytes], watch: TrackWatch) -> bool:
        """Wait until lists confirm tracks; without tracks there is nothing to watch."""
        deadline = time.monotonic() + PATIENCE
        while not watch.steady and run.poll() is None and time.monotonic() < deadline:
            watch.spin(LOOK)
        return watch.steady and run.poll() is None

    def _one(self, run: subprocess.Popen[bytes], fault: Fault, watch: TrackWatch) -> None:
        outcome = Outcome(fault)
        before, due, at = len(watch.lists), watch.due, time.monotonic()
        interval = watch.interval
        self._do(run.pid, fault, watch)
        if fault.kind is not FaultKind.KILL:
            before, due, at = len(watch.lists), watch.due, time.monotonic()
        first = deadline = max(due, at)
        while run.poll() is None and time.monotonic() < deadline + STALL:
            watch.spin(LOOK)
            valid = [each for each in watch.lists[before:] if each.places]
            if valid:
                outcome.late = longest_delay([each.wall for each in valid], first, interval)
                deadline = valid[-1].wall + interval
            begin = watch.lists.index(valid[0]) if valid else len(watch.lists)
            if len(watch.lists) >= begin + LISTS_AFTER:
                self._windows.append((outcome, watch.lists[:before], watch.lists[begin:]))
                break
        else:
            outcome.stalled = run.poll() is None
        if outcome.late is not None or outcome.stalled:
            self.outcomes.append(outcome)

    def _do(self, run: int, fault: Fault, watch: TrackWatch) -> None:
        """Let a fault happen; return when it is over."""
        if fault.kind is FaultKind.MALFORMED:
            watch.send_malformed(fault.target, fault.seed)
        elif fault.kind in OF_THE_NETWORK:
            assert self.network is not None
            _disturb_network(self.network, fault, watch)
        elif fault.target:
            _signal_node(run, fault, watch)

    def _judge(self) -> None:
        """Tell whether tracks were kept; by an undisturbed run, too, if not."""
        cutoff = self.graph.cutoff
        for outcome, before, after in self._windows:
            tracks = identities(before, after, self._truth, cutoff)
            if tracks.kept < tracks.established:
                tracks = identities(before, after, self._truth, cutoff, self.reference())
            outcome.tracks = tracks

    def _check_recording(self, outcome: Outcome) -> None:
        """Compare what was recorded with what was published, once for all faults of the run."""
        report = self.folder / "report.json"
        if not report.exists():
            return
        published = {name for topics in self.graph.published.values() for name in topics}
        stamps = recorded_stamps(self.folder, published)
        if outcome.fault.kind is FaultKind.RECORDER:
            outcome.hole = longest_hole(stamps) / self.rate
        else:
            outcome.lost_messages = messages_lost(
                stamps, json.loads(report.read_text()), self.graph.published
            )


def _malformed(faults: Sequence[Fault]) -> bool:
    return faults[0].kind is FaultKind.MALFORMED


def _disturb_network(network: Network, fault: Fault, watch: TrackWatch) -> None:
    network.slow()
    if fault.kind is FaultKind.DELAY:
        watch.spin(fault.duration)
        network.quicken()
        return
    watch.spin(DELAYED)
    network.part()
    watch.spin(fault.duration)
    network.slow()


def _signal_node(run: int, fault: Fault, watch: TrackWatch) -> None:
    for process in node_processes(run, fault.target):
        if fault.kind is not FaultKind.STOP:
            os.kill(process, signal.SIGKILL)
            continue
        os.kill(process, signal.SIGSTOP)
        watch.spin(fault.duration)
        os.kill(process, signal.SIGCONT)


def _ended(run: subprocess.Popen[bytes]) -> None:
    try:
        run.wait(PATIENCE)
    except subprocess.TimeoutExpired:
        run.kill()
        run.wait()


def _until(condition: Callable[[], bool], patience: float) -> bool:
    """Wait until something is the case; return whether it is."""
    deadline = time.monotonic() + patience
    while not condition():
        if time.monotonic() > deadline:
            return False
        time.sleep(LOOK)
    return True
