"""The orchestration: starts the nodes, lets data flow, restarts what dies, stops everything.

One object runs one graph, for a simulation as for a replay: they differ in their data source.
"""

from __future__ import annotations

import signal
import time
from collections import deque
from collections.abc import Callable, Collection
from functools import partial
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING

from sonar_tracking.display.run_display import RunDisplay
from sonar_tracking.display.track_table import GraphState
from sonar_tracking.errors import SonarTrackingError
from sonar_tracking.graph.catalogue.discovery_server import silence_in_words
from sonar_tracking.graph.catalogue.run_identity import CONTROL_NODE
from sonar_tracking.graph.catalogue.topics import TRUE_TRACKS
from sonar_tracking.graph.orchestration import reported_figures as figures
from sonar_tracking.graph.orchestration.clock_watch import ClockWatch
from sonar_tracking.graph.orchestration.data_source import DataSource, let_go
from sonar_tracking.graph.orchestration.graph_plan import GraphPlan
from sonar_tracking.graph.orchestration.process_supervisor import (
    ProcessSupervisor,
    SupervisedProcess,
)
from sonar_tracking.graph.orchestration.rate_watch import RateWatch
from sonar_tracking.graph.orchestration.restart_plan import restarted_display, restarted_process
from sonar_tracking.graph.orchestration.run_report import RunReport
from sonar_tracking.graph.orchestration.server_watch import ServerWatch
from sonar_tracking.graph.orchestration.stall_watch import StallWatch
from sonar_tracking.stop_signals import STOP_SIGNALS, note_stop, stop_code

if TYPE_CHECKING:
    from sonar_tracking.graph.orchestration.control_node import ControlNode
    from sonar_tracking.graph.orchestration.run_observer import RunObserver

RESTART_LIMIT = 3
START_PATIENCE = 60.0
DRAIN_PATIENCE = 10.0
INTERRUPTED_DRAIN_PATIENCE = 2.0
FOREIGN_PATIENCE = 3.0
DISPLAY_PATIENCE = 10.0
DISPLAY_SECONDS = 0.5
_RUNNING = "running"
_SHORTEST_WAIT, _LONGEST_WAIT, _WATCH_SECONDS = 0.0001, 0.05, 0.1


class RunFailedError(SonarTrackingError):
    """The run cannot go on."""


