"""Whether every node of the graph has found its neighbours, so that data may flow.

A publisher drops what it sends before its readers are matched. Every node therefore reports, on
``/diagnostics``, how many remote endpoints each of its topics is matched with. No ROS here.

A publisher does not know by whom it is heard: nodes that only show the data, and hear it already,
must not be counted for one that has to.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping


class MatchedEdges:
    """Compares the matches the nodes report with those the graph needs.

    Parameters
    ----------
    subscriptions : mapping of str to mapping of str to int
        Node, resolved topic, publishers it must see.
    publishers : mapping of str to mapping of str to int
        Node, resolved topic, subscriptions it must at least see.
    visitors : collection of str, optional
        Nodes among the first that nobody waits for: where they hear a topic, its publisher must
        see as many subscriptions more.
    """

    def __init__(
        self,
        subscriptions: Mapping[str, Mapping[str, int]],
        publishers: Mapping[str, Mapping[str, int]],
        visitors: Collection[str] = (),
    ) -> None:
        self._subscriptions = subscriptions
        self._publishers = publishers
        self._visitors = visitors
        self._matched: dict[str, Mapping[str, int]] = {}

    def report(self, node: str, matched: Mapping[str, int]) -> None:
        """Take a node's report: resolved topic to matched remote endpoints."""
        self._matched[node] = matched

    def forget(self, node: str) -> None:
        """Forget what a node has reported, because it has ended."""
        self._matched.pop(node, None)

    def visitors(self, topic: str) -> int:
        """Return how many nodes that nobody waits for say that they hear a topic."""
        return sum(
            topic in self._subscriptions[node] and self._matched.get(node, {}).get(topic, 0) > 0
            for node in self._visitors
        )

    def missing(self, nodes: Collection[str] | None = None) -> list[str]:
        """Return what is still missing, one phrase an item; empty when data may flow.

        Parameters
        ----------
        nodes : collection of str, optional
            Ask for these only; default: all.
        """
        phrases = []
        asked = {*self._subscriptions, *self._publishers} if nodes is None else set(nodes)
        for node in sorted(asked):
            matched = self._matched.get(node)
            if matched is None:
                phrases.append(f"{node} has not reported")
                continue
            heard = self._publishers.get(node, {})
            needed = {topic: count + self.visitors(topic) for topic, count in heard.items()}
            needed |= self._subscriptions.get(node, {})
            phrases.extend(
                f"{node} has {matched.get(topic, 0)} of {count} connections on {topic}"
                for topic, count in sorted(needed.items())
                if matched.get(topic, 0) < count
            )
        return phrases

    def foreign_publishers(self) -> list[str]:
        """Return the topics on which somebody else publishes too."""
        return sorted(
            {
                topic
                for node, topics in self._subscriptions.items()
                for topic, count in topics.items()
                if self._matched.get(node, {}).get(topic, 0) > count
            }
        )
