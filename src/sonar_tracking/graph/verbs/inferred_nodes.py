"""Which nodes take what is in a bag of somebody else's making (no ROS import)."""

from __future__ import annotations

from typing import Any

from sonar_tracking.bags.storage.reader import Bag
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.catalogue.active_nodes import HPDA_TRACKER
from sonar_tracking.graph.catalogue.passive_nodes import BEARING_TRACKER, SUBSPACE_ESTIMATOR
from sonar_tracking.graph.catalogue.tma_nodes import TMA_TRACKER
from sonar_tracking.graph.catalogue.topics import (
    BEARING_TRACKS,
    CONTACTS,
    FREQUENCY_LINES,
    SNAPSHOTS,
    Topic,
)


def inferred_nodes(bag: Bag) -> dict[str, dict[str, Any]]:
    """Return the nodes that take the types of messages in a bag, and what they need to be told.

    Contacts go to ``hpda_tracker``, snapshots to ``subspace_estimator`` and ``bearing_tracker``,
    bearings without the snapshots they are from, and frequency lines, to ``tma_tracker``.

    Returns
    -------
    dict
        Node name, parameter name, value.

    Raises
    ------
    ConfigurationError
        If no node takes anything.
    """
    nodes: dict[str, dict[str, Any]] = {}
    if recorded_topics(bag, SNAPSHOTS):
        nodes[SUBSPACE_ESTIMATOR.name] = {}
        nodes[BEARING_TRACKER.name] = {}
    elif bearings := recorded_topics(bag, BEARING_TRACKS):
        nodes[TMA_TRACKER.name] = {"bearing_topics": bearings}
        if lines := recorded_topics(bag, FREQUENCY_LINES):
            nodes[TMA_TRACKER.name]["line_topics"] = lines
    if recorded_topics(bag, CONTACTS):
        nodes[HPDA_TRACKER.name] = {}
    if not nodes:
        there = ", ".join(f"{topic.name} ({topic.type_name})" for topic in bag.topics.values())
        raise ConfigurationError(
            f"{bag.path} does not say with which nodes and parameters it was recorded, and holds "
            f"neither snapshots nor bearings nor contacts; its topics are {there}. Give "
            "--parameters FILE, e.g. with the line 'line_tracker: {}'."
        )
    return nodes


def recorded_topics(bag: Bag, kind: Topic) -> list[str]:
    """Return the names of the topics in a bag that carry messages of a kind, but for the truth."""
    return [
        name.lstrip("/")
        for name, topic in bag.topics.items()
        if topic.type_name == kind.message_type and topic.message_count and topic.role != "truth"
    ]
