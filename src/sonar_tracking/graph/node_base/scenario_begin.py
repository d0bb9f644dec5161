"""When a scenario begins without simulation time: at one instant for all its simulators.

The node ``world_simulator`` decides, when somebody listens to the data of any sensor, and tells it
on ``flow/begin``, where it stays for whoever comes later. Were every simulator to begin by itself,
own ship would be seconds away from the stamps of the data.
"""

from __future__ import annotations

from collections.abc import Sequence

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sonar_tracking_msgs.msg import Progress

from sonar_tracking.graph.catalogue.topics import BEGIN_TOPIC, CLOCK_TOPIC
from sonar_tracking.graph.message_writing.field_writing import time_from_stamp
from sonar_tracking.message_reading.field_reading import stamp_from_time

_KEPT = QoSProfile(
    depth=1,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
)


class BeginTeller:
    """Decides when the scenario begins, and tells it.

    Parameters
    ----------
    node : Node
        That publishes it.
    topics : sequence of str
        It begins when one of them has a listener.
    """

    def __init__(self, node: Node, topics: Sequence[str]) -> None:
        self._node = node
        self._topics = [node.resolve_topic_name(topic) for topic in topics]
        self._publisher = node.create_publisher(Progress, BEGIN_TOPIC, _KEPT)

    def told(self, now: int) -> int | None:
        """Return the begin if it is now, ns, after it was told; None = nobody listens yet."""
        if not any(map(self._node.count_subscribers, self._topics)):
            return None
        told = Progress(node=self._node.get_name(), topic=CLOCK_TOPIC)
        told.header.stamp = time_from_stamp(now)
        self._publisher.publish(told)
        return now


class BeginListener:
    """Knows when the scenario has begun.

    Parameters
    ----------
    node : Node
        That wants to know it.
    """

    def __init__(self, node: Node) -> None:
        self.stamp: int | None = None
        """When the scenario began, ns; None = not known yet."""
        node.create_subscription(Progress, BEGIN_TOPIC, self._take, _KEPT)

    def _take(self, told: Progress) -> None:
        self.stamp = stamp_from_time(told.header.stamp)
