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
from sonar_tracking.graph.catalogue.topics import COMMANDS, Topic
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
    published: set[str] = set()
    for node in _known_nodes(scenario):
        if _wanted(node, scenario, published):
            topics = {topic.name for topic in node.published(scenario.namespaces)}
            _refuse_doubled(node, topics & published, where)
            started.append(node)
            published |= topics
    _refuse_idle(scenario, started, published, where)
    return tuple(started)


def _known_nodes(scenario: Scenario) -> tuple[NodeDescription, ...]:
    """Return the nodes there may be, for own ship and for every station, in the order data flow."""
    stations = ("", *scenario.station_namespaces)
    return tuple(node.at_station(station) for node in NODES.values() for station in stations)


def _wanted(node: NodeDescription, scenario: Scenario, published: set[str]) -> bool:
    """Return whether a node is started, by what the nodes before it publish."""
    if node.is_live:
        return False
    if node.section:
        return node.section in scenario.simulated_in(node.station)
    if node.is_display:
        return not node.on_request and _is_shown(node, published)
    asked = not node.on_request or node.name in scenario.nodes
    return asked and not _missing(node, published)


def _refuse_idle(
    scenario: Scenario, started: list[NodeDescription], published: set[str], where: str
) -> None:
    """Refuse a scenario that names a node which is not started."""
    known = {node.name: node for node in _known_nodes(scenario)}
    for name in scenario.nodes:
        node_asked = known.get(name)
        if node_asked is not None and node_asked.is_live:
            raise ConfigurationError(
                f"{where}: nodes: {name} takes what others send while they send it, which the "
                f"clock of a run cannot wait for; start it beside trackers of live data: ros2 run "
                f"sonar_tracking {name}."
            )
        if node_asked is not None and node_asked not in started:
            reason = _missing(node_asked, published)
            raise ConfigurationError(
                f"{where}: nodes: {name} has nothing to do in this scenario: "
                + (
                    f"nothing publishes {', '.join(sorted(reason))}; leave it out or add the "
                    "sensor."
                    if reason
                    else f"it simulates the section {node_asked.section}, which is not given."
                )
            )


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
    nodes = tuple(descriptions)
    names = {topic.name for node in nodes for topic in node.published(namespaces or {})}
    return tuple(_planned(node, settings[node.name], namespaces or {}, names) for node in nodes)


def with_published_topics(
    descriptions: Iterable[NodeDescription],
    given: Mapping[str, Mapping[str, Any]],
    namespaces: Mapping[str, tuple[str, ...]],
) -> dict[str, dict[str, Any]]:
    """Return parameters in which every list of topics that was not given names what is published.

    Of several nodes of one kind, a topic belongs to that of the nearest station.

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
    published = [topic.name for node in nodes for topic in node.published(namespaces)]
    filled = {name: dict(values) for name, values in given.items()}
    for node in nodes:
        for parameter, topic in node.topic_parameters.items():
            names = tuple(
                name for name in published if _is_kind(name, topic) and _belongs(name, node, nodes)
            )
            filled.setdefault(node.name, {}).setdefault(parameter, names or (NO_TOPIC,))
    return filled


def _belongs(name: str, node: NodeDescription, nodes: Iterable[NodeDescription]) -> bool:
    """Return whether a listed topic is for a node, rather than for another one of its kind."""
    if node.is_display:
        return not node.station
    near = [one.station for one in nodes if one.kind == node.kind and _is_of(name, one.station)]
    return node.station == max(near, key=len, default=None)


def _is_of(name: str, station: str) -> bool:
    return not station or name.startswith(f"{station}/")


def _planned(
    node: NodeDescription,
    parameters: Mapping[str, Any],
    namespaces: Mapping[str, tuple[str, ...]],
    published: set[str],
) -> PlannedNode:
    listed = [
        replace(topic, name=name)
        for parameter, topic in node.topic_parameters.items()
        for name in parameters[parameter]
        if name != NO_TOPIC
    ]
    # What another graph publishes, the data of this one do not wait for.
    listed += [
        replace(topic, name=name)
        for parameter, topic in node.named_inputs.items()
        for name in parameters[parameter]
        if name in published
    ]
    commands = () if node.commanded_topic is None else (COMMANDS,)
    return PlannedNode(
        name=node.name,
        module=node.module,
        subscriptions=(*node.inputs, *node.optional_inputs, *listed, *commands),
        publishers=node.published(namespaces),
        parameters=parameters,
        gives_identifiers="first_id" in parameters,
        needs_clock=not node.is_display,
    )


def _refuse_doubled(node: NodeDescription, doubled: set[str], where: str) -> None:
    if not doubled:
        return
    remedy = f"give the section {node.section} a scenario of its own"
    if node.station_outputs:
        remedy = f"give every station under {node.section} a namespace, e.g. station_2"
    raise ConfigurationError(
        f"{where}: {node.name} would publish {', '.join(sorted(doubled))} a second time; {remedy}."
    )


def _is_kind(name: str, topic: Topic) -> bool:
    return name == topic.name or name.endswith(f"/{topic.name}")


def _is_shown(node: NodeDescription, published: set[str]) -> bool:
    """Return whether one of the inputs of a display is there."""
    heard = {topic.name for topic in (*node.inputs, *node.optional_inputs)}
    listed = () if node.station else node.topic_parameters.values()
    return bool(heard & published) or any(_of_kind(topic, "", published) for topic in listed)


def _missing(node: NodeDescription, published: set[str]) -> set[str]:
    """Return the inputs nobody publishes; of a list of topics one of the kind is enough."""
    missing = {topic.name for topic in node.inputs} - published
    for topic in list(node.topic_parameters.values())[:1]:
        if not _of_kind(topic, node.station, published):
            missing.add(topic.name)
    return missing


def _of_kind(topic: Topic, station: str, published: set[str]) -> bool:
    return any(_is_kind(name, topic) and _is_of(name, station) for name in published)
