"""What of a scenario is watched while its runs are disturbed. No ROS."""

from __future__ import annotations

import math
from dataclasses import dataclass

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.evaluation.metrics.bearing_score import CUTOFF_DEG
from sonar_tracking.evaluation.metrics.cutoff import CUTOFF_M
from sonar_tracking.graph.catalogue.graph_names import ROOT_NAMES
from sonar_tracking.graph.catalogue.node_description import NodeDescription
from sonar_tracking.graph.catalogue.scenario_graph import started_nodes
from sonar_tracking.graph.catalogue.topics import (
    ACTIVE_TRACKS,
    BEARING_TRACKS,
    PASSIVE_TRACKS,
    Topic,
)
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario


@dataclass(frozen=True)
class WatchedGraph:
    """What is watched of a scenario, and can be disturbed.

    Attributes
    ----------
    scenario : str
        As typed.
    tracks : Topic
        Lists of tracks.
    nodes : tuple of NodeDescription
        All that compute or simulate.
    """

    scenario: str
    tracks: Topic
    nodes: tuple[NodeDescription, ...]

    @property
    def names(self) -> list[str]:
        """Names of the nodes."""
        return [node.name for node in self.nodes]

    @property
    def cutoff(self) -> float:
        """Farthest a track is from its target, m or rad."""
        return math.radians(CUTOFF_DEG) if self.tracks is BEARING_TRACKS else CUTOFF_M

    @property
    def inputs(self) -> list[Topic]:
        """Topics of the graph that one of its nodes hears."""
        heard = [
            topic
            for node in self.nodes
            for topic in (*node.inputs, *node.optional_inputs, *node.topic_parameters.values())
        ]
        published = {topic.name for node in self.nodes for topic in _outputs(node)}
        return list({topic.name: topic for topic in heard if topic.name in published}.values())

    @property
    def published(self) -> dict[str, list[str]]:
        """Full names of the topics of each node."""
        return {
            node.name: [ROOT_NAMES.of(topic) for topic in _outputs(node)] for node in self.nodes
        }


def watched_graph(name: str) -> WatchedGraph:
    """Return the lists of tracks of a scenario, by name or path, and its nodes.

    Raises
    ------
    ConfigurationError
        If there is no such scenario, or it has no tracks.
    """
    nodes = [node for node in started_nodes(load_scenario(name), name) if not node.is_display]
    published = [topic for node in nodes for topic in _outputs(node)]
    for tracks in (ACTIVE_TRACKS, PASSIVE_TRACKS, BEARING_TRACKS):
        if tracks in published:
            return WatchedGraph(name, tracks, tuple(nodes))
    raise ConfigurationError(f"{name} has no node that publishes tracks, so nothing to watch.")


def _outputs(node: NodeDescription) -> tuple[Topic, ...]:
    return (*node.outputs, *node.station_outputs)
