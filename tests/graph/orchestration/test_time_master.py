"""The clock moves with wall time and never runs away from the slowest consumer."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sonar_tracking.graph.orchestration.time_master import TimeMaster
from sonar_tracking.records.time import NANOSECONDS

START = 1_767_225_600 * NANOSECONDS
BLOCK = NANOSECONDS // 10
WINDOW = 4


def master(rate: float, blocks: int = 100) -> TimeMaster:
    return TimeMaster(START, START + blocks * BLOCK, BLOCK, WINDOW, rate)


def test_real_time_follows_the_wall() -> None:
    paced = master(1.0)
    assert paced.next_tick(50.0, None, 0) == START
    assert paced.next_tick(50.05, START, 0) is None
    assert math.isclose(paced.wall_seconds_to_next(50.05), 0.05, abs_tol=1e-6)
    assert paced.next_tick(50.1, START, 0) == START + BLOCK
    # A late call catches up with the wall.
    assert paced.next_tick(50.35, START + BLOCK, 0) == START + 3 * BLOCK


def test_a_factor_of_real_time() -> None:
    paced = master(5.0)
    paced.next_tick(0.0, None, 0)
    assert math.isclose(paced.wall_seconds_to_next(0.0), 0.02, abs_tol=1e-6)
    assert paced.next_tick(0.04, START, 0) == START + 2 * BLOCK


def test_full_speed_stops_at_the_flow_window() -> None:
    paced = master(math.inf)
    assert paced.next_tick(0.0, None, 0) == START
    assert paced.next_tick(0.0, START, 0) == START + WINDOW * BLOCK
    clock = START + WINDOW * BLOCK
    assert paced.next_tick(0.0, clock, WINDOW) is None
    # Half a window at a time: each tick is a message to all nodes.
    assert paced.next_tick(0.0, clock, WINDOW - 1) is None
    assert paced.next_tick(0.0, clock, WINDOW - 2) == clock + 2 * BLOCK


def test_full_speed_reaches_the_end_whatever_is_left_of_a_window() -> None:
    paced = master(math.inf, blocks=WINDOW + 1)
    clock: int | None = START
    while not paced.at_end:
        clock = paced.next_tick(0.0, clock, 0) or clock
    assert clock == START + (WINDOW + 1) * BLOCK


def test_blocks_the_source_has_not_served_count() -> None:
    paced = master(math.inf)
    paced.next_tick(0.0, None, 0)
    clock = paced.next_tick(0.0, START, 0)
    assert clock is not None
    assert paced.next_tick(0.0, START, 0) is None
    assert paced.next_tick(0.0, clock - BLOCK, 1) == clock + 2 * BLOCK


def test_a_pause_is_not_caught_up() -> None:
    paced = master(1.0)
    paced.next_tick(0.0, None, 0)
    clock = paced.next_tick(0.1, START, 0)
    assert clock is not None
    paced.resume(0.1, 60.0)
    assert paced.next_tick(60.05, clock, 0) is None
    assert paced.next_tick(60.1, clock, 0) == clock + BLOCK


def test_of_a_step_that_a_pause_divides_both_parts_count() -> None:
    paced = master(1.0)
    paced.next_tick(0.0, None, 0)
    paced.resume(0.07, 60.0)
    assert paced.next_tick(60.02, START, 0) is None
    assert paced.next_tick(60.03, START, 0) == START + BLOCK


@pytest.mark.slow
@given(
    rate=st.sampled_from([0.5, 1.0, 7.0, math.inf]),
    blocks=st.integers(1, 40),
    remainder=st.integers(0, BLOCK - 1),
    backlogs=st.lists(st.integers(0, 6), min_size=1, max_size=60),
)
def test_never_beyond_window_and_end_and_always_arrives(
    rate: float, blocks: int, remainder: int, backlogs: list[int]
) -> None:
    end = START + blocks * BLOCK + remainder
    paced = TimeMaster(START, end, BLOCK, WINDOW, rate)
    served = None
    wall = 0.0
    last = START
    for number in range(2000):
        wall += 0.07
        backlog = backlogs[number % len(backlogs)] if number < 300 else 0
        tick = paced.next_tick(wall, served, backlog)
        if tick is not None:
            assert last <= tick <= end
            if served is not None:
                assert tick - served <= max(0, WINDOW - backlog) * BLOCK
            last = tick
        served = paced.clock
    assert paced.at_end
    assert paced.clock == end


def test_a_clock_that_waits_for_a_consumer_is_behind() -> None:
    paced = master(2.0)
    assert paced.behind(0.0) == 0.0
    paced.next_tick(0.0, None, 0)
    assert paced.behind(0.05) == 0.0
    assert math.isclose(paced.behind(1.05), 1.0), "one step, of 0.05 s at this rate, is not due yet"
    assert paced.next_tick(1.05, START, WINDOW) is None
    paced.next_tick(1.05, START, 0)
    assert paced.behind(1.05) < 1.0
    late = paced.behind(1.05)
    paced.resume(1.05, 2.0)
    assert math.isclose(paced.behind(2.0), late, abs_tol=1e-9), "the pause itself is not late"
    assert master(math.inf).behind(100.0) == 0.0
