"""Reports of progress are the messages they stand for, byte for byte."""

import pytest
from builtin_interfaces.msg import Time
from rclpy.serialization import deserialize_message, serialize_message
from sonar_tracking_msgs.msg import Progress

from sonar_tracking.errors import InputError
from sonar_tracking.graph.message_writing.field_writing import time_from_stamp
from sonar_tracking.graph.message_writing.progress_writing import ProgressWriter
from sonar_tracking.message_reading.field_reading import stamp_from_time
from sonar_tracking.message_reading.progress_reading import ProgressReport, progress_from_bytes

STAMP = 1_767_225_600_123_456_789
NAMES = [("recorder", "/clock"), ("a@0123456789abcdef", "/array/snapshots"), ("", "/é")]


@pytest.mark.parametrize("trailing", range(8))
@pytest.mark.parametrize(("node", "topic"), NAMES)
def test_what_is_written_is_what_ros_reads_and_we_read(
    node: str, topic: str, trailing: int
) -> None:
    topic += "x" * trailing
    data = ProgressWriter(node, topic).message(2**40 + 7, STAMP)
    message = deserialize_message(data, Progress)
    expected = Progress(node=node, topic=topic, count=2**40 + 7)
    expected.header.stamp = time_from_stamp(STAMP)
    assert message == expected
    assert progress_from_bytes(data) == ProgressReport(node, topic, 2**40 + 7, STAMP)


@pytest.mark.parametrize("frame", ["", "a", "abcd", "abcdefg"])
def test_what_ros_writes_is_read(frame: str) -> None:
    message = Progress(node="recorder", topic="/clock", count=3)
    message.header.frame_id = frame
    message.header.stamp = time_from_stamp(STAMP)
    report = progress_from_bytes(serialize_message(message))
    assert report == ProgressReport("recorder", "/clock", 3, STAMP)


def test_what_is_cut_short_or_garbled_is_refused() -> None:
    data = ProgressWriter("recorder", "/clock").message(3, STAMP)
    for length in range(len(data)):
        with pytest.raises(InputError, match="Progress"):
            progress_from_bytes(data[:length])
    with pytest.raises(InputError, match="Progress"):
        progress_from_bytes(data[:28] + b"\xff\xff\xff\x7f" + data[32:])


@pytest.mark.parametrize("seconds", [-(10**9), -(2**31), -1, 0])
def test_a_malformed_time_before_the_first_second_can_be_reported(seconds: int) -> None:
    """A node ended by it, too."""
    stamp = stamp_from_time(Time(sec=seconds, nanosec=7))
    data = ProgressWriter("recorder", "/clock").message(1, stamp)
    assert deserialize_message(data, Progress).header.stamp == Time(sec=seconds, nanosec=7)
    assert progress_from_bytes(data).stamp == stamp


@pytest.mark.parametrize("nanosec", [10**9 - 1, 10**9, 2**32 - 1])
def test_a_malformed_time_after_the_last_second_can_be_reported(nanosec: int) -> None:
    """A node ended by it: its seconds, once carried over, did not fit into a message."""
    last = stamp_from_time(Time(sec=2**31 - 1, nanosec=nanosec))
    data = ProgressWriter("recorder", "/clock").message(1, last)
    assert deserialize_message(data, Progress).header.stamp == Time(
        sec=2**31 - 1, nanosec=10**9 - 1
    )
