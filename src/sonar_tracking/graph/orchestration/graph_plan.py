"""Which nodes make up a graph, how they are connected, and how each of them is started.

Everything a run needs to know before the first process starts. No ROS import.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from sonar_tracking.bags.contents.stored_text import yaml_text
from sonar_tracking.graph.catalogue.flow_window import SHORT_WINDOW, depth_for
from sonar_tracking.graph.catalogue.flow_window import VARIABLE as WINDOW
from sonar_tracking.graph.catalogue.graph_names import ROOT_NAMES, GraphNames
from sonar_tracking.graph.catalogue.node_catalogue import STATION, described
from sonar_tracking.graph.catalogue.planned_node import PlannedNode
from sonar_tracking.graph.catalogue.recorder_parameters import RECORDER
from sonar_tracking.graph.catalogue.resumption import CHECKPOINT
from sonar_tracking.graph.catalogue.run_identity import CONTROL_NODE, VARIABLE, new_identity
from sonar_tracking.graph.catalogue.topics import (
    CLOCK_TOPIC,
    LOFAR,
    PROGRESS_TOPIC,
    SAMPLES,
    SNAPSHOTS,
    SUBSPACES,
    TIME_TOPIC,
    Topic,
)
from sonar_tracking.graph.catalogue.transport_profile import TransportChoice
from sonar_tracking.graph.orchestration.flow_ledger import FlowLedger
from sonar_tracking.graph.orchestration.matched_edges import MatchedEdges
from sonar_tracking.graph.orchestration.process_supervisor import ProcessPlan
from sonar_tracking.one_thread import ONE_THREAD

"""Name of the orchestration's own node."""

_LARGE_TYPES = {topic.message_type for topic in (SNAPSHOTS, SAMPLES, SUBSPACES, LOFAR)}


@dataclass(frozen=True)
class GraphPlan:
    """A graph.

    Attributes
    ----------
    scenario : str
        Name of the scenario.
    nodes : tuple of PlannedNode
        In the order they are listed for people.
    offered : tuple of Topic
        Data topics the orchestration publishes itself (a replay's inputs).
    sources : tuple of str
        Names of the nodes that publish what is due up to ``/clock``.
    transport : TransportChoice
        Transport of the processes.
    displays : tuple of PlannedNode
        Nodes that only show what the others find: the graph does not wait for them.
    naming : GraphNames
        Namespace, clock and names of nodes. Topics of the nodes have their full names already.
    flow_window : int
        Most blocks between the clock and the slowest node.
    run : str
        Identity of the run.
    """

    scenario: str
    nodes: tuple[PlannedNode, ...]
    offered: tuple[Topic, ...] = ()
    sources: tuple[str, ...] = ()
    transport: TransportChoice = field(default_factory=TransportChoice)
    displays: tuple[PlannedNode, ...] = ()
    naming: GraphNames = ROOT_NAMES
    flow_window: int = SHORT_WINDOW
    run: str = field(default_factory=new_identity)

    def names(self) -> tuple[str, ...]:
        """Return the names of the nodes, those nobody waits for included."""
        return tuple(node.name for node in (*self.nodes, *self.displays))

    def display_names(self) -> tuple[str, ...]:
        """Return the names of the nodes nobody waits for."""
        return tuple(node.name for node in self.displays)

    def topics(self) -> dict[str, Topic]:
        """Return all data topics by resolved name; what is offered is what it is offered as."""
        listed = [topic for node in self.nodes for topic in (*node.publishers, *node.subscriptions)]
        offered = {resolved(topic): topic for topic in self.offered}
        return offered | {resolved(topic): topic for topic in listed} | offered

    def offered_names(self) -> tuple[str, ...]:
        """Return the resolved names of the topics the orchestration publishes."""
        return tuple(resolved(topic) for topic in self.offered)

    def observed(self) -> dict[str, Topic]:
        """Return the topics the orchestration listens to: all but those it publishes."""
        own = {topic.name for topic in self.offered}
        published = {topic.name for node in self.nodes for topic in node.publishers}
        return {
            name: topic
            for name, topic in self.topics().items()
            if topic.name in published and topic.name not in own
        }

    def commanded_lists(self) -> dict[str, str]:
        """Return the track lists that operators can command, with their names in the root."""
        known = (described(node.name, node.parameters) for node in self.nodes)
        topics = [one.commanded_topic for one in known if one and one.commanded_topic is not None]
        return {self.naming.of(topic): topic.name for topic in topics}

    def producers(self) -> dict[str, str]:
        """Return the node that publishes each topic."""
        producers = {resolved(topic): CONTROL_NODE for topic in self.offered}
        for node in self.nodes:
            producers.update({resolved(topic): node.name for topic in node.publishers})
        return producers

    def consumers(self) -> dict[str, tuple[str, ...]]:
        """Return the nodes that consume each topic, the orchestration included."""
        consumers: dict[str, list[str]] = {name: [] for name in self.topics()}
        for node in self.nodes:
            for topic in node.subscriptions:
                consumers[resolved(topic)].append(node.name)
        for name in self.observed():
            consumers[name].append(CONTROL_NODE)
        return {name: tuple(nodes) for name, nodes in consumers.items()}

    def process(self, node: PlannedNode, log_directory: Path, restarts: int = 0) -> ProcessPlan:
        """Return how to start a node; see :func:`process_plan`."""
        node = self._with_room(node)
        plan = process_plan(node, self.transport, log_directory, restarts, self.naming)
        known = {VARIABLE: self.run, WINDOW: str(self.flow_window)}
        if node.gives_identifiers or node.name in self.sources:
            known[CHECKPOINT] = str(log_directory / f"{node.name}.checkpoint")
        return replace(plan, environment={**plan.environment, **known})

    def _with_room(self, node: PlannedNode) -> PlannedNode:
        """Return a node whose queues hold what the window lets into the graph."""
        depth = node.parameters.get("flow_depth")
        if depth is None:
            return node
        room = {"flow_depth": depth_for(self.flow_window, int(depth))}
        return replace(node, parameters={**node.parameters, **room})

    def ledger(self) -> FlowLedger:
        """Return the empty ledger of the graph."""
        return FlowLedger(self.consumers(), self.producers())

    def edges(self) -> MatchedEdges:
        """Return whom each node must have found before data may flow; displays should have."""
        consumers, producers = self.consumers(), self.producers()
        control = (CONTROL_NODE,)
        subscriptions = {node.name: self._heard(node, producers) for node in self.nodes}
        subscriptions = {
            name: {self.naming.clock: control, **heard} for name, heard in subscriptions.items()
        }
        time = self.naming.of(TIME_TOPIC)
        for source in self.sources:
            subscriptions[source][time] = control
        subscriptions |= {node.name: self._heard(node, producers) for node in self.displays}
        publishers = {
            node.name: {self.naming.of(PROGRESS_TOPIC): control}
            | {resolved(topic): consumers[resolved(topic)] for topic in node.publishers}
            for node in self.nodes
        }
        publishers[CONTROL_NODE] = {name: consumers[name] for name in self.offered_names()}
        if self.sources:
            publishers[CONTROL_NODE][time] = self.sources
        # What is not recorded of a display, nobody has to look at.
        recorders = tuple(node.name for node in self.nodes if node.name == RECORDER)
        publishers |= {
            node.name: {resolved(topic): recorders for topic in node.publishers}
            for node in self.displays
        }
        return MatchedEdges(subscriptions, publishers, self.display_names())

    @staticmethod
    def _heard(node: PlannedNode, producers: Mapping[str, str]) -> dict[str, tuple[str, ...]]:
        """Return who publishes what a node hears, as far as somebody does."""
        names = [resolved(topic) for topic in node.subscriptions]
        return {name: (producers[name],) for name in names if name in producers}


