"""Stamps decide order and resets; a wrong verdict would lose good data or mix two runs."""

from __future__ import annotations

import pytest

from sonar_tracking.graph.node_base.stamp_guard import StampGuard, Verdict
from sonar_tracking.records.time import END_OF_DATA

SECOND = 1_000_000_000
START = 1_000 * SECOND
BLOCK = SECOND // 10


@pytest.fixture
def guard() -> StampGuard:
    """Three contiguous blocks have been received."""
    guard = StampGuard("/array/snapshots", 10 * SECOND)
    for number in range(3):
        stamp = START + number * BLOCK
        assert guard.check(stamp, stamp + BLOCK, "array").verdict is Verdict.ACCEPT
    return guard


def test_contiguous_data_are_accepted_up_to_rounding(guard: StampGuard) -> None:
    stamp = START + 3 * BLOCK + 400
    assert guard.check(stamp, stamp + BLOCK, "array").verdict is Verdict.ACCEPT


@pytest.mark.parametrize("number", [0, 1, 2])
def test_what_was_received_before_is_a_duplicate(guard: StampGuard, number: int) -> None:
    stamp = START + number * BLOCK
    check = guard.check(stamp, stamp + BLOCK, "array")
    assert check.verdict is Verdict.DUPLICATE
    assert "already received" in check.sentence


def test_a_small_step_back_is_rejected_and_leaves_no_trace(guard: StampGuard) -> None:
    check = guard.check(START - SECOND, START, "array")
    assert check.verdict is Verdict.REJECT
    assert "1.200 s earlier" in check.sentence and "reset_after" in check.sentence
    stamp = START + 3 * BLOCK
    assert guard.check(stamp, stamp + BLOCK, "array").verdict is Verdict.ACCEPT


def test_a_large_step_back_begins_again(guard: StampGuard) -> None:
    early = START - 60 * SECOND
    check = guard.check(early, early + BLOCK, "other")
    assert check.verdict is Verdict.RESET
    assert "went back by 60.200 s" in check.sentence
    assert guard.check(early + BLOCK, 0, "other").verdict is Verdict.ACCEPT


def test_data_after_the_end_of_the_data_begin_again(guard: StampGuard) -> None:
    last = START + 3 * BLOCK
    guard.check(last, END_OF_DATA, "array")
    assert guard.check(last, END_OF_DATA, "array").verdict is Verdict.DUPLICATE
    assert guard.check(START, START + BLOCK, "array").verdict is Verdict.RESET


def test_a_gap_is_accepted_and_said(guard: StampGuard) -> None:
    stamp = START + 5 * BLOCK
    check = guard.check(stamp, stamp + BLOCK, "array")
    assert check.verdict is Verdict.GAP
    assert "0.200 s of data are missing" in check.sentence


def test_overlapping_data_are_rejected(guard: StampGuard) -> None:
    stamp = START + 2 * BLOCK + BLOCK // 2
    check = guard.check(stamp, stamp + BLOCK, "array")
    assert check.verdict is Verdict.REJECT
    assert "overlapping" in check.sentence


def test_another_sensor_is_rejected(guard: StampGuard) -> None:
    stamp = START + 3 * BLOCK
    check = guard.check(stamp, stamp + BLOCK, "towed")
    assert check.verdict is Verdict.REJECT
    assert "'towed'" in check.sentence and "'array'" in check.sentence


def test_unusable_stamps_are_rejected(guard: StampGuard) -> None:
    assert guard.check(0, 0, "array").verdict is Verdict.REJECT
    stamp = START + 3 * BLOCK
    assert guard.check(stamp, stamp - BLOCK, "array").verdict is Verdict.REJECT


def test_without_watermarks_only_order_counts() -> None:
    guard = StampGuard("/own_ship/odometry", 10 * SECOND)
    for stamp in (START, START + BLOCK, START + 7 * BLOCK):
        assert guard.check(stamp, 0, "").verdict is Verdict.ACCEPT
    assert guard.check(START + 2 * BLOCK, 0, "").verdict is Verdict.REJECT


def test_what_is_left_from_before_another_input_began_again_is_ignored() -> None:
    """Queues empty at their own pace: old data of one input must not reset the node again."""
    guard = StampGuard("/own_ship/odometry", 10 * SECOND)
    guard.check(100 * SECOND, 0, "")
    guard.expect_new_beginning(1 * SECOND)
    assert guard.check(101 * SECOND, 0, "").verdict is Verdict.DUPLICATE
    assert guard.check(1 * SECOND, 0, "").verdict is Verdict.ACCEPT
    assert guard.check(2 * SECOND, 0, "").verdict is Verdict.ACCEPT


def test_an_input_that_never_begins_again_is_used_in_the_end() -> None:
    guard = StampGuard("/own_ship/odometry", 10 * SECOND)
    guard.check(100 * SECOND, 0, "")
    guard.expect_new_beginning(1 * SECOND)
    verdicts = [guard.check((101 + n) * SECOND, 0, "").verdict for n in range(300)]
    assert verdicts[0] is Verdict.DUPLICATE
    assert verdicts[-1] is Verdict.ACCEPT


def test_a_late_message_of_slow_data_is_no_new_beginning() -> None:
    """Pings 10 s apart: one that comes three pings late is a duplicate, or rejected."""
    guard = StampGuard("contacts", 10 * SECOND)
    for number in range(20, 30):
        if number != 26:
            guard.check(number * 10 * SECOND, 0, "sonar")
    assert guard.check(250 * SECOND, 0, "sonar").verdict is Verdict.DUPLICATE
    assert guard.check(260 * SECOND, 0, "sonar").verdict is Verdict.REJECT
    assert guard.check(200 * SECOND, 0, "sonar").verdict is Verdict.RESET
