"""What the launch files start: nodes of a scenario, or trackers behind a sensor (no ROS import).

Every argument is checked before any node is started.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sonar_tracking.configuration import checked_value
from sonar_tracking.errors import ConfigurationError, unknown_name_text
from sonar_tracking.graph.catalogue.active_nodes import HPDA_TRACKER
from sonar_tracking.graph.catalogue.display_nodes import SCENE_PUBLISHER
from sonar_tracking.graph.catalogue.display_plan import with_datum, with_mountings
from sonar_tracking.graph.catalogue.node_catalogue import NODES, STATION
from sonar_tracking.graph.catalogue.node_description import NodeDescription
from sonar_tracking.graph.catalogue.node_settings import (
    NodeSettings,
    read_settings,
    resolved_settings,
    with_room_for_bursts,
)
from sonar_tracking.graph.catalogue.passive_nodes import (
    BAND_DEMODULATOR,
    BEARING_TRACKER,
    LINE_TRACKER,
    SUBSPACE_ESTIMATOR,
)
from sonar_tracking.graph.catalogue.scenario_graph import started_nodes, with_published_topics
from sonar_tracking.graph.catalogue.simulator_nodes import ARRAY_SIMULATOR, HYDROPHONE_SIMULATOR
from sonar_tracking.graph.catalogue.tma_nodes import TMA_TRACKER
from sonar_tracking.graph.catalogue.transport_profile import choose_transport
from sonar_tracking.one_thread import ONE_THREAD
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario

_METHODS = {
    f"{node.name}_method": entry
    for node in NODES.values()
    for entry in node.parameters
    if entry.name == "method"
}

CHAINS: Mapping[str, tuple[NodeDescription, ...]] = {
    "array": (SUBSPACE_ESTIMATOR, BEARING_TRACKER),
    "samples": (BAND_DEMODULATOR, SUBSPACE_ESTIMATOR, BEARING_TRACKER, LINE_TRACKER),
    "bearings": (TMA_TRACKER,),
    "contacts": (HPDA_TRACKER,),
}
"""The trackers behind a sensor, by what it delivers."""

SENSOR_BLOCK = 1.0
"""Longest block of data expected of a sensor of one's own, s."""

_FOR_ALL = {
    "namespace": ("", "of all nodes and their topics"),
    "remap": ("", "topics by other names: from:=to, several with commas between"),
    "use_sim_time": ("false", "true if another program publishes /clock"),
    "parameters": ("", "parameter file for all nodes"),
    "display_topics": ("true", "false leaves out scene_publisher, which serves RViz and Foxglove"),
    **{
        name: ("", f"one of {', '.join(entry.choices)}; empty = as the other parameters say")
        for name, entry in _METHODS.items()
    },
}
SCENARIO_ARGUMENTS: Mapping[str, tuple[str, str]] = {
    "scenario": ("harbour_watch", "name or path of a scenario"),
    **_FOR_ALL,
}
"""Default and description of the arguments of the launch file of a scenario."""

CHAIN_ARGUMENTS: Mapping[str, tuple[str, str]] = {
    "chain": ("contacts", f"what the sensor delivers: {', '.join(CHAINS)}"),
    "positions": ("false", "true: tma_tracker behind array or samples, too"),
    **_FOR_ALL,
}
"""The same of the launch file of the trackers."""


@dataclass(frozen=True)
class LaunchedNode:
    """One process, in the words of ``launch_ros.actions.Node``.

    Attributes
    ----------
    executable, name : str
        Program, and name of the node.
    namespace : str
        Of the node.
    parameters : list
        Mappings and files; the later goes before the earlier.
    remappings : list of (str, str)
        Names of topics.
    additional_env : mapping of str to str
        Environment.
    """

    executable: str
    name: str
    namespace: str
    parameters: list[Any]
    remappings: list[tuple[str, str]]
    additional_env: Mapping[str, str]


def nodes_of_scenario(given: Mapping[str, str]) -> list[LaunchedNode]:
    """Return the nodes of a scenario, simulators included.

    Parameters
    ----------
    given : mapping of str to str
        Values of :data:`SCENARIO_ARGUMENTS`.

    Raises
    ------
    ConfigurationError
        If an argument cannot be used.
    """
    name = given["scenario"]
    scenario = load_scenario(name)
    nodes = started_nodes(scenario, name)
    transport = choose_transport(scenario.block_bytes, n_publishers=1)
    given_there = with_datum(with_mountings(scenario.nodes), scenario.datum)
    parameters = with_published_topics(nodes, given_there, scenario.namespaces)
    for node in nodes:
        if node.serves_clock:
            parameters.setdefault(node.name, {})["scenario"] = name
        if node.station:
            parameters.setdefault(node.name, {})[STATION] = node.station
    array_simulators = (ARRAY_SIMULATOR.name, HYDROPHONE_SIMULATOR.name)
    environments = {
        node.name: transport.large_publishers if node.kind in array_simulators else transport.others
        for node in nodes
    }
    return _launched(nodes, parameters, environments, given, scenario.step)


