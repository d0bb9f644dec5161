"""What every node still has to do: the bookkeeping behind flow control.

Producers announce how many messages of a topic they have published, consumers report how many
they have finished (message ``Progress`` on ``flow/done``). The difference is the backlog the time
master keeps small. Pure counting, no ROS.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Backlog:
    """Messages of one topic that one consumer has not finished.

    Attributes
    ----------
    node, topic : str
        The consumer and what it consumes.
    messages : int
        Messages announced by the producer and not yet finished.
    """

    node: str
    topic: str
    messages: int


class FlowLedger:
    """Counts of published and finished messages for every edge of the graph.

    Counts in the reports start at zero whenever their node starts; the ledger carries on.

    Parameters
    ----------
    consumers : mapping of str to tuple of str
        Topic to the nodes that consume it.
    producers : mapping of str to str
        Topic to the one node that publishes it.
    """

    def __init__(
        self, consumers: Mapping[str, tuple[str, ...]], producers: Mapping[str, str]
    ) -> None:
        self._producers = dict(producers)
        self._published = dict.fromkeys(consumers, 0)
        self._published_before = dict.fromkeys(consumers, 0)
        edges = [(node, topic) for topic, nodes in consumers.items() for node in nodes]
        self._finished = dict.fromkeys(edges, 0)
        self._finished_before = dict.fromkeys(edges, 0)
        self._rejecting: set[tuple[str, str]] = set()
        self._written_off = dict.fromkeys(edges, 0)
        self._absent: set[str] = set()
        self.changes = 0

    def producer(self, topic: str) -> str | None:
        """Return the node that publishes a topic, None if the topic is not counted."""
        return self._producers.get(topic)

    @property
    def absent(self) -> frozenset[str]:
        """Nodes that have died and are not counted."""
        return frozenset(self._absent)

    def published(self, node: str, topic: str, count: int) -> None:
        """Note that a producer has published, or is about to publish, message number ``count``."""
        if topic not in self._published or node in self._absent:
            return
        total = self._published_before[topic] + count
        if total > self._published[topic]:
            self._published[topic] = total
            self.changes += 1

    def finished(self, node: str, topic: str, count: int) -> bool:
        """Note that a consumer has finished message number ``count``; return whether it is all."""
        edge = (node, topic)
        if edge not in self._finished or node in self._absent:
            return False
        total = self._finished_before[edge] + count
        if total > self._finished[edge]:
            self._finished[edge] = total
            self.changes += 1
        return total == self._published[topic] - self._written_off[edge]

    def backlogs(self) -> list[Backlog]:
        """Return what living nodes still have to finish, the largest first."""
        behind = []
        for (node, topic), finished in self._finished.items():
            messages = self._published[topic] - finished - self._written_off[node, topic]
            if messages > 0 and node not in self._absent:
                behind.append(Backlog(node, topic, messages))
        return sorted(behind, key=lambda item: (-item.messages, item.node, item.topic))

    def largest_backlog(self) -> int:
        """Return the largest backlog of any living node, messages."""
        largest = 0
        for edge, finished in self._finished.items():
            messages = self._published[edge[1]] - finished - self._written_off[edge]
            if messages > largest and edge[0] not in self._absent:
                largest = messages
        return largest

    def is_behind(self, topic: str) -> bool:
        """Return whether a living node has not finished all messages of a topic."""
        return any(each.topic == topic for each in self.backlogs())

    def leave(self, node: str) -> None:
        """Stop counting a node that has died."""
        self._absent.add(node)

    def rejoin(self, node: str) -> None:
        """Count a restarted node again, from zero; what it missed is written off."""
        self._absent.discard(node)
        for topic, producer in self._producers.items():
            if producer == node and topic in self._published:
                self._published_before[topic] = self._published[topic]
        for edge in self._finished:
            if edge[0] == node:
                self._finished_before[edge] = self._finished[edge]
            if node in (edge[0], self._producers.get(edge[1])):
                self._written_off[edge] = self._published[edge[1]] - self._finished[edge]

    def write_off(self, backlog: Backlog) -> None:
        """Wait no longer for messages that were lost on the way."""
        self._written_off[backlog.node, backlog.topic] += backlog.messages

    def note_input(self, node: str, topic: str, received: int, rejected: int) -> None:
        """Take what a node says of one of its inputs: how many messages it got and rejected."""
        if 0 < received == rejected:
            self._rejecting.add((node, topic))
        else:
            self._rejecting.discard((node, topic))

    def rejecting(self) -> set[str]:
        """Return the nodes that have rejected all messages of one of their inputs so far."""
        return {node for node, _ in self._rejecting}

    def messages_in(self, node: str) -> int:
        """Return how many messages a node has finished."""
        return sum(count for (name, _), count in self._finished.items() if name == node)

    def messages_out(self, node: str) -> int:
        """Return how many messages a node has published."""
        return sum(
            self._published[topic]
            for topic, producer in self._producers.items()
            if producer == node and topic in self._published
        )

    def published_messages(self, topic: str) -> int:
        """Return how many messages of a topic were published."""
        return self._published.get(topic, 0)

    def lost(self) -> list[Backlog]:
        """Return what was written off or never finished, for the summary."""
        missing = []
        for (node, topic), finished in self._finished.items():
            messages = self._published[topic] - finished
            if messages > 0:
                missing.append(Backlog(node, topic, messages))
        return missing
