"""Players publish in log order: log times must be physical and never step back in a topic."""

from __future__ import annotations

from sonar_tracking.bags.contents.log_time import LogClock, begins_with_header, head_stamp
from sonar_tracking.bags.contents.message_definitions import installed_definition
from tests.bags.bag_fixtures import (
    CLOCK,
    EPOCH,
    SECOND,
    SNAPSHOTS,
    TRACKS,
    clock_cdr,
    snapshots_cdr,
)

EMPTY_SEQUENCE = b"\x00\x01\x00\x00" + bytes(4)


def test_the_log_time_is_the_stamp_of_the_header() -> None:
    clock = LogClock(frozenset({SNAPSHOTS}))
    time = clock.log_time("/array/snapshots", SNAPSHOTS, snapshots_cdr(4, 250_000_000))
    assert time == (EPOCH + 4) * SECOND + 250_000_000


def test_a_message_without_header_has_the_time_of_the_last_clock() -> None:
    clock = LogClock(frozenset({SNAPSHOTS}))
    assert clock.log_time("/clock", CLOCK, clock_cdr(9)) == (EPOCH + 9) * SECOND
    assert (
        clock.log_time("/name", "std_msgs/msg/String", b"\x00\x01\x00\x00\x01\x00\x00\x00\x00")
        == (EPOCH + 9) * SECOND
    )


def test_a_sequence_of_headed_messages_has_the_stamp_of_its_first() -> None:
    """Pictures and transforms; an empty one has no time of its own."""
    clock = LogClock(frozenset())
    kinds = ("tf2_msgs/msg/TFMessage", "visualization_msgs/msg/MarkerArray")
    assert [clock.log_time(kind, kind, EMPTY_SEQUENCE) for kind in kinds] == [0, 0]
    clock.log_time("/clock", CLOCK, clock_cdr(9))
    one = b"\x00\x01\x00\x00\x01\x00\x00\x00" + clock_cdr(7)[4:] + bytes(40)
    assert [clock.log_time(kind, kind, one) for kind in kinds] == [(EPOCH + 7) * SECOND] * 2
    assert clock.log_time("/tf", kinds[0], EMPTY_SEQUENCE) == (EPOCH + 9) * SECOND


def test_a_stamp_that_steps_back_keeps_its_place_in_its_own_topic_only() -> None:
    clock = LogClock(frozenset({SNAPSHOTS}))
    times = [clock.log_time("/a", SNAPSHOTS, snapshots_cdr(second)) for second in (5, 3, 6)]
    assert times == [(EPOCH + second) * SECOND for second in (5, 5, 6)]
    assert clock.log_time("/b", SNAPSHOTS, snapshots_cdr(3)) == (EPOCH + 3) * SECOND


def test_negative_and_missing_stamps_count_as_none() -> None:
    assert head_stamp(b"\x00\x01\x00\x00" + b"\xf0\xff\xff\xff" + bytes(4)) == 0
    assert head_stamp(b"\x00\x01\x00\x00\x01") == 0


def test_headed_types_are_told_from_their_definition() -> None:
    assert begins_with_header(installed_definition(TRACKS).text)
    assert begins_with_header(installed_definition("nav_msgs/msg/Odometry").text)
    assert not begins_with_header(installed_definition(CLOCK).text)
    assert not begins_with_header(installed_definition("std_msgs/msg/String").text)
