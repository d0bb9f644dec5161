"""Whether every node of the graph has found its neighbours, so that data may flow.

A publisher drops what it sends before its readers are matched. Every node therefore reports, on
``/diagnostics``, how many remote endpoints each of its topics is matched with, and how many it has
ever found of each neighbour by name. The first includes strangers and the dead; the second grows
when a new process has been found, which is what data wait for after a restart. No ROS here.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Mapping

Partners = Mapping[str, Mapping[str, tuple[str, ...]]]
"""Node, resolved topic, nodes at the other end."""


class MatchedEdges:
    """Compares what the nodes report with what the graph needs.

    Parameters
    ----------
    subscriptions : mapping of str to mapping of str to tuple of str
        Node, resolved topic, nodes that publish it.
    publishers : mapping of str to mapping of str to tuple of str
        Node, resolved topic, nodes that have to hear it.
    visitors : collection of str, optional
        Nodes among the first that nobody waits for: where they say that they hear a topic, its
        publisher must have found them.
    """

    def __init__(
        self,
        subscriptions: Partners,
        publishers: Partners,
        visitors: Collection[str] = (),
    ) -> None:
        self._subscriptions = subscriptions
        self._publishers = publishers
        self._visitors = visitors
        self._matched: dict[str, Mapping[str, int]] = {}
        self._found: dict[str, dict[tuple[str, str], int]] = defaultdict(dict)
        self._gone: dict[str, dict[tuple[str, str], int]] = defaultdict(dict)

    def report(self, node: str, matched: Mapping[str, int]) -> None:
        """Take a node's report: resolved topic to matched remote endpoints."""
        self._matched[node] = matched

    def report_found(self, node: str, found: Mapping[tuple[str, str], int]) -> None:
        """Take a node's report: resolved topic and neighbour to endpoints ever found."""
        self._found[node] = dict(found)

    def forget(self, node: str) -> None:
        """Forget what a node has reported, and that others have found it: it has ended."""
        for reports in (self._matched, self._found, self._gone):
            reports.pop(node, None)
        for other, found in self._found.items():
            gone = {edge: count for edge, count in found.items() if edge[1] == node}
            self._gone[other].update(gone)

    def missing(self, nodes: Collection[str] | None = None) -> list[str]:
        """Return what is still missing, one phrase an item; empty when data may flow.

        Parameters
        ----------
        nodes : collection of str, optional
            Ask for what these have found, and for who has to find them, only; default: for all.
        """
        everybody = {*self._subscriptions, *self._publishers}
        asked = everybody if nodes is None else set(nodes)
        phrases = []
        for node in sorted(everybody - set(self._visitors) | asked):
            if node not in asked:
                phrases.extend(self._not_found(node, asked))
            elif node not in self._matched:
                phrases.append(f"{node} has not reported")
            else:
                phrases.extend(self._unmatched(node) or self._not_found(node, None))
        return phrases

    def foreign_publishers(self) -> list[str]:
        """Return the topics on which somebody else publishes too."""
        return sorted(
            {
                topic
                for node, topics in self._subscriptions.items()
                for topic, partners in topics.items()
                if self._matched.get(node, {}).get(topic, 0) > len(partners)
            }
        )

    def _unmatched(self, node: str) -> list[str]:
        matched = self._matched[node]
        return [
            f"{node} has {matched.get(topic, 0)} of {len(partners)} connections on {topic}"
            for topic, partners in sorted(self._partners(node).items())
            if matched.get(topic, 0) < len(partners)
        ]

    def _not_found(self, node: str, wanted: Collection[str] | None) -> list[str]:
        found, gone = self._found[node], self._gone[node]
        return [
            f"{node} has not found {partner} on {topic}"
            for topic, partners in sorted(self._partners(node).items())
            for partner in partners
            if (wanted is None or partner in wanted)
            and found.get((topic, partner), 0) <= gone.get((topic, partner), 0)
        ]

    def _partners(self, node: str) -> dict[str, tuple[str, ...]]:
        """Return who has to be at the other end of each topic of a node."""
        heard = {
            topic: (*partners, *self._hearing(node, topic))
            for topic, partners in self._publishers.get(node, {}).items()
        }
        return heard | dict(self._subscriptions.get(node, {}))

    def _hearing(self, node: str, topic: str) -> list[str]:
        """Return the nodes that nobody waits for, and that say they have found a publisher."""
        return [
            visitor
            for visitor in self._visitors
            if node in self._subscriptions.get(visitor, {}).get(topic, ())
            and self._found[visitor].get((topic, node), 0)
            > self._gone[visitor].get((topic, node), 0)
        ]
