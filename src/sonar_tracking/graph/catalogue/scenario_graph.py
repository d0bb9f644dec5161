"""Which nodes a scenario needs, and which topics connect them (no ROS import)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.catalogue.node_catalogue import NODES
from sonar_tracking.graph.catalogue.node_description import NodeDescription
from sonar_tracking.graph.catalogue.node_settings import NodeSettings
from sonar_tracking.graph.catalogue.planned_node import PlannedNode
from sonar_tracking.graph.catalogue.topics import Topic, TopicRole
from sonar_tracking.simulation.scenarios.scenario import Scenario

NO_TOPIC = ""
"""Name in a list of topics that stands for none: ROS knows no empty list of texts."""


def started_nodes(scenario: Scenario, where: str) -> tuple[NodeDescription, ...]:
    """Return the nodes of a scenario in the order data flow.

    The sources are those of its sensors. Every other node follows if all its inputs are there,
    unless it has to be asked for under ``nodes``.

    Raises
    ------
    ConfigurationError
        If the scenario names a node that has nothing to listen to, or two sensors would both
        publish own ship and truth.
    """
    started: list[NodeDescription] = []
    available: set[str] = set()
    for node in NODES.values():
        if node.section:
            wanted = node.section in scenario.sensors
        elif node.is_display:
            wanted = bool(_heard(node) & available)
        else:
            asked = not node.on_request or node.name in scenario.nodes
            wanted = asked and not _missing(node, available)
        if wanted:
            topics = {topic.name for topic in (*node.outputs, *node.station_outputs)}
            _refuse_doubled(node, topics & available, where)
            started.append(node)
            available |= topics
    for name in scenario.nodes:
        node_asked = NODES.get(name)
        if node_asked is not None and node_asked not in started:
            reason = _missing(node_asked, available)
            raise ConfigurationError(
                f"{where}: nodes: {name} has nothing to do in this scenario: "
                + (
                    f"nothing publishes {', '.join(sorted(reason))}; leave it out or add the "
                    "sensor."
                    if reason
                    else f"it simulates the section {node_asked.section}, which is not given."
                )
            )
    return tuple(started)


def planned_nodes(
    descriptions: Iterable[NodeDescription],
    settings: NodeSettings,
    namespaces: Mapping[str, tuple[str, ...]] | None = None,
) -> tuple[PlannedNode, ...]:
    """Return nodes as they are to be started, with all their topics.

    Parameters
    ----------
    descriptions : iterable of NodeDescription
        The nodes.
    settings : mapping
        Every parameter of each of them.
    namespaces : mapping of str to tuple of str, optional
        Of the stations of a sensor, by its section; default: one station without a namespace.
    """
    return tuple(_planned(node, settings[node.name], namespaces or {}) for node in descriptions)


def with_published_topics(
    descriptions: Iterable[NodeDescription],
    given: Mapping[str, Mapping[str, Any]],
    namespaces: Mapping[str, tuple[str, ...]],
) -> dict[str, dict[str, Any]]:
    """Return parameters in which every list of topics that was not given names what is published.

    Parameters
    ----------
    descriptions : iterable of NodeDescription
        The nodes of the graph.
    given : mapping
        Node name, parameter name, value.
    namespaces : mapping of str to tuple of str
        Of the stations of a sensor, by its section.
    """
    nodes = tuple(descriptions)
    published = [topic.name for node in nodes for topic in _outputs(node, namespaces)]
    filled = {name: dict(values) for name, values in given.items()}
    for node in nodes:
        for parameter, topic in node.topic_parameters.items():
            names = tuple(name for name in published if _is_kind(name, topic))
            filled.setdefault(node.name, {}).setdefault(parameter, names or (NO_TOPIC,))
    return filled


def _planned(
    node: NodeDescription, parameters: Mapping[str, Any], namespaces: Mapping[str, tuple[str, ...]]
) -> PlannedNode:
    listed = [
        replace(topic, name=name)
        for parameter, topic in node.topic_parameters.items()
        for name in parameters[parameter]
        if name != NO_TOPIC
    ]
    return PlannedNode(
        name=node.name,
        module=node.module,
        subscriptions=(*node.inputs, *node.optional_inputs, *listed),
        publishers=_outputs(node, namespaces),
        parameters=parameters,
        gives_identifiers="first_id" in parameters,
        needs_clock=not node.is_display,
    )


def _outputs(node: NodeDescription, namespaces: Mapping[str, tuple[str, ...]]) -> tuple[Topic, ...]:
    stations = [
        replace(topic, name=f"{namespace}/{topic.name}" if namespace else topic.name)
        for namespace in namespaces.get(node.section, ("",))
        for topic in node.station_outputs
    ]
    topics = (*node.outputs, *stations)
    # What a sensor delivers is an input of the graph, even if another graph computes it; what is
    # computed is an output, even if another sensor delivers it.
    untrue = TopicRole.OUTPUT if node.section else TopicRole.INPUT
    role = TopicRole.INPUT if node.section else TopicRole.OUTPUT
    return tuple(replace(topic, role=role) if topic.role is untrue else topic for topic in topics)


def _refuse_doubled(node: NodeDescription, doubled: set[str], where: str) -> None:
    if doubled:
        raise ConfigurationError(
            f"{where}: {node.name} would publish {', '.join(sorted(doubled))} a second time; give "
            f"the section {node.section} a scenario of its own."
        )


def _is_kind(name: str, topic: Topic) -> bool:
    return name == topic.name or name.endswith(f"/{topic.name}")


def _heard(node: NodeDescription) -> set[str]:
    listed = node.topic_parameters.values()
    return {topic.name for topic in (*node.inputs, *node.optional_inputs, *listed)}


def _missing(node: NodeDescription, available: set[str]) -> set[str]:
    needed = {topic.name for topic in node.inputs}
    needed |= {topic.name for topic in list(node.topic_parameters.values())[:1]}
    return needed - available
