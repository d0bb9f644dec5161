"""``sonar-tracking replay``: a recording through the live graph, compared with what it holds."""

from __future__ import annotations

import os
from collections.abc import Collection, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sonar_tracking.bags.contents.recording_information import RecordingInformation
from sonar_tracking.bags.storage.bag_datum import bag_datum
from sonar_tracking.bags.storage.reader import Bag, read_bag
from sonar_tracking.bags.storage.repair import repair_bag
from sonar_tracking.display.run_display import RunDisplay
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.catalogue.display_nodes import SCENE_PUBLISHER
from sonar_tracking.graph.catalogue.display_plan import (
    planned_displays,
    shown_topics,
    with_datum,
    with_mountings,
)
from sonar_tracking.graph.catalogue.flow_window import flow_window
from sonar_tracking.graph.catalogue.graph_names import ROOT_NAMES
from sonar_tracking.graph.catalogue.node_catalogue import NODES, described, description_of
from sonar_tracking.graph.catalogue.node_description import NodeDescription
from sonar_tracking.graph.catalogue.node_settings import (
    NodeSettings,
    read_settings,
    resolved_settings,
    with_room_for_bursts,
)
from sonar_tracking.graph.catalogue.page_plan import planned_page
from sonar_tracking.graph.catalogue.planned_node import PlannedNode
from sonar_tracking.graph.catalogue.scenario_graph import NO_TOPIC, planned_nodes
from sonar_tracking.graph.catalogue.topics import (
    BEARING_TRACKS,
    COMMANDS,
    TRUE_BEARING_TRACKS,
    TRUE_TRACKS,
    Topic,
    TopicRole,
)
from sonar_tracking.graph.catalogue.transport_profile import choose_transport
from sonar_tracking.graph.orchestration.graph_plan import GraphPlan, resolved
from sonar_tracking.graph.orchestration.orchestration import Orchestration
from sonar_tracking.graph.orchestration.run_report import RunReport
from sonar_tracking.graph.verbs.inferred_nodes import inferred_nodes, recorded_topics
from sonar_tracking.graph.verbs.recording_plan import planned_recorder, recording_hint
from sonar_tracking.graph.verbs.replay_comparison import ReplayComparison
from sonar_tracking.graph.verbs.replay_selection import Selection
from sonar_tracking.graph.verbs.replay_sizes import block_seconds, largest_input_bytes
from sonar_tracking.graph.verbs.replayed_nodes import processing_nodes, scenes
from sonar_tracking.graph.verbs.run_options import RunOptions
from sonar_tracking.records.datum import Datum

if TYPE_CHECKING:
    from sonar_tracking.graph.orchestration.player import Player
    from sonar_tracking.graph.orchestration.run_observer import RunObserver


def replay_bag(
    path: Path,
    parameters: Path | None,
    repair: bool,
    selection: Selection,
    options: RunOptions,
    display: RunDisplay,
    log_directory: Path,
) -> RunReport:
    """Publish the recorded inputs through the live nodes and compare their outputs.

    Parameters
    ----------
    path : Path
        The bag.
    parameters : Path or None
        Parameter file that overrides what the bag says.
    repair : bool
        Rewrite a bag that is not whole, or that other tools cannot open, first.
    selection : Selection
        Names of the topics, and which part of the bag.
    options : RunOptions
        Rate, recording, report.
    display : RunDisplay
        Where to show what happens.
    log_directory : Path
        Where the nodes' logs go.

    Raises
    ------
    ConfigurationError
        If bag or parameters cannot be used; nothing was started then.
    """
    selection.check(options)
    bag = selection.of(opened_bag(path, repair, display))
    datum = bag_datum(bag)
    settings = settings_of(bag, parameters, display, datum)
    selection.check_loop(bag, settings)
    plan = plan_replay(bag, settings, options, log_directory, datum)
    if selection.loop:
        # The truth of one pass cannot be told from that of the next.
        inputs = tuple(topic for topic in plan.offered if topic.role is not TopicRole.TRUTH)
        plan = replace(plan, offered=inputs)
    orchestration = Orchestration(plan, display, log_directory)
    if bag.recovery:
        orchestration.warnings.append(bag.recovery)
    observer, comparison, source = _play(bag, plan, orchestration, selection, options, display)
    if options.record is not None:
        display.say(recording_hint(options.record, plan.topics(), observer.records))
    report = orchestration.report(source.data_seconds, observer)
    known = bool(processing_nodes(_recorded_parameters(bag)))
    same_parameters = not source.commanded and parameters is None and known
    return _compared(report, comparison, same_parameters) if source.finished else report


