"""Inputs and outputs of a node: they count, check stamps and report progress.

The progress protocol on ``flow/done``: a producer tells the number of messages it has published
before it tells that it has finished what they were made from; a consumer tells the number of
messages it has finished after it has published what followed from them. The time master keeps the
difference small; no data go this way.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

from builtin_interfaces.msg import Time
from rclpy.node import Node
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.serialization import deserialize_message, serialize_message

from sonar_tracking.bags.contents.log_time import head_stamp
from sonar_tracking.errors import InputError
from sonar_tracking.graph.catalogue.topics import Topic
from sonar_tracking.graph.message_writing.field_writing import message_class
from sonar_tracking.graph.node_base import quality_of_service
from sonar_tracking.graph.node_base.progress_reporter import ProgressReporter
from sonar_tracking.graph.node_base.stamp_check import StampCheck, Verdict, seconds_text
from sonar_tracking.graph.node_base.stamp_guard import StampGuard
from sonar_tracking.message_reading.field_reading import stamp_from_time
from sonar_tracking.message_reading.snapshot_bytes import SnapshotBytes
from sonar_tracking.records.time import UNKNOWN_STAMP


class DataOutput:
    """Publisher of one data topic.

    Parameters
    ----------
    node : Node
        The node.
    topic : Topic
        What to publish.
    depth : int
        Messages kept.
    progress : ProgressReporter
        Told of every message.
    overriding : QoSOverridingOptions or None
        Quality of service that parameters may change.
    """

    def __init__(
        self,
        node: Node,
        topic: Topic,
        depth: int,
        progress: ProgressReporter,
        overriding: QoSOverridingOptions | None = None,
    ) -> None:
        self.publisher = node.create_publisher(
            _used_class(topic.message_type),
            topic.name,
            quality_of_service.publisher_profile(topic.kind, depth),
            qos_overriding_options=overriding,
        )
        self.count = 0
        self.name: str = self.publisher.topic_name
        self.is_timed = False
        """Whether each message is announced before it is published, not with the next report."""
        self._progress = progress

    def publish(self, message: Any) -> None:
        """Announce and publish one message, or the bytes of one."""
        self.count += 1
        if isinstance(message, bytes):
            stamp = head_stamp(message)
        else:
            stamp = stamp_from_time(message.header.stamp)
        if self.is_timed:
            self._progress.announce_now(self.name, self.count, stamp)
        else:
            self._progress.announce(self.name, self.count, stamp)
        self.publisher.publish(message)


@dataclass(frozen=True)
class Received:
    """One message of an input on its way through the node.

    Attributes
    ----------
    source : DataInput
        Where it came from.
    stamp, next_stamp : int
        Of the message, ns.
    message : message
        As received; of one whose content is known already, its sensor.
    record : object or None
        What it carries; None = it could not be converted.
    rejection : str
        Why not; empty = it could.
    """

    source: DataInput
    stamp: int
    next_stamp: int
    message: Any
    record: Any
    rejection: str = ""

    @property
    def sensor_id(self) -> str:
        """Name of the sensor; messages of other packages, such as Odometry, have none."""
        return getattr(self.message, "sensor_id", "")


class DataInput:
    """Subscription of one data topic.

    Parameters
    ----------
    node : Node
        The node.
    topic : Topic
        What it is inside the node.
    name : str
        What to subscribe to: the topic of a station is below its namespace.
    depth : int
        Messages kept.
    reset_after : int
        See :class:`sonar_tracking.graph.node_base.stamp_guard.StampGuard`, ns.
    convert : callable
        Returns the record of a message, or raises InputError.
    receive : callable
        Called with this input and each message.
    progress : ProgressReporter
        Told of every finished message.
    overriding : QoSOverridingOptions or None
        Quality of service that parameters may change.
    answered : bool
        Whether each message is to give an output, one that cannot be read as well.
    """

    def __init__(
        self,
        node: Node,
        topic: Topic,
        name: str,
        depth: int,
        reset_after: int,
        convert: Callable[[Any], Any],
        receive: Callable[[DataInput, Any], None],
        progress: ProgressReporter,
        overriding: QoSOverridingOptions | None = None,
        answered: bool = True,
    ) -> None:
        self.topic = topic
        self._answered = answered
        self.received = self.rejected = self.duplicates = self.gaps = self.finished = 0
        self.period = 0
        self._held: list[Received] = []
        self._reset_after = reset_after
        self._convert = convert
        self._progress = progress
        self._class = _used_class(topic.message_type)
        self.subscription = node.create_subscription(
            self._class,
            name,
            lambda message: receive(self, message),
            quality_of_service.subscription_profile(depth),
            qos_overriding_options=overriding,
            raw=isinstance(convert, SnapshotBytes),
        )
        self.name: str = self.subscription.topic_name
        self.guard = StampGuard(self.name, reset_after)

    def judge(self, message: Any) -> tuple[StampCheck, tuple[Received, ...]]:
        """Count a message, read it, judge its stamps, and return what is to be used now, in order.

        Content goes first: what cannot be read does not move the time of the input.
        """
        self.received += 1
        return self._judge(self._read(message))

    def judge_held(self, begin: int) -> Iterator[tuple[StampCheck, tuple[Received, ...]]]:
        """Judge once more what was set aside, since another input has begun again at a stamp."""
        held, self._held = self._held, []
        for received in held:
            if abs(received.stamp - begin) <= self._reset_after:
                yield self._judge(received)
            else:
                self.rejected += 1

    def _judge(self, received: Received) -> tuple[StampCheck, tuple[Received, ...]]:
        stamp, before = received.stamp, self.guard.last_stamp
        if received.rejection and not self._answered:
            self.rejected += 1
            at = f"{self.name} at {seconds_text(stamp)}"
            return StampCheck(Verdict.REJECT, f"{at}: rejected: {received.rejection}"), ()
        check = self.guard.check(
            stamp,
            received.next_stamp,
            received.sensor_id,
            usable=not received.rejection,
        )
        self.rejected += check.dropped
        if check.verdict is Verdict.DUPLICATE:
            self.duplicates += 1
            return check, ()
        if check.verdict is Verdict.REJECT:
            self.rejected += 1
            return check, ()
        if check.verdict is Verdict.HOLD:
            self._held = [*([] if check.dropped else self._held), received]
            return check, ()
        held, self._held = self._held, []
        if check.verdict is Verdict.GAP:
            self.gaps += 1
        if check.verdict is Verdict.ACCEPT and before != UNKNOWN_STAMP:
            # Messages may come in pairs, as odometry does at both ends of a block.
            self.period = max(self.period, stamp - before)
        if check.next_stamp != received.next_stamp:
            received = _announcing(received, check.next_stamp)
        return check, (*held, received) if check.confirms else (received,)

    def _read(self, message: Any) -> Received:
        """Return a message with its record, or with the reason why it has none."""
        if isinstance(message, bytes):
            return self._read_bytes(message)
        stamp = stamp_from_time(message.header.stamp)
        # Messages of other packages have no watermark.
        next_stamp = stamp_from_time(getattr(message, "next_stamp", Time()))
        try:
            return Received(self, stamp, next_stamp, message, self._convert(message))
        except InputError as error:
            return Received(self, stamp, next_stamp, message, None, str(error))
        except Exception as error:
            # Values that nothing was made for, such as 1e300 m, end here: as bad input.
            reason = f"its values cannot be computed with ({type(error).__name__}: {error})"
            return Received(self, stamp, next_stamp, message, None, reason)

    def _read_bytes(self, data: bytes) -> Received:
        """Return a serialised message with its record; most of it may be known already."""
        known = self._convert.record(data) if isinstance(self._convert, SnapshotBytes) else None
        if known is not None:
            return Received(self, known.stamp, known.next_stamp, known.sensor, known)
        try:
            message = deserialize_message(data, self._class)
        except Exception as error:
            reason = f"its {len(data)} bytes are no such message ({error})"
            return Received(self, head_stamp(data), UNKNOWN_STAMP, data, None, reason)
        received = self._read(message)
        if isinstance(self._convert, SnapshotBytes) and not received.rejection:
            self._convert.learn(data, received.record)
        return received

    @staticmethod
    def read_stamp(message: Any) -> int:
        """Return the stamp of a message, ns."""
        if isinstance(message, bytes):
            return head_stamp(message)
        return stamp_from_time(message.header.stamp)

    def finish(self, stamp: int) -> None:
        """Count a message as finished and tell so."""
        self.finished += 1
        self._progress.finish(self.name, self.finished, stamp)

    def values(self) -> dict[str, object]:
        """Return the numbers of the status of this input."""
        return {
            "received": self.received,
            "rejected": self.rejected,
            "duplicates": self.duplicates,
            "gaps": self.gaps,
            "finished": self.finished,
            "last_stamp_ns": self.guard.last_stamp,
        }


def _used_class(message_type: str) -> Any:
    """Return the class of messages, once used: ROS loads at the first what it converts them with.

    That takes longer than an estimate, and would be done while the first data wait.
    """
    found = message_class(message_type)
    deserialize_message(serialize_message(found()), found)
    return found


def _announcing(received: Received, next_stamp: int) -> Received:
    """Return a message that announces another next stamp, as far as it can be read."""
    record = received.record
    if hasattr(record, "next_stamp"):
        record = replace(record, next_stamp=next_stamp)
    return replace(received, next_stamp=next_stamp, record=record)


def input_concern(source: DataInput) -> str:
    """Return the name of the status of an input."""
    return f"input {source.name}"


def any_needs(needs: Callable[[Any], bool]) -> Callable[[dict[str, Received]], bool]:
    """Return the same question about messages as they wait; an unusable one needs nothing."""

    def any_needs(items: dict[str, Received]) -> bool:
        try:
            return any(not one.rejection and needs(one.record) for one in items.values())
        except Exception:
            # What cannot even be asked need not wait: it is rejected when its turn comes.
            return False

    return any_needs
