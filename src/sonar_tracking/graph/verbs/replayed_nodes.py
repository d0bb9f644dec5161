"""Which nodes replay a recording, by the parameters that it holds (no ROS import)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from sonar_tracking.graph.catalogue.display_nodes import SCENE_PUBLISHER
from sonar_tracking.graph.catalogue.node_catalogue import NODES, described
from sonar_tracking.graph.catalogue.node_description import NodeDescription


def processing_nodes(given: Mapping[str, Mapping[str, Any]]) -> tuple[NodeDescription, ...]:
    """Return the nodes that compute something of what is recorded, in the order data flow.

    Parameters
    ----------
    given : mapping
        Node name, parameter name, value.
    """
    order = list(NODES)
    nodes = [
        node for node in _known(given) if not (node.section or node.is_live or node.is_display)
    ]
    return tuple(sorted(nodes, key=lambda node: order.index(node.kind)))


def scenes(given: Mapping[str, Mapping[str, Any]]) -> tuple[NodeDescription, ...]:
    """Return what shows own ship, and the stations that were shown when it was recorded.

    Parameters
    ----------
    given : mapping
        Node name, parameter name, value.
    """
    shown = [node for node in _known(given) if node.kind == SCENE_PUBLISHER.name]
    return (SCENE_PUBLISHER, *(node for node in shown if node.station))


def _known(given: Mapping[str, Mapping[str, Any]]) -> list[NodeDescription]:
    known = [described(name, values) for name, values in given.items()]
    return [node for node in known if node is not None]
