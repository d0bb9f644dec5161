"""Names of a graph's topics and nodes in ROS: below a namespace, and by rules (no ROS import).

Inside the project a topic has one name, ``active/contacts``. In a graph below ``/shipA`` it is
``/shipA/active/contacts``, unless a rule gives it another name. ``/clock`` is below the namespace,
too: whoever paces a graph has its own time, so that two of them can run in one ROS domain.
"""

from __future__ import annotations

import difflib
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from sonar_tracking.bags.contents.topic_names import typed_namespace, typed_rules
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.catalogue.planned_node import PlannedNode
from sonar_tracking.graph.catalogue.topics import CLOCK_TOPIC, FIXED_TRANSFORMS, TRANSFORMS, Topic

_ADVICE = (
    "give the name of a topic in the graph and the one it shall have, "
    "e.g. active/contacts:=/sonar/contacts"
)


_ABSOLUTE = {topic.name for topic in (TRANSFORMS, FIXED_TRANSFORMS)}
"""Topics that no namespace goes before."""


@dataclass(frozen=True)
class GraphNames:
    """Names of one graph.

    Attributes
    ----------
    namespace : str
        Of nodes and topics, e.g. ``"/shipA"``; empty = the root.
    remaps : mapping of str to str
        Full name below the namespace to the full name that a topic has instead.
    """

    namespace: str = ""
    remaps: Mapping[str, str] = field(default_factory=dict)

    @property
    def clock(self) -> str:
        """Full name of the topic that tells the time of the graph."""
        return self.namespace + CLOCK_TOPIC

    def of(self, topic: Topic | str) -> str:
        """Return the full name of a topic."""
        full = self._below(topic if isinstance(topic, str) else topic.name)
        return self.remaps.get(full, full)

    def of_node(self, name: str) -> str:
        """Return the full name of a node."""
        return f"{self.namespace}/{name}"

    def topics(self, topics: Iterable[Topic]) -> tuple[Topic, ...]:
        """Return topics with their full names."""
        return tuple(replace(topic, name=self.of(topic)) for topic in topics)

    def planned(self, nodes: Iterable[PlannedNode]) -> tuple[PlannedNode, ...]:
        """Return nodes with the full names of their topics, and the rules that make them so."""
        return tuple(
            replace(
                node,
                subscriptions=self.topics(node.subscriptions),
                publishers=self.topics(node.publishers),
                remaps=self.remaps,
            )
            for node in nodes
        )

    def noted(self, topics: Iterable[Topic]) -> dict[str, str]:
        """Return what a recording notes: full name to the name in the root, where they differ.

        Parameters
        ----------
        topics : iterable of Topic
            As inside the project.
        """
        names = {self.of(topic): GraphNames().of(topic) for topic in topics}
        names[self.clock] = CLOCK_TOPIC
        return {name: root for name, root in names.items() if name != root}

    def check(self, topics: Collection[Topic]) -> None:
        """Refuse rules that name no topic of a graph, or give two topics one name.

        Raises
        ------
        ConfigurationError
            If that is so.
        """
        known = {self._below(topic.name) for topic in topics}
        for old in self.remaps:
            if old not in known:
                near = difflib.get_close_matches(old, sorted(known), n=1)
                hint = f"did you mean {near[0]}?" if near else f"it has {', '.join(sorted(known))}."
                raise ConfigurationError(f"--remap: the graph has no topic {old}; {hint}")
        first: dict[str, str] = {self.clock: self.clock}
        for old in sorted(known):
            new = self.remaps.get(old, old)
            if first.setdefault(new, old) != old:
                raise ConfigurationError(
                    f"--remap: {first[new]} and {old} would both be called {new}; give one of "
                    "them another name."
                )

    def _below(self, name: str) -> str:
        return name if name.startswith("/") else f"{self.namespace}/{name}"


def graph_names(remaps: Sequence[str], namespace: str) -> GraphNames:
    """Return the names a person has asked for.

    Parameters
    ----------
    remaps : sequence of str
        Each ``OLD:=NEW``: a topic as the reference calls it, with or without a slash before it, and
        its new name; without a slash before it that is below the namespace.
    namespace : str
        With or without slashes around it; empty = none.

    Raises
    ------
    ConfigurationError
        If a rule has another form, a topic has two rules, or a name is none.
    """
    below = typed_namespace(namespace)
    names = GraphNames(f"/{below}" if below else "")
    rules: dict[str, str] = {}
    for old, new in typed_rules(remaps, _ADVICE):
        full = f"/{old.strip('/')}"
        if full not in _ABSOLUTE and not full.startswith(f"{names.namespace}/"):
            full = names.namespace + full
        if full in rules:
            raise ConfigurationError(f"--remap: {full} is given twice; give one name.")
        rules[full] = new if new.startswith("/") else f"{names.namespace}/{new}"
    return replace(names, remaps=rules)


ROOT_NAMES = GraphNames()
"""Of a graph in the root namespace."""
