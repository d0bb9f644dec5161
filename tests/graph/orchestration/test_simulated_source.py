"""A lost tick is published again, and the end is reached only when the simulator has served it."""

import math
from typing import Any

from sonar_tracking.graph.orchestration.data_source import RESEND_SECONDS
from sonar_tracking.graph.orchestration.flow_ledger import FlowLedger
from sonar_tracking.graph.orchestration.simulated_source import SimulatedSource
from sonar_tracking.graph.orchestration.time_master import TimeMaster
from tests.graph.orchestration.quiet_desk import quiet_desk

START = 1_767_225_600_000_000_000
BLOCK = 100_000_000


class Control:
    """Takes the ticks, in place of the ROS side."""

    def __init__(self) -> None:
        self.served: int | None = None
        self.ticks: list[int] = []

    def publish_clock(self, stamp: int) -> None:
        self.ticks.append(stamp)


def source(control: Control, blocks: int) -> SimulatedSource:
    master = TimeMaster(START, START + blocks * BLOCK, BLOCK, 4, math.inf)
    ros_side: Any = control
    return SimulatedSource(ros_side, FlowLedger({}, {}), master, START, quiet_desk())


def test_a_lost_tick_is_told_again() -> None:
    control = Control()
    clock = source(control, 2)
    clock.advance(0.0)
    control.served = START
    end = START + 2 * BLOCK
    clock.advance(0.0)
    clock.advance(0.9 * RESEND_SECONDS)
    assert control.ticks == [START, end]
    clock.advance(1.1 * RESEND_SECONDS)
    assert control.ticks == [START, end, end]
    clock.advance(1.2 * RESEND_SECONDS)
    assert control.ticks == [START, end, end]


def test_the_end_is_when_everything_was_served() -> None:
    control = Control()
    clock = source(control, 2)
    clock.advance(0.0)
    control.served = START
    clock.advance(0.0)
    assert control.ticks[-1] == START + 2 * BLOCK
    finished = [clock.finished]
    control.served = START + 2 * BLOCK
    finished.append(clock.finished)
    assert finished == [False, True]
    assert clock.data_seconds == 0.2
    # Nothing is repeated at the end.
    clock.advance(100.0)
    assert len(control.ticks) == 2
