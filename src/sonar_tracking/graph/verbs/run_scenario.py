"""``sonar-tracking run``: a scenario through the live graph."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from sonar_tracking.bags.contents.recording_information import RecordingInformation
from sonar_tracking.display.run_display import RunDisplay
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.catalogue.display_plan import (
    planned_displays,
    shown_topics,
    with_datum,
    with_mountings,
)
from sonar_tracking.graph.catalogue.flow_window import flow_window
from sonar_tracking.graph.catalogue.graph_names import ROOT_NAMES, GraphNames
from sonar_tracking.graph.catalogue.node_catalogue import description_of
from sonar_tracking.graph.catalogue.node_description import NodeDescription
from sonar_tracking.graph.catalogue.node_settings import (
    NodeSettings,
    read_settings,
    resolved_settings,
    with_room_for_bursts,
)
from sonar_tracking.graph.catalogue.page_plan import planned_page
from sonar_tracking.graph.catalogue.planned_node import PlannedNode
from sonar_tracking.graph.catalogue.scenario_graph import (
    planned_nodes,
    started_nodes,
    with_published_topics,
)
from sonar_tracking.graph.catalogue.topics import COMMANDS, Topic
from sonar_tracking.graph.catalogue.transport_profile import choose_transport
from sonar_tracking.graph.orchestration.flow_ledger import FlowLedger
from sonar_tracking.graph.orchestration.graph_plan import GraphPlan
from sonar_tracking.graph.orchestration.orchestration import Orchestration
from sonar_tracking.graph.orchestration.run_report import RunReport
from sonar_tracking.graph.orchestration.time_master import TimeMaster
from sonar_tracking.graph.verbs.array_sizes import check_source_counts, largest_message_bytes
from sonar_tracking.graph.verbs.recording_plan import planned_recorder, recording_hint
from sonar_tracking.graph.verbs.run_options import RunOptions
from sonar_tracking.records.time import NANOSECONDS
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.scenarios.scenario_checks import check_scenario
from sonar_tracking.simulation.scenarios.scenario_mapping import (
    load_scenario,
    scenario_to_mapping,
    scenario_to_yaml,
)

if TYPE_CHECKING:
    from sonar_tracking.graph.orchestration.control_node import ControlNode
    from sonar_tracking.graph.orchestration.run_observer import RunObserver
    from sonar_tracking.graph.orchestration.simulated_source import SimulatedSource

_CLOCK_HINT = (
    "the time of this run is {0}: another node with use_sim_time takes it with "
    "--ros-args -r /clock:={0}"
)


def run_scenario(
    name_or_path: str,
    duration: float | None,
    parameters: Path | None,
    names: GraphNames,
    options: RunOptions,
    display: RunDisplay,
    log_directory: Path,
) -> RunReport:
    """Run a scenario through the live graph.

    Parameters
    ----------
    name_or_path : str
        Scenario.
    duration : float or None
        Length of the data, s; None = as the scenario says.
    parameters : Path or None
        File with parameters of nodes, before those of the scenario.
    names : GraphNames
        Of nodes and topics.
    options : RunOptions
        Rate, recording, report.
    display : RunDisplay
        Where to show what happens.
    log_directory : Path
        Where the nodes' logs go.

    Raises
    ------
    ConfigurationError
        If scenario, parameters or options cannot be used; nothing was started then.
    """
    scenario, where = _with_file(read_scenario(name_or_path, duration), name_or_path, parameters)
    plan = plan_scenario(scenario, options, log_directory, where, names)
    orchestration = Orchestration(plan, display, log_directory)
    if names.namespace:
        display.say(_CLOCK_HINT.format(names.clock))
    orchestration.start_processes()
    os.environ.update(plan.transport.others)
    # rclpy takes a second to load: meanwhile the nodes do the same.
    from sonar_tracking.graph.orchestration.control_node import ControlNode
    from sonar_tracking.graph.orchestration.run_observer import RunObserver

    observer = RunObserver(plan.topics(), display, options.cutoff_m, naming=names)
    try:
        ledger, edges = orchestration.ledger, orchestration.edges
        known = (plan.names(), plan.sources, names, plan.run)
        with ControlNode(ledger, edges, observer, *known) as control:
            control.observe(plan.observed().values())
            control.offer(plan.offered, 2 * plan.flow_window)
            source = _source(scenario, plan, options.rate, control, ledger, observer)
            orchestration.run(control, source)
    finally:
        orchestration.stop_processes()
    if options.record is not None:
        display.say(recording_hint(options.record, plan.topics(), observer.records))
    return orchestration.report(source.data_seconds, observer)


def read_scenario(name_or_path: str, duration: float | None) -> Scenario:
    """Return a scenario, of another length if asked for.

    Raises
    ------
    ConfigurationError
        If it cannot be used.
    """
    scenario = load_scenario(name_or_path)
    if duration is None:
        return scenario
    if not 0.0 < duration <= 1e7:
        raise ConfigurationError(
            f"--duration is {duration:g}; give the length of the data in seconds, above 0."
        )
    scenario = replace(scenario, duration=duration)
    check_scenario(scenario, "--duration: ")
    return scenario


def plan_scenario(
    scenario: Scenario,
    options: RunOptions,
    log_directory: Path,
    where: str,
    names: GraphNames = ROOT_NAMES,
) -> GraphPlan:
    """Return the graph of a scenario.

    Raises
    ------
    ConfigurationError
        If the parameters of a node cannot be used, or a rule for names.
    """
    descriptions, settings = _nodes(scenario, options.display_topics, where)
    sources = tuple(node.name for node in descriptions if node.serves_clock)
    scenario_file = log_directory / "scenario.yaml"
    scenario_file.write_text(scenario_to_yaml(scenario), encoding="utf-8")
    for name in sources:
        settings[name] = {**settings[name], "scenario": str(scenario_file)}
    planned = planned_nodes(descriptions, settings, scenario.namespaces)
    names.check(_topics_of(planned))
    nodes = names.planned(node for node in planned if not description_of(node).is_display)
    commands = (COMMANDS,) if any(node.commanded_topic for node in descriptions) else ()
    offered = names.topics(commands)
    if options.record is not None:
        topics = {topic.name: topic for node in nodes for topic in node.publishers}
        topics |= {topic.name: topic for topic in offered}
        shown = shown_topics(descriptions) if options.display_topics else ()
        published = (topic for node in planned for topic in node.publishers)
        noted = names.noted([*published, *commands, *shown])
        for name in sources:
            settings[name] = {**settings[name], "scenario": scenario.name}
        known = RecordingInformation(scenario_to_mapping(scenario), settings, topic_names=noted)
        shown = names.topics(shown)
        nodes += (
            planned_recorder(options.record, topics.values(), shown, known, names, log_directory),
        )
    largest = largest_message_bytes(scenario, settings)
    shown_as = with_mountings(scenario.nodes)
    played = (*_published(nodes), *offered)
    return GraphPlan(
        scenario=scenario.name,
        nodes=nodes,
        offered=offered,
        sources=sources,
        transport=choose_transport(largest, n_publishers=2),
        displays=(
            *names.planned(planned_displays(planned, options.record is not None)),
            *planned_page(options.page, played, shown_as, scenario.name, scenario.datum),
        ),
        naming=names,
        flow_window=flow_window(options.rate, largest),
    )


def _nodes(
    scenario: Scenario, display_topics: bool, where: str
) -> tuple[tuple[NodeDescription, ...], NodeSettings]:
    """Return the nodes of a scenario, with every parameter of each."""
    descriptions = started_nodes(scenario, where)
    given = with_datum(with_mountings(scenario.nodes), scenario.datum)
    given = with_published_topics(descriptions, given, scenario.namespaces)
    settings = resolved_settings(given, descriptions, f"{where}: nodes")
    check_source_counts(scenario, settings, where)
    settings = with_room_for_bursts(settings, scenario.step)
    shown = tuple(node for node in descriptions if display_topics or not node.is_display)
    return shown, {node.name: settings[node.name] for node in shown}


def _published(nodes: Iterable[PlannedNode]) -> list[Topic]:
    return [topic for node in nodes for topic in node.publishers]


def _topics_of(nodes: Iterable[PlannedNode]) -> list[Topic]:
    """Return every topic that nodes publish or take, markers included."""
    return [
        topic
        for node in nodes
        for topic in (*node.publishers, *node.subscriptions, *description_of(node).markers)
    ]


def _with_file(scenario: Scenario, name: str, path: Path | None) -> tuple[Scenario, str]:
    """Return a scenario with the parameters of nodes that a file gives, and where all is from."""
    if path is None:
        return scenario, name
    given = {
        node: {**scenario.nodes.get(node, {}), **values}
        for node, values in read_settings(path).items()
    }
    return replace(scenario, nodes={**scenario.nodes, **given}), f"{name} with {path}"


def _source(
    scenario: Scenario,
    plan: GraphPlan,
    rate: float,
    control: ControlNode,
    ledger: FlowLedger,
    observer: RunObserver,
) -> SimulatedSource:
    """Return what moves the clock, and gives the commands of operators their stamps."""
    from sonar_tracking.graph.orchestration.command_channel import open_desk
    from sonar_tracking.graph.orchestration.simulated_source import SimulatedSource

    master = TimeMaster(
        start=scenario.stamp(scenario.start),
        end=scenario.stamp(scenario.end),
        step=round(scenario.step * NANOSECONDS),
        flow_window=plan.flow_window,
        rate=rate,
    )
    desk = open_desk(plan, control, ledger, observer)
    return SimulatedSource(control, ledger, master, scenario.stamp(scenario.start), desk)
