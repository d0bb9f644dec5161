"""Whom a node has found at the other end of its topics, by name and ever.

A number of matched endpoints does not tell whose they are: a stranger who listens passes for a
node that has to, and a process that was killed is counted until its lease ends, beside the one that
took its place. Every endpoint is therefore counted once, under the name of its node, and never
forgotten: the count of a neighbour grows exactly when a new process of it has been found.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable

from rclpy.node import Node
from rclpy.topic_endpoint_info import TopicEndpointInfo

_NAMELESS = "UNKNOWN"


class Neighbours:
    """Counts the endpoints of other nodes on the topics of one node.

    Parameters
    ----------
    node : Node
        The node.
    """

    def __init__(self, node: Node) -> None:
        self._node = node
        self._known: dict[tuple[str, str], set[bytes]] = defaultdict(set)
        self._glimpsed: set[bytes] = set()

    def look(self, topics: Iterable[str]) -> bool:
        """Count who is new on some topics; return whether the counts have changed.

        An endpoint counts at the second look that finds it: it is listed a moment before it is
        matched, and its node is named a moment after.
        """
        published = {publisher.topic_name for publisher in self._node.publishers}
        listed: set[bytes] = set()
        changed = False
        for topic in topics:
            for endpoint in self._others(topic, topic in published):
                gid = bytes(endpoint.endpoint_gid)
                listed.add(gid)
                known = self._known[topic, full_name(endpoint)]
                if gid in self._glimpsed and gid not in known:
                    known.add(gid)
                    changed = True
        self._glimpsed = listed
        return changed

    def values(self) -> dict[str, object]:
        """Return how many endpoints have been found, by topic and full name of the node."""
        return {
            f"{topic} {name.removeprefix('/')}": len(gids)
            for (topic, name), gids in self._known.items()
            if gids
        }

    def _others(self, topic: str, published: bool) -> list[TopicEndpointInfo]:
        ask = (
            self._node.get_subscriptions_info_by_topic
            if published
            else self._node.get_publishers_info_by_topic
        )
        return [each for each in ask(topic) if _NAMELESS not in each.node_name]


def full_name(endpoint: TopicEndpointInfo) -> str:
    """Return the name of the node of an endpoint with its namespace."""
    return f"{endpoint.node_namespace.rstrip('/')}/{endpoint.node_name}"
