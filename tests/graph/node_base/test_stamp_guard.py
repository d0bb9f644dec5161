"""Stamps decide order and resets; a wrong verdict would lose good data or mix two runs."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count, islice

import pytest

from sonar_tracking.graph.node_base.stamp_check import Verdict
from sonar_tracking.graph.node_base.stamp_guard import StampGuard
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


def test_a_small_step_back_is_set_aside_and_leaves_no_trace(guard: StampGuard) -> None:
    check = guard.check(START - SECOND, START, "array")
    assert check.verdict is Verdict.HOLD
    assert "1.200 s earlier" in check.sentence and "reset_after" in check.sentence
    stamp = START + 3 * BLOCK
    check = guard.check(stamp, stamp + BLOCK, "array")
    assert (check.verdict, check.confirms, check.dropped) == (Verdict.ACCEPT, False, 1)


def test_data_that_go_on_after_a_large_step_back_begin_again(guard: StampGuard) -> None:
    early = START - 60 * SECOND
    checks = [guard.check(early + n * BLOCK, 0, "other") for n in range(4)]
    verdicts = [check.verdict for check in checks]
    assert verdicts == [Verdict.HOLD, Verdict.HOLD, Verdict.RESET, Verdict.ACCEPT]
    assert "went back by 60.200 s" in checks[2].sentence
    assert checks[2].confirms and not checks[3].dropped


def test_data_after_the_end_of_the_data_begin_again(guard: StampGuard) -> None:
    last = START + 3 * BLOCK
    guard.check(last, END_OF_DATA, "array")
    assert guard.check(last, END_OF_DATA, "array").verdict is Verdict.DUPLICATE
    assert guard.check(START, START + BLOCK, "array").verdict is Verdict.HOLD
    assert guard.check(START + BLOCK, START + 2 * BLOCK, "array").verdict is Verdict.RESET


def test_data_that_go_on_after_their_announced_end_are_used(guard: StampGuard) -> None:
    last = START + 3 * BLOCK
    guard.check(last, END_OF_DATA, "array")
    check = guard.check(last + BLOCK, last + 2 * BLOCK, "array")
    assert check.verdict is Verdict.ACCEPT
    assert "they go on" in check.sentence


def test_a_gap_is_accepted_and_said(guard: StampGuard) -> None:
    stamp = START + 4 * BLOCK
    check = guard.check(stamp, stamp + BLOCK, "array")
    assert check.verdict is Verdict.GAP
    assert "0.100 s of data are missing" in check.sentence


def test_a_long_gap_is_believed_when_the_data_go_on_behind_it(guard: StampGuard) -> None:
    stamp = START + 60 * SECOND
    assert guard.check(stamp, stamp + BLOCK, "array").verdict is Verdict.HOLD
    check = guard.check(stamp + BLOCK, stamp + 2 * BLOCK, "array")
    assert (check.verdict, check.confirms) == (Verdict.GAP, True)
    assert "59.700 s of data are missing" in check.sentence


def test_the_last_message_after_a_gap_is_not_lost(guard: StampGuard) -> None:
    assert guard.check(START + 5 * SECOND, END_OF_DATA, "array").verdict is Verdict.GAP


def test_a_second_publisher_of_overlapping_data_never_gets_in(guard: StampGuard) -> None:
    for number in range(3, 40):
        stamp = START + number * BLOCK
        assert guard.check(stamp, stamp + BLOCK, "array").verdict is Verdict.ACCEPT
        check = guard.check(stamp + BLOCK // 2, stamp + 3 * BLOCK // 2, "array")
        assert check.verdict is Verdict.HOLD
        assert "overlapping" in check.sentence


def test_another_sensor_gets_in_when_the_first_has_been_silent_for_long(guard: StampGuard) -> None:
    for number in range(3, 40):
        stamp = START + number * BLOCK
        assert guard.check(stamp, stamp + BLOCK, "array").verdict is Verdict.ACCEPT
        check = guard.check(stamp + 1, stamp + BLOCK + 1, "towed")
        assert check.verdict is Verdict.HOLD
        assert "'towed'" in check.sentence and "'array'" in check.sentence
    verdicts = [guard.check(stamp + n * BLOCK, 0, "towed").verdict for n in range(1, 130)]
    assert verdicts.count(Verdict.RESET) == 1
    assert set(verdicts[:99]) == {Verdict.HOLD}
    assert verdicts[-1] is Verdict.ACCEPT


def test_a_new_beginning_is_seen_though_every_message_comes_twice(guard: StampGuard) -> None:
    early = START - 60 * SECOND
    checks = [guard.check(early + n // 2 * BLOCK, 0, "array") for n in range(8)]
    used = [check.verdict for check in checks if check.verdict is not Verdict.DUPLICATE]
    assert used == [Verdict.HOLD, Verdict.HOLD, Verdict.RESET, Verdict.ACCEPT]


def test_a_new_beginning_of_two_messages_that_ends_is_used(guard: StampGuard) -> None:
    early = START - 60 * SECOND
    assert guard.check(early, early + BLOCK, "array").verdict is Verdict.HOLD
    assert guard.check(early + BLOCK, END_OF_DATA, "array").verdict is Verdict.RESET


def test_an_input_that_has_begun_already_goes_on() -> None:
    """Odometry that begins with a new run of pings is not of the old one."""
    guard = StampGuard("/own_ship/odometry", 10 * SECOND)
    guard.check(START, 0, "")
    guard.expect_new_beginning(START + SECOND)
    assert guard.check(START + SECOND, 0, "").verdict is Verdict.ACCEPT


def test_what_was_set_aside_can_be_judged_once_more(guard: StampGuard) -> None:
    """An input that has begun already keeps its data, and its outlier is no duplicate of itself."""
    outlier = START + 60 * SECOND, 0, "array"
    assert guard.check(*outlier).verdict is Verdict.HOLD
    guard.expect_new_beginning(START)
    assert guard.check(*outlier).verdict is Verdict.HOLD
    stamp = START + 3 * BLOCK
    assert guard.check(stamp, stamp + BLOCK, "array").dropped == 1


def good_messages(watermarks: bool) -> Iterator[tuple[int, int, str]]:
    """Return stamps, watermarks and sensor of a stream, one message after the other."""
    for stamp in count(START, BLOCK):
        yield stamp, (stamp + BLOCK) * watermarks, "array" * watermarks


HOSTILE = {
    "watermark of another month": lambda good: (good, good + 1_000_000 * SECOND, "array"),
    "watermark a little later": lambda good: (good, good + SECOND, "array"),
    "end of the data": lambda good: (good, END_OF_DATA, "array"),
    "first second, other sensor": lambda good: (SECOND, 0, "nobody"),
    "other sensor": lambda good: (good + 1, good + BLOCK + 1, "nobody"),
    "soon": lambda good: (good + 9 * SECOND, 0, "array"),
    "soon, with a watermark": lambda good: (good + 9 * SECOND, good + 10 * SECOND, "array"),
    "a block early": lambda good: (good + BLOCK, 0, "array"),
    "two blocks early": lambda good: (good + 2 * BLOCK, 0, "array"),
    "two early, with a watermark": lambda good: (good + 2 * BLOCK, good + 3 * BLOCK, "array"),
    "next, with a late watermark": lambda good: (good + BLOCK, good + 12 * BLOCK, "array"),
    "in thirty years": lambda good: (good + 1_000_000_000 * SECOND, 0, "array"),
    "at the end of time": lambda good: (good + 99 * SECOND, END_OF_DATA, "array"),
    "before": lambda good: (good - 2 * SECOND, 0, "array"),
    "long before": lambda good: (good - 1000 * SECOND, 0, "array"),
}


@pytest.mark.parametrize("watermarks", [True, False])
@pytest.mark.parametrize("before", [0, 1, 2, 3, 30])
@pytest.mark.parametrize("attack", list(HOSTILE))
@pytest.mark.parametrize("usable", [True, False])
def test_one_message_never_makes_an_input_deaf(
    attack: str, before: int, watermarks: bool, usable: bool
) -> None:
    """After any single message, wherever it comes, the third good one is used with all before."""
    guard = StampGuard("/array/snapshots", 10 * SECOND)
    stream = good_messages(watermarks)
    for message in islice(stream, before):
        guard.check(*message)
    stamp, next_stamp, sensor_id = HOSTILE[attack](START + before * BLOCK)
    guard.check(stamp, next_stamp, sensor_id if watermarks else "", usable=usable)
    good = list(islice(stream, 5))
    checks = [guard.check(*message) for message in good]
    used = {Verdict.ACCEPT, Verdict.GAP, Verdict.RESET}
    # The malformed one may stand for one of the good ones, if it has the same stamp.
    third = 3 if good[2][0] == stamp else 2
    assert all(check.verdict in used for check in checks[third:]), checks
    if before >= 3:
        assert all(check.verdict is not Verdict.RESET for check in checks), checks


def test_unusable_stamps_are_rejected(guard: StampGuard) -> None:
    assert guard.check(0, 0, "array").verdict is Verdict.REJECT
    stamp = START + 3 * BLOCK
    assert guard.check(stamp, stamp - BLOCK, "array").verdict is Verdict.REJECT


def test_without_watermarks_only_order_counts() -> None:
    guard = StampGuard("/own_ship/odometry", 10 * SECOND)
    for stamp in (START, START + BLOCK, START + 3 * BLOCK):
        assert guard.check(stamp, 0, "").verdict is Verdict.ACCEPT
    assert guard.check(START + 2 * BLOCK, 0, "").verdict is Verdict.HOLD
    assert guard.check(START + 4 * BLOCK, 0, "").dropped == 1


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
    """Pings 10 s apart: one that comes three pings late is a duplicate, or dropped."""
    guard = StampGuard("contacts", 10 * SECOND)
    for number in range(20, 30):
        if number != 26:
            guard.check(number * 10 * SECOND, 0, "sonar")
    assert guard.check(250 * SECOND, 0, "sonar").verdict is Verdict.DUPLICATE
    assert guard.check(260 * SECOND, 0, "sonar").verdict is Verdict.HOLD
    assert guard.check(300 * SECOND, 0, "sonar").dropped == 1
    checks = [guard.check((200 + 10 * number) * SECOND, 0, "sonar") for number in range(3)]
    assert checks[-1].verdict is Verdict.RESET
