"""What is shown to people of a graph, and with which parameters (no ROS import)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

from sonar_tracking.graph.catalogue.active_nodes import HPDA_TRACKER
from sonar_tracking.graph.catalogue.display_nodes import SCENE_PUBLISHER
from sonar_tracking.graph.catalogue.nmea_nodes import NMEA_OUTPUT
from sonar_tracking.graph.catalogue.node_catalogue import description_of
from sonar_tracking.graph.catalogue.node_description import NodeDescription
from sonar_tracking.graph.catalogue.planned_node import PlannedNode
from sonar_tracking.graph.catalogue.tma_nodes import TMA_TRACKER
from sonar_tracking.graph.catalogue.topics import DIAGNOSTICS, Topic
from sonar_tracking.records.datum import Datum

_MOUNTINGS = {"sonar": HPDA_TRACKER.name, "array": TMA_TRACKER.name}
"""The trackers that are told where a sensor is on own ship, by what it is."""


def shown_topics(nodes: Iterable[NodeDescription]) -> tuple[Topic, ...]:
    """Return the topics of a graph that are for people: its pictures, and the state of the nodes.

    Parameters
    ----------
    nodes : iterable of NodeDescription
        The nodes of the graph.
    """
    # Scenes of several ships tell their frames on one topic.
    pictures = {topic.name: topic for node in nodes for topic in node.markers}
    return (*pictures.values(), DIAGNOSTICS)


def planned_displays(planned: Iterable[PlannedNode], recorded: bool) -> tuple[PlannedNode, ...]:
    """Return those of some nodes that only show the data.

    Parameters
    ----------
    planned : iterable of PlannedNode
        The nodes.
    recorded : bool
        Whether somebody looks at all their pictures from the begin on.
    """
    displays = (node for node in planned if description_of(node).is_display)
    return tuple(
        replace(node, publishers=description_of(node).markers if recorded else ())
        for node in displays
    )


def with_datum(
    given: Mapping[str, Mapping[str, Any]], datum: Datum | None
) -> dict[str, dict[str, Any]]:
    """Return parameters by which the sentences for chart plotters have the datum of the data.

    Parameters
    ----------
    given : mapping
        Node name, parameter name, value; a datum that is given there goes before.
    datum : Datum or None
        Of the scenario or recording.
    """
    told = {name: dict(values) for name, values in given.items()}
    plotter = told.get(NMEA_OUTPUT.name)
    if datum is not None and plotter is not None and not plotter.get("datum"):
        plotter["datum"] = datum.to_text()
    return told


def with_mountings(given: Mapping[str, Mapping[str, Any]]) -> dict[str, dict[str, Any]]:
    """Return parameters by which the scene shows sensors where the trackers take them to be.

    Parameters
    ----------
    given : mapping
        Node name, parameter name, value.
    """
    scene = dict(given.get(SCENE_PUBLISHER.name, {}))
    for sensor, tracker in _MOUNTINGS.items():
        for name, value in given.get(tracker, {}).items():
            if name.startswith("mounting_"):
                scene.setdefault(f"{sensor}_{name}", value)
    pings = given.get(HPDA_TRACKER.name, {})
    if "sound_speed" in pings:
        scene.setdefault("sound_speed", pings["sound_speed"])
    return {name: dict(values) for name, values in given.items()} | {SCENE_PUBLISHER.name: scene}
