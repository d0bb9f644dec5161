"""Data from a simulator in the graph: it publishes whatever is due up to ``/clock``."""

from __future__ import annotations

from sonar_tracking.graph.orchestration.command_desk import CommandDesk
from sonar_tracking.graph.orchestration.control_node import ControlNode
from sonar_tracking.graph.orchestration.data_source import IDLE_SECONDS, RESEND_SECONDS
from sonar_tracking.graph.orchestration.flow_ledger import FlowLedger
from sonar_tracking.graph.orchestration.time_master import TimeMaster
from sonar_tracking.records.time import NANOSECONDS


class SimulatedSource:
    """Moves the clock of the graph as the time master decides.

    Parameters
    ----------
    control : ControlNode
        Publishes the clock.
    ledger : FlowLedger
        Knows what the nodes still have to do.
    master : TimeMaster
        Decides.
    start : int
        First instant of the clock, ns.
    desk : CommandDesk
        Of operators; the clock stands until all trackers have what they are told.
    """

    def __init__(
        self,
        control: ControlNode,
        ledger: FlowLedger,
        master: TimeMaster,
        start: int,
        desk: CommandDesk,
    ) -> None:
        self._control = control
        self._desk = desk
        self._ledger = ledger
        self._master = master
        self._start = start
        self._told = 0.0

    @property
    def finished(self) -> bool:
        """Whether the simulator has published everything."""
        clock, served = self._master.clock, self._control.served
        return self._master.at_end and served is not None and clock is not None and served >= clock

    @property
    def data_seconds(self) -> float:
        """Data time let go so far, s."""
        clock = self._master.clock
        return 0.0 if clock is None else (clock - self._start) / NANOSECONDS

    def advance(self, wall: float) -> float:
        """Move the clock if it may move."""
        if self._desk.holds(self._master.clock, wall):
            return IDLE_SECONDS
        served = self._control.served
        tick = self._master.next_tick(wall, served, self._ledger.largest_backlog())
        clock = self._master.clock
        lost = served is None or (clock is not None and served < clock)
        if tick is None and clock is not None and lost and wall - self._told > RESEND_SECONDS:
            tick = clock
        if tick is not None:
            self._told = wall
            self._control.publish_clock(tick)
        return self._master.wall_seconds_to_next(wall) or IDLE_SECONDS

    def behind(self, wall: float) -> float:
        """Return how much later than the rate asked for the data are, s of the wall clock."""
        return self._master.behind(wall)

    def resume(self, since: float, wall: float) -> None:
        """Go on after a pause from one wall time to another, which does not count."""
        self._master.resume(since, wall)