class Orchestration:
    """Runs one graph from the first process to the last.

    Parameters
    ----------
    plan : GraphPlan
        The graph.
    display : RunDisplay
        Where to show what happens.
    log_directory : Path
        Where the nodes' logs go.
    """

    def __init__(self, plan: GraphPlan, display: RunDisplay, log_directory: Path) -> None:
        self._plan = plan
        self._display = display
        self._log_directory = log_directory
        self._nodes = {node.name: node for node in plan.nodes}
        self._ended: deque[SupervisedProcess] = deque()
        self._stops = 0
        self._watched = 0.0
        self._flow_started: float | None = None
        self._flow_ended: float | None = None
        self._notices: dict[str, str] = {}
        self._errors: set[str] = set()
        self._clock_watch = ClockWatch()
        self.supervisor = ProcessSupervisor(log_directory)
        self.ledger = plan.ledger()
        self._stall_watch = StallWatch(self.ledger, log_directory)
        self._rate_watch = RateWatch(self.ledger, plan.sources)
        self._server_watch = ServerWatch()
        self.edges = plan.edges()
        self.failures: list[str] = []
        self.warnings: list[str] = [plan.transport.warning] if plan.transport.warning else []

    @property
    def interrupted(self) -> bool:
        """Whether the user has asked for the end."""
        return self._stops > 0

    @property
    def wall_seconds(self) -> float:
        """Wall time data have been flowing, s."""
        if self._flow_started is None:
            return 0.0
        return (self._flow_ended or time.monotonic()) - self._flow_started

    def start_processes(self) -> None:
        """Start every node; from here on stop signals are counted, and end the run in order."""
        for number in STOP_SIGNALS:
            signal.signal(number, self._stop_requested)
        for warning in self.warnings:
            self._display.say(f"warning: {warning}")
        for node in (*self._plan.nodes, *self._plan.displays):
            self.supervisor.start(self._plan.process(node, self._log_directory))

    def run(self, control: ControlNode, source: DataSource) -> None:
        """Wait until all nodes are matched, let the data flow, drain."""
        try:
            self._bring_up(control, source)
            if self.interrupted:
                return
            self._flow_started = time.monotonic()
            self._display.say(f"{len(self._nodes)} nodes are connected: data flow")
            self._flow(control, source)
            self._drain(control, source)
            self._take_notices(control)
        except RunFailedError as error:
            self._fail(str(error))
        finally:
            self._flow_ended = time.monotonic()

    def stop_processes(self) -> None:
        """Stop every node in bounded time; a second Ctrl-C kills them at once."""
        if not self.interrupted and any(node.publishers for node in self._plan.displays):
            time.sleep(DISPLAY_SECONDS)  # the last pictures are on their way into the recording
        names = self.supervisor.running()
        self.supervisor.stop(names, hurry=lambda: self._stops > 1)
        # Told to stop while it was starting, a node may end by the signal itself.
        asked = [name for name in names if name in self._nodes]
        for name in asked if self._flow_started is not None else ():
            process = self.supervisor.processes[name]
            if not process.has_done_its_work:
                self._fail(
                    f"{name} {process.end_in_words} when it was told to stop; "
                    f"its log is {process.log}."
                )

    def report(self, data_seconds: float, observer: RunObserver) -> RunReport:
        """Return what the run came to, after the processes were stopped."""
        processes = {name: self.supervisor.processes[name] for name in self._nodes}
        nodes = figures.node_reports(processes, self.ledger)
        silent = figures.silent_nodes(nodes, self._nodes, data_seconds, self.ledger.rejecting())
        return RunReport(
            scenario=self._plan.scenario,
            data_seconds=data_seconds,
            wall_seconds=self.wall_seconds,
            nodes=nodes,
            topics=figures.topic_reports(observer.records, processes),
            latency_ms=figures.latency_figures(observer.latency, observer.fused_latency),
            score=observer.score(),
            failures=[*self.failures, *silent] if not self.interrupted else self.failures,
            warnings=[*self.warnings, *self._notices.values()],
            interrupted=self.interrupted,
            stop_code=stop_code() if self.interrupted else 0,
            namespace=self._plan.naming.namespace,
            true_positions=self._plan.naming.of(TRUE_TRACKS),
        )

    def _stop_requested(self, number: int, frame: FrameType | None) -> None:
        self._stops += 1
        note_stop(number)

    def _flow(self, control: ControlNode, source: DataSource) -> None:
        while not self.interrupted:
            wall = time.monotonic()
            wait = let_go(source)
            if source.finished and self.ledger.largest_backlog() == 0:
                late = self._rate_watch.failure(source.behind(wall), self.wall_seconds)
                return self._fail(late) if late else None
            control.spin_until_news(min(max(wait, _SHORTEST_WAIT), _LONGEST_WAIT))
            self._watch(control, source, _RUNNING)
            if self._ended:
                self._recover(control, source)

    def _drain(self, control: ControlNode, source: DataSource) -> None:
        """Let the nodes finish what was published."""
        patience = INTERRUPTED_DRAIN_PATIENCE if self.interrupted else DRAIN_PATIENCE
        self._wait(control, source, self._finished, patience, "ending")
        if self.interrupted:
            return
        for missed in self.ledger.lost():
            self._fail(f"{missed.node} has missed {missed.messages} messages of {missed.topic}.")

    def _finished(self) -> bool:
        return self.ledger.largest_backlog() == 0

    def _recover(self, control: ControlNode, source: DataSource) -> None:
        """Start again what has died while no data flow."""
        since = time.monotonic()
        for process in self._ended:
            self.ledger.leave(process.plan.name)
        activity = "waiting for the nodes to finish"
        self._wait(control, source, self._finished, INTERRUPTED_DRAIN_PATIENCE, activity)
        self._bring_up(control, source)
        source.resume(since, time.monotonic())

    def _bring_up(self, control: ControlNode, source: DataSource) -> None:
        """Start what has ended until every node runs and is matched."""
        restarted: set[str] = set()
        self._server_watch.begin(time.monotonic())
        if self._flow_started is None:
            # Until it says what it hears, a display would pass for one that data wait for.
            shown = partial(self._displays_connected, control)
            self._wait(control, source, shown, DISPLAY_PATIENCE, "starting")
        deadline = time.monotonic() + START_PATIENCE
        asked = {*self._nodes, CONTROL_NODE} if self._flow_started is None else restarted
        while not self.interrupted:
            while self._ended:
                process = self._ended.popleft()
                self._restart(process, control)
                restarted.add(process.plan.name)
            if self._connected(control, asked):
                break
            if time.monotonic() > deadline:
                missing = "; ".join(self.edges.missing(asked))
                raise RunFailedError(
                    f"the graph was not ready after {START_PATIENCE:.0f} s: {missing}."
                    f"{silence_in_words()}"
                )
            activity = ": ".join(["starting", *self.edges.missing(asked)[:1]])
            self._wait(
                control,
                source,
                lambda: bool(self._ended) or self._connected(control, asked),
                _WATCH_SECONDS,
                activity,
            )
        self._server_watch.end()
        if self._flow_started is None:
            self._refuse_foreign(control, source)
        for name in restarted:
            self.ledger.rejoin(name)

    def _restart(self, process: SupervisedProcess, control: ControlNode) -> None:
        name = process.plan.name
        words = f"{name} {process.end_in_words}"
        tail = self.supervisor.log_tail(name)
        self.ledger.leave(name)
        self.edges.forget(name)
        if tail:
            self._display.say(tail)
        if self._flow_started is None and process.exit_code is not None and process.exit_code >= 0:
            raise RunFailedError(f"{words} while it was starting; its log is {process.log}.")
        if process.restarts >= RESTART_LIMIT:
            raise RunFailedError(
                f"{words} and was restarted {RESTART_LIMIT} times before; its log is {process.log}."
            )
        number = process.restarts + 1
        self._fail(f"{words}; it was started again ({number} of {RESTART_LIMIT}).")
        known = (self.ledger.absent, control.finished)
        self.supervisor.start(
            restarted_process(self._plan, name, self._log_directory, number, *known)
        )

    def _refuse_foreign(self, control: ControlNode, source: DataSource) -> None:
        """Refuse to start where somebody else publishes our topics."""
        # Nodes of a run that has just ended may be listed for a moment.
        alone = self._wait(control, source, control.alone, FOREIGN_PATIENCE, "starting")
        if not alone and not self.interrupted:
            raise RunFailedError(
                f"somebody else publishes too ({'; '.join(control.foreign())}): end it, or choose "
                "another ROS_DOMAIN_ID or --namespace for this run."
            )

    def _displays_connected(self, control: ControlNode) -> bool:
        """Tell whether what shows the data hears them, as far as it and all others run."""
        running = self.supervisor.running()
        displays = [name for name in self._plan.display_names() if name in running]
        return bool(self._ended) or self._connected(control, displays)

    def _connected(self, control: ControlNode, nodes: Collection[str]) -> bool:
        """Tell whether some nodes have found all others they need, and those have found them."""
        control.report_own()
        return not self.edges.missing(nodes)

    def _wait(
        self,
        control: ControlNode,
        source: DataSource,
        condition: Callable[[], bool],
        patience: float,
        activity: str,
    ) -> bool:
        """Handle events until a condition holds; return whether it does."""
        deadline = time.monotonic() + patience
        stops = self._stops
        while not condition():
            if time.monotonic() > deadline or self._stops > stops:
                return False
            control.spin_once(_LONGEST_WAIT)
            self._watch(control, source, activity)
        return True

    def _watch(self, control: ControlNode, source: DataSource, activity: str) -> None:
        """Look after processes, stalls and the display, a few times a second."""
        wall = time.monotonic()
        if wall - self._watched < _WATCH_SECONDS:
            return
        self._watched = wall
        for process in self.supervisor.poll():
            ours = process.plan.name in self._nodes
            (self._ended.append if ours else self._go_on_without)(process)
        if self._flow_started is not None:
            news = self._clock_watch.news(wall, control.other_clocks)
            control.notices.update((sentence, sentence) for sentence in news)
        self._take_notices(control)
        behind = source.behind(wall) if activity == _RUNNING else 0.0
        for sentence in (*self._stall_watch.news(wall), *self._rate_watch.news(behind)):
            self._display.say(sentence)
        for sentence in self._server_watch.news(wall):
            self._warn(sentence)
        if self._display.due(wall):
            backlog = self.ledger.largest_backlog()
            state = GraphState(
                self._plan.scenario, source.data_seconds, self.wall_seconds, backlog, activity
            )
            self._display.show(state, wall)

    def _go_on_without(self, process: SupervisedProcess) -> None:
        """Tell that a display has ended; what people look at from outside comes back."""
        self.edges.forget(process.plan.name)
        again, words = restarted_display(self._plan, process, self._log_directory)
        self._warn(f"{words}; its log is {process.log}.")
        if again is not None:
            self.supervisor.start(again)

    def _warn(self, text: str) -> None:
        self.warnings.append(text)
        self._display.say(f"warning: {text}")

    def _take_notices(self, control: ControlNode) -> None:
        """Show what the nodes have said for the first time; errors of their own are failures."""
        for status, sentence in control.notices.items():
            if status not in self._notices:
                self._display.say(sentence)
            self._notices[status] = sentence
        for status in sorted(control.errors.keys() - self._errors):
            self._errors.add(status)
            self._fail(control.errors[status])

    def _fail(self, sentence: str) -> None:
        self.failures.append(sentence)
        self._display.say(f"failed: {sentence}")