def _play(
    bag: Bag,
    plan: GraphPlan,
    orchestration: Orchestration,
    selection: Selection,
    options: RunOptions,
    display: RunDisplay,
) -> tuple[RunObserver, ReplayComparison, Player]:
    """Run the graph on the recorded inputs; the processes have stopped when it returns."""
    orchestration.start_processes()
    os.environ.update(plan.transport.large_publishers)
    # rclpy takes a second to load: meanwhile the nodes do the same.
    from sonar_tracking.graph.orchestration.command_channel import open_desk
    from sonar_tracking.graph.orchestration.control_node import ControlNode
    from sonar_tracking.graph.orchestration.player import Player
    from sonar_tracking.graph.orchestration.run_observer import RunObserver

    observer = RunObserver(plan.topics(), display, options.cutoff_m, selection.whole)
    truth = {resolved(topic) for topic in plan.offered if topic.role is TopicRole.TRUTH}
    inputs = {*plan.offered_names()} - truth
    replayed = observer.records if selection.whole else {}
    comparison = ReplayComparison(bag, replayed, inputs | truth)
    try:
        names = plan.names()
        with ControlNode(
            orchestration.ledger, orchestration.edges, observer, names, run=plan.run
        ) as control:
            control.offer(plan.offered, 2 * plan.flow_window + 2)
            control.observe(plan.observed().values())
            desk = open_desk(plan, control, orchestration.ledger, observer)
            source = Player(
                control,
                orchestration.ledger,
                selection.messages(bag, inputs | truth | comparison.topics),
                inputs,
                truth,
                comparison.take,
                observer.replayed,
                plan.flow_window,
                options.rate,
                desk,
            )
            orchestration.run(control, source)
    finally:
        orchestration.stop_processes()
    return observer, comparison, source


def plan_replay(
    bag: Bag,
    settings: NodeSettings,
    options: RunOptions,
    log_directory: Path,
    datum: Datum | None,
) -> GraphPlan:
    """Return the graph that replays a bag with a datum, if it has one.

    Raises
    ------
    ConfigurationError
        If the bag holds nothing the nodes take.
    """
    nodes_known = [described(name, values) for name, values in settings.items()]
    descriptions = [node for node in nodes_known if node is not None]
    settings = with_room_for_bursts(settings, block_seconds(bag))
    if not options.display_topics:
        descriptions = [node for node in descriptions if not node.is_display]
    planned = planned_nodes(descriptions, settings)
    nodes = tuple(node for node in planned if not description_of(node).is_display)
    offered = _offered(bag, nodes)
    scenario = dict(bag.recording.scenario) if bag.recording else {}
    if options.record is not None:
        topics = [*offered, *(topic for node in nodes for topic in node.publishers)]
        shown = shown_topics(descriptions) if options.display_topics else ()
        information = RecordingInformation(scenario, settings)
        nodes += (
            planned_recorder(options.record, topics, shown, information, ROOT_NAMES, log_directory),
        )
    largest = largest_input_bytes(bag, offered)
    played = [*offered, *(topic for node in nodes for topic in node.publishers)]
    title = str(scenario.get("name") or "")
    return GraphPlan(
        scenario=title or bag.path.name,
        nodes=nodes,
        offered=offered,
        transport=choose_transport(largest, n_publishers=2),
        displays=(
            *planned_displays(planned, options.record is not None),
            *planned_page(options.page, played, settings, title, datum),
        ),
        flow_window=flow_window(options.rate, largest),
    )


def opened_bag(path: Path, repair: bool, display: RunDisplay) -> Bag:
    """Return the bag to replay: the repaired one, if that was asked for and there is a reason."""
    bag = read_bag(path)
    reason = bag.recovery or (bag.outdated if repair else None)
    if reason:
        display.say(reason)
    if repair and reason:
        whole = repair_bag(path)
        display.say(f"the repaired bag is {whole}")
        return read_bag(whole)
    return bag


