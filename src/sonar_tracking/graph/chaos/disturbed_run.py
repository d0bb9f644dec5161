"""One run of a scenario that suffers faults, and what came of it."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from sonar_tracking.graph.catalogue.topics import Topic
from sonar_tracking.graph.chaos.fault_plan import ENDS_THE_RUN, Fault, FaultKind
from sonar_tracking.graph.chaos.track_watch import TrackWatch

RECOVERY = 5.0
"""By then valid lists are to come again, s of the wall clock."""

STALL = 20.0
"""Without any list that long a run has stalled, s."""

PATIENCE = 90.0
"""Longest wait for a run to begin or to end, s."""

ORPHAN_PATIENCE = 10.0
"""By then all nodes of a killed run have ended, s."""


@dataclass
class Outcome:
    """What came of one fault.

    Attributes
    ----------
    fault : Fault
        What happened.
    recovered_s : float or None
        Until a list again confirmed a track, s; None = it did not, or none was confirmed before.
    identities_kept : bool or None
        Whether all tracks confirmed before are confirmed after it; None = there were none.
    stalled, orphans, traceback : bool
        Whether the run stood still, left processes behind, or printed a traceback.
    exit_code : int or None
        Of the run that it ended.
    """

    fault: Fault
    recovered_s: float | None = None
    identities_kept: bool | None = None
    stalled: bool = False
    orphans: bool = False
    traceback: bool = False
    exit_code: int | None = None


@dataclass
class DisturbedRun:
    """A run as a process of its own, in the domain of this one.

    Attributes
    ----------
    scenario, rate : str
        As typed.
    folder : Path
        Where its bag and output go.
    tracks : Topic
        Lists of tracks that are watched.
    inputs : sequence of Topic
        Inputs of nodes.
    """

    scenario: str
    rate: str
    folder: Path
    tracks: Topic
    inputs: Sequence[Topic]
    outcomes: list[Outcome] = field(default_factory=list)

    def suffer(self, faults: Sequence[Fault]) -> list[Outcome]:
        """Start the run, let the faults happen, end it and return what came of each."""
        self.folder.mkdir(parents=True, exist_ok=True)
        log = self.folder / "output.txt"
        arguments = ["run", self.scenario, "--rate", self.rate, "--no-display"]
        arguments += ["--record", str(self.folder / "bag")]
        arguments += ["--json", str(self.folder / "report.json")]
        with log.open("w") as output:
            run = subprocess.Popen(
                [sys.executable, "-m", "sonar_tracking", *arguments],
                stdout=output,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
        try:
            if faults[0].kind in ENDS_THE_RUN:
                self._end_by(run, faults[0])
            else:
                self._disturb(run, faults, log)
        finally:
            if run.poll() is None:
                os.kill(run.pid, signal.SIGINT)
                _ended(run)
        text = log.read_text(errors="replace")
        for outcome in self.outcomes:
            outcome.traceback = "Traceback" in text
            outcome.orphans |= bool(_orphans(run.pid))
        return self.outcomes

    def _end_by(self, run: subprocess.Popen[bytes], fault: Fault) -> None:
        time.sleep(fault.seconds)
        killed = fault.kind is FaultKind.ORCHESTRATION
        os.kill(run.pid, signal.SIGKILL if killed else signal.SIGINT)
        _ended(run)
        deadline = time.monotonic() + ORPHAN_PATIENCE
        while _orphans(run.pid) and time.monotonic() < deadline:
            time.sleep(0.1)
        self.outcomes.append(Outcome(fault, exit_code=run.returncode))

    def _disturb(self, run: subprocess.Popen[bytes], faults: Sequence[Fault], log: Path) -> None:
        deadline = time.monotonic() + PATIENCE
        while "data flow" not in log.read_text(errors="replace"):
            if run.poll() is not None or time.monotonic() > deadline:
                self.outcomes += [Outcome(fault, stalled=True) for fault in faults[:1]]
                return
            time.sleep(0.05)
        begin = time.monotonic()
        watch = TrackWatch(self.tracks, self.inputs)
        try:
            for fault in faults:
                watch.spin(max(0.0, begin + fault.seconds - time.monotonic()))
                if run.poll() is not None:
                    return
                self.outcomes.append(self._one(run, fault, watch))
        finally:
            watch.close()

    @staticmethod
    def _one(run: subprocess.Popen[bytes], fault: Fault, watch: TrackWatch) -> Outcome:
        before, count, at = watch.confirmed(), len(watch.lists), time.monotonic()
        if fault.kind is FaultKind.MALFORMED:
            watch.send_malformed(fault.target, fault.seed)
            count, at = len(watch.lists), time.monotonic()
        else:
            _signal_node(run.pid, fault, watch)
        outcome = Outcome(fault)
        while time.monotonic() < at + STALL and run.poll() is None:
            watch.spin(0.05)
            valid = [when for when, names in watch.lists[count:] if names or not before]
            if valid:
                outcome.recovered_s = valid[0] - at
                break
        watch.spin(1.0)
        outcome.stalled = len(watch.lists) == count and run.poll() is None
        if before and outcome.recovered_s is not None:
            outcome.identities_kept = before <= watch.confirmed()
        return outcome


def as_plain(outcome: Outcome) -> dict[str, Any]:
    """Return an outcome as JSON takes it."""
    values = asdict(outcome)
    values["fault"]["kind"] = outcome.fault.kind.value
    return values


def _signal_node(run: int, fault: Fault, watch: TrackWatch) -> None:
    for process in _children(run, fault.target):
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


def _children(run: int, node: str) -> list[int]:
    """Return the processes of a node of a run."""
    return [
        process
        for process, (parent, _, arguments) in _processes().items()
        if parent == run and f"sonar_tracking.graph.nodes.{node}\0" in arguments
    ]


def _orphans(run: int) -> list[int]:
    """Return the nodes of a session that is over."""
    return [
        process
        for process, (_, session, arguments) in _processes().items()
        if session == run and "sonar_tracking.graph.nodes." in arguments
    ]


def _processes() -> dict[int, tuple[int, int, str]]:
    """Return parent, session and command line of every process."""
    found = {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text().rpartition(")")[2].split()
            arguments = (stat.parent / "cmdline").read_bytes().decode(errors="replace")
        except OSError:
            continue
        if fields[0] != "Z":
            found[int(stat.parent.name)] = (int(fields[1]), int(fields[3]), arguments)
    return found