def resolved(topic: Topic) -> str:
    """Return the full name of a topic of a plan; one that is not full is in the root namespace."""
    return ROOT_NAMES.of(topic)


def process_plan(
    node: PlannedNode,
    transport: TransportChoice,
    log_directory: Path,
    restarts: int = 0,
    naming: GraphNames = ROOT_NAMES,
) -> ProcessPlan:
    """Return how to start a node, and write its parameter file into the log directory.

    Parameters
    ----------
    node : PlannedNode
        The node.
    transport : TransportChoice
        Transport of the processes.
    log_directory : Path
        Where parameter files and logs go.
    restarts : int
        How often the node was started before; identifiers begin anew far above the old ones.
    naming : GraphNames
        Where the node is.
    """
    values = dict(node.parameters)
    if node.gives_identifiers:
        values["first_id"] = (restarts << 32) + int(values.get("first_id", 1))
    values["use_sim_time"] = node.needs_clock
    parameter_file = log_directory / f"{node.name}.yaml"
    # A list without entries has no type in a parameter file; it is the default wherever allowed.
    plain = {
        name: list(value) if isinstance(value, tuple) else value
        for name, value in values.items()
        if value != ()
    }
    full_name = naming.of_node(node.name) if naming.namespace else node.name
    parameter_file.write_text(yaml_text({full_name: {"ros__parameters": plain}}))
    large = any(topic.message_type in _LARGE_TYPES for topic in node.publishers)
    return ProcessPlan(
        name=node.name,
        module=node.module,
        arguments=(
            "--ros-args",
            *_name_rules(node, naming),
            "--params-file",
            str(parameter_file),
        ),
        environment=_environment(
            transport.large_publishers if large else transport.others, log_directory
        ),
    )


def _name_rules(node: PlannedNode, naming: GraphNames) -> tuple[str, ...]:
    """Return the arguments that give a node and its topics their names; none in the root."""
    rules = dict(node.remaps)
    if node.parameters.get(STATION):
        rules["__node"] = node.name
    if naming.namespace:
        rules |= {"__ns": naming.namespace, CLOCK_TOPIC: naming.clock}
    return tuple(text for old, new in rules.items() for text in ("-r", f"{old}:={new}"))


def _environment(transport: Mapping[str, str], log_directory: Path) -> dict[str, str]:
    """Return the environment of a node.

    The whole environment is passed on: the library path of the ROS wheels and the mark that it has
    been set only work together.
    """
    return {
        **os.environ,
        **ONE_THREAD,
        "PYTHONUNBUFFERED": "1",
        "RCUTILS_COLORIZED_OUTPUT": "0",
        "ROS_LOG_DIR": str(log_directory / "ros"),
        **transport,
    }