def settings_of(
    bag: Bag, parameters: Path | None, display: RunDisplay, datum: Datum | None
) -> NodeSettings:
    """Return every parameter of the nodes to start: from the bag, overridden by a file.

    Where neither names a node, the nodes follow from the types of messages in the bag. Those that
    need a datum get that of the bag.

    Raises
    ------
    ConfigurationError
        If a parameter cannot be used, or no node takes what is in the bag.
    """
    recorded = _recorded_parameters(bag)
    given: dict[str, dict[str, Any]] = {name: dict(values) for name, values in recorded.items()}
    where = str(bag.path)
    if parameters is not None:
        where = str(parameters)
        for name, values in read_settings(parameters).items():
            given[name] = {**given.get(name, {}), **values}
    processing = processing_nodes(given)
    if not processing:
        inferred = inferred_nodes(bag)
        processing = processing_nodes(inferred)
        given |= inferred
        display.say(
            f"{bag.path} does not say with which nodes it was recorded; by the types of its "
            f"messages: {', '.join(inferred)}. --parameters FILE gives others."
        )
    given = with_datum(with_mountings(given), datum)
    if not recorded.get(SCENE_PUBLISHER.name):
        given[SCENE_PUBLISHER.name].setdefault("bearing_topics", _bearing_topics(bag, processing))
    return resolved_settings(given, (*processing, *scenes(given)), where)


def _bearing_topics(bag: Bag, nodes: tuple[NodeDescription, ...]) -> list[str]:
    """Return the bearing tracks in a bag and of the nodes that replay it."""
    kind = BEARING_TRACKS.message_type
    found = [topic.name for node in nodes for topic in node.outputs if topic.message_type == kind]
    found += recorded_topics(bag, BEARING_TRACKS)
    return sorted(set(found)) or [NO_TOPIC]


def _recorded_parameters(bag: Bag) -> Mapping[str, Mapping[str, Any]]:
    return bag.recording.node_parameters if bag.recording else {}


def _offered(bag: Bag, nodes: tuple[PlannedNode, ...]) -> tuple[Topic, ...]:
    """Return the topics to play: inputs, whatever else the nodes need of the bag, and truth."""
    known = {resolved(topic): topic for node in NODES.values() for topic in node.outputs}
    computed = {resolved(topic) for node in nodes for topic in node.publishers}
    needed = {resolved(topic): topic for node in nodes for topic in node.subscriptions}
    wanted = needed.keys() - computed
    known |= needed
    # Whoever computed it when it was recorded: what is played is an input of this graph.
    offered = tuple(
        replace(known[name], role=TopicRole.INPUT)
        for name, topic in bag.topics.items()
        if name in known
        and topic.message_count
        and (name in wanted or (topic.role == "input" and name not in computed))
    )
    optional = {resolved(topic) for node in nodes for topic in description_of(node).optional_inputs}
    if commands := wanted & {resolved(COMMANDS)}:
        # New ones may be given, whether the recording holds any or not.
        offered = (*(topic for topic in offered if resolved(topic) not in commands), COMMANDS)
    missing = sorted(wanted - optional - {resolved(topic) for topic in offered})
    if missing:
        there = ", ".join(
            f"{topic.name} ({topic.role}, {topic.message_count} messages)"
            for topic in bag.topics.values()
        )
        raise ConfigurationError(
            f"{bag.path} holds no message of {', '.join(missing)} to replay; "
            f"its topics are {there}; {_advice(bag, missing)}"
        )
    return (*offered, *_true_pictures(bag, {resolved(topic) for topic in offered}))


def _advice(bag: Bag, missing: Collection[str]) -> str:
    """Return how a bag's topics get the names the nodes know: by one namespace if that does it."""
    spaces = {
        name.removesuffix(wanted)
        for wanted in missing
        for name in bag.topics
        if name.endswith(wanted)
    }
    for space in sorted(spaces):
        if all(space + wanted in bag.topics for wanted in missing):
            return f"--namespace {space} takes off {space}."
    return "--remap OLD:=NEW gives a topic the name the nodes know."


def _true_pictures(bag: Bag, inputs: set[str]) -> tuple[Topic, ...]:
    """Return the recorded truth: no node takes it, but recorders, displays and scores do."""
    pictures = {topic.message_type: topic for topic in (TRUE_BEARING_TRACKS, TRUE_TRACKS)}
    return tuple(
        replace(pictures[topic.type_name], name=name.lstrip("/"))
        for name, topic in bag.topics.items()
        if topic.role == "truth"
        and topic.message_count
        and topic.type_name in pictures
        and name not in inputs
    )


def _compared(report: RunReport, comparison: ReplayComparison, same_parameters: bool) -> RunReport:
    """Return the report with the comparison; with the recorded parameters, differing is failing."""
    report = replace(report, comparison=comparison.result())
    if comparison.differs() and same_parameters:
        sentence = "the replay differs from the recording, with the recorded parameters."
        return replace(report, failures=[*report.failures, sentence])
    return report