def nodes_of_chain(given: Mapping[str, str]) -> list[LaunchedNode]:
    """Return the trackers behind a sensor of one's own.

    Parameters
    ----------
    given : mapping of str to str
        Values of :data:`CHAIN_ARGUMENTS`.

    Raises
    ------
    ConfigurationError
        If an argument cannot be used.
    """
    chain = given["chain"]
    if chain not in CHAINS:
        raise ConfigurationError(unknown_name_text(f"chain:={chain}", chain, CHAINS))
    nodes = CHAINS[chain]
    parameters: dict[str, dict[str, Any]] = {}
    if _flag("positions", given):
        if BEARING_TRACKER not in nodes:
            raise ConfigurationError(
                f"positions:=true adds tma_tracker to bearings, but chain:={chain} finds none; "
                "leave it out."
            )
        nodes = (*nodes, TMA_TRACKER)
        parameters = with_published_topics(nodes, {}, {})
    nodes = (*nodes, SCENE_PUBLISHER)
    environment = choose_transport(0, n_publishers=0).others
    environments = dict.fromkeys((node.name for node in nodes), environment)
    return _launched(nodes, parameters, environments, given, SENSOR_BLOCK)


def _launched(
    nodes: tuple[NodeDescription, ...],
    parameters: Mapping[str, Mapping[str, Any]],
    environments: Mapping[str, Mapping[str, str]],
    given: Mapping[str, str],
    block_seconds: float,
) -> list[LaunchedNode]:
    shown = _flag("display_topics", given)
    nodes = tuple(node for node in nodes if shown or not node.is_display)
    methods = _methods(nodes, given)
    file = [given["parameters"]] if given["parameters"] else []
    # ROS would start every node and let each of them fail over a file that is not there.
    of_file = read_settings(Path(given["parameters"])) if file else {}
    depths = _depths(nodes, (parameters, _known(nodes, of_file), methods), block_seconds)
    use_sim_time = _flag("use_sim_time", given)
    remappings = _remappings(given["remap"])
    return [
        LaunchedNode(
            executable=node.kind,
            name=node.name,
            namespace=given["namespace"],
            parameters=[
                _without_empty(parameters.get(node.name, {})),
                {"use_sim_time": use_sim_time},
                *file,
                *filter(None, (methods.get(node.name), depths.get(node.name))),
            ],
            remappings=remappings,
            additional_env={**ONE_THREAD, **environments[node.name]},
        )
        for node in nodes
    ]


def _methods(
    nodes: tuple[NodeDescription, ...], given: Mapping[str, str]
) -> dict[str, dict[str, str]]:
    """Return the methods asked for, each as a parameter of its node."""
    methods = {}
    for argument, entry in _METHODS.items():
        if not given[argument]:
            continue
        name = argument.removesuffix("_method")
        if name not in [node.name for node in nodes]:
            names = ", ".join(node.name for node in nodes)
            raise ConfigurationError(
                f"{argument} is given, but {name} is not started; there are {names}."
            )
        methods[name] = {"method": str(checked_value(entry, given[argument], name))}
    return methods


def _known(
    nodes: tuple[NodeDescription, ...], settings: Mapping[str, Mapping[str, Any]]
) -> dict[str, dict[str, Any]]:
    """Return what a parameter file says of the parameters of some nodes, also by ``/**``.

    Names are those without the namespace; what else ROS may be told stays between it and the node.
    """
    by_name = {name.rpartition("/")[2]: values for name, values in settings.items()}
    known = {}
    for node in nodes:
        values = {**by_name.get("**", {}), **by_name.get(node.name, {})}
        names = {entry.name for entry in node.parameters}
        known[node.name] = {name: value for name, value in values.items() if name in names}
    return known


def _depths(
    nodes: tuple[NodeDescription, ...],
    layers: Iterable[Mapping[str, Mapping[str, Any]]],
    block_seconds: float,
) -> dict[str, dict[str, Any]]:
    """Return the ``flow_depth`` of every node whose queues need more than its parameters say."""
    given: dict[str, dict[str, Any]] = {node.name: {} for node in nodes}
    for layer in layers:
        for name in given:
            given[name] |= layer.get(name, {})
    settings: NodeSettings = {}
    for node in nodes:
        # One by one: whether they fit together is for the nodes to say, some may be elsewhere.
        settings |= resolved_settings({node.name: given[node.name]}, (node,), "parameters")
    deepened = with_room_for_bursts(settings, block_seconds)
    return {
        name: {"flow_depth": values["flow_depth"]}
        for name, values in deepened.items()
        if values.get("flow_depth") != settings[name].get("flow_depth")
    }


def _remappings(text: str) -> list[tuple[str, str]]:
    rules = []
    for rule in filter(None, (each.strip() for each in text.split(","))):
        old, separator, new = rule.partition(":=")
        if not (old and separator and new):
            raise ConfigurationError(
                f"remap holds {rule!r}; write from:=to, several with commas between."
            )
        rules.append((old, new))
    return rules


def _flag(name: str, given: Mapping[str, str]) -> bool:
    text = given[name].lower()
    if text not in ("true", "false"):
        raise ConfigurationError(f"{name} is {given[name]}; it must be true or false.")
    return text == "true"


def _without_empty(values: Mapping[str, Any]) -> dict[str, Any]:
    """Leave out empty lists, of which the launch system cannot tell the type."""
    return {name: value for name, value in values.items() if value != ()}
