"""The datum of ``map`` in a live graph, kept for whoever comes later.

Who has it from a receiver tells it; a recording has it in its scenario, a run in its parameters.
"""

from __future__ import annotations

from collections.abc import Callable

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import NavSatFix

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.catalogue.topics import DATUM_TOPIC
from sonar_tracking.message_reading.datum_reading import datum_from_message
from sonar_tracking.records.datum import Datum
from sonar_tracking.records.positions import MAP_FRAME

_KEPT = QoSProfile(
    depth=1,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
)


class DatumTeller:
    """Tells the datum once it is known.

    Parameters
    ----------
    node : Node
        That publishes it.
    """

    def __init__(self, node: Node) -> None:
        self._publisher = node.create_publisher(NavSatFix, DATUM_TOPIC, _KEPT)
        self._told: Datum | None = None

    def tell(self, datum: Datum | None) -> None:
        """Publish a datum, unless there is none or it has been told already."""
        if datum is None or datum == self._told:
            return
        self._told = datum
        message = NavSatFix(
            latitude=datum.latitude_deg, longitude=datum.longitude_deg, altitude=datum.height
        )
        message.header.frame_id = MAP_FRAME
        self._publisher.publish(message)


def listen_to_datum(node: Node, take: Callable[[Datum], None]) -> None:
    """Let a node be told the datum, now or later; one that cannot be is ignored.

    Parameters
    ----------
    node : Node
        That wants to know it.
    take : callable
        Called with it.
    """

    def read(message: NavSatFix) -> None:
        try:
            take(datum_from_message(message, DATUM_TOPIC))
        except ConfigurationError as error:
            node.get_logger().warning(f"{error}")

    node.create_subscription(NavSatFix, DATUM_TOPIC, read, _KEPT)
