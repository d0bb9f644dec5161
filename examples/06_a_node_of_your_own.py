"""A node of one's own in the middle of the graph: a higher detection threshold before the tracker.

The node takes the contacts of a sonar and passes the strong ones on under another name, which the
tracker is told to take. Checks of stamps, diagnostics and flow control are those of every node; its
parameters would be a frozen dataclass among the ``configurations`` of its description. Here all
share one process; ``run_node(RaisedThreshold)`` gives the node one of its own.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import rclpy
from sonar_tracking_msgs.msg import Contacts, Tracks

from sonar_tracking.active import with_raised_threshold
from sonar_tracking.graph import CONTACTS, HpdaTracker, JoinedItem, NodeDescription, SonarNode
from sonar_tracking.graph.message_writing import contacts_to_message
from sonar_tracking.message_reading import contacts_from_message, position_tracks_from_message
from sonar_tracking.simulation import ActiveSonarSimulation, load_scenario

FALSE_ALARM_PROBABILITY = 1e-3  # per cell; that of the sonar is 3e-3
STRONG = replace(CONTACTS, name="strong/contacts", description="contacts above a threshold")


class RaisedThreshold(SonarNode):
    """Passes the contacts above a threshold on."""

    def __init__(self) -> None:
        super().__init__(NodeDescription("raised_threshold"))
        self._strong = self.data_publisher(STRONG)
        self.data_subscriptions({CONTACTS: contacts_from_message})

    def process(self, item: JoinedItem, records: Mapping[str, Any]) -> None:
        """Publish the contacts of one ping that are strong enough."""
        strong = with_raised_threshold(records[CONTACTS.name], FALSE_ALARM_PROBABILITY)
        self._strong.publish(contacts_to_message(strong))


if __name__ == "__main__":
    rclpy.init(args=["--ros-args", "-r", f"hpda_tracker:{CONTACTS.name}:={STRONG.name}"])
    sonar, executor = rclpy.create_node("sonar"), rclpy.get_global_executor()
    publisher = sonar.create_publisher(Contacts, CONTACTS.name, 10)
    strong, lists = list[Contacts](), list[Tracks]()
    sonar.create_subscription(Contacts, STRONG.name, strong.append, 10)
    sonar.create_subscription(Tracks, "active/tracks", lists.append, 10)
    for node in (sonar, RaisedThreshold(), HpdaTracker()):
        executor.add_node(node)
    for number, ping in enumerate(ActiveSonarSimulation(load_scenario("active")), 1):
        publisher.publish(contacts_to_message(ping.contacts))
        while len(lists) < number or len(strong) < number:
            executor.spin_once()
        if number % 20 == 0:
            n_tracks = position_tracks_from_message(lists[-1]).established.sum()
            passed_on = f"{len(ping.contacts.range)} contacts, {len(strong[-1].range)} passed on"
            print(f"ping {number}: {passed_on}, {n_tracks} tracks")
    rclpy.shutdown()
