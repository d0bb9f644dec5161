"""The recorder of a run: what it records, and what the bag shall know of its making (no ROS)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path

from sonar_tracking.bags.contents.log_time import CLOCK_TYPE
from sonar_tracking.bags.contents.recording_information import RecordingInformation, Role
from sonar_tracking.bags.storage.reader import Bag, read_bag
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.catalogue.graph_names import GraphNames
from sonar_tracking.graph.catalogue.planned_node import PlannedNode
from sonar_tracking.graph.catalogue.recorder_parameters import RECORDER
from sonar_tracking.graph.catalogue.topics import (
    DIAGNOSTICS_TOPIC,
    FIXED_TRANSFORMS,
    Topic,
    TopicRole,
)
from sonar_tracking.graph.orchestration.graph_plan import resolved
from sonar_tracking.graph.orchestration.topic_record import TopicRecord

_MODULE = "sonar_tracking.graph.nodes.recorder"


def planned_recorder(
    output: Path,
    topics: Iterable[Topic],
    shown: Iterable[Topic],
    information: RecordingInformation,
    names: GraphNames,
    log_directory: Path,
) -> PlannedNode:
    """Return the recorder, and write what the bag shall know into the log directory.

    Parameters
    ----------
    output : Path
        The bag.
    topics : iterable of Topic
        What to record, besides the clock, by full names.
    shown : iterable of Topic
        What to record, too, without that the data wait for it.
    information : RecordingInformation
        What the bag shall know, besides the roles of its topics.
    names : GraphNames
        Of the graph.
    log_directory : Path
        Where files of the run go.
    """
    recorded = sorted(topics, key=lambda topic: topic.name)
    written = [*recorded, *sorted(shown, key=lambda topic: topic.name)]
    roles: dict[str, Role] = {resolved(topic): topic.role.value for topic in written}
    information = replace(information, topic_roles=roles)
    settings = information.node_parameters
    fixed = {FIXED_TRANSFORMS.name: names.of(FIXED_TRANSFORMS)}
    information_file = log_directory / "recording.json"
    information_file.write_text(information.to_json(), encoding="utf-8")
    return PlannedNode(
        name=RECORDER,
        module=_MODULE,
        subscriptions=tuple(recorded),
        parameters={
            "output": str(output.resolve()),
            "topics": (*roles, names.clock),
            "types": (*(topic.message_type for topic in written), CLOCK_TYPE),
            "roles": (*roles.values(), "other"),
            "recording": str(information_file),
            "flow_depth": max(
                int(str(values["flow_depth"]))
                for values in settings.values()
                if "flow_depth" in values
            ),
        },
        remaps={old: new for old, new in fixed.items() if old != new},
    )


def recording_hint(
    output: Path, topics: Mapping[str, Topic], records: Mapping[str, TopicRecord]
) -> str:
    """Return what to say of a finished recording: how the stock ROS 2 tools play its inputs.

    Of one that is not whole, e.g. because the disk was full, what is missing is said instead.

    Parameters
    ----------
    output : Path
        The bag.
    topics : mapping of str to Topic
        All data topics by resolved name.
    records : mapping of str to TopicRecord
        What passed over them; topics without messages are not named.
    """
    inputs = sorted(
        name
        for name, topic in topics.items()
        if topic.role is TopicRole.INPUT and records[name].messages
    )
    try:
        bag = read_bag(output)
    except ConfigurationError as error:
        return f"this run was not recorded: {error}"
    if bag.recovery is not None:
        return f"this run was recorded in part: {bag.recovery}"
    said = f"recorded {output}"
    if inputs:
        said += f"; stock ROS 2 tools play its inputs with: {_play_line(output, inputs)}"
    if shown := _pictures(bag):
        said += f"; and what it shows, to RViz and Foxglove, with: {_play_line(output, shown)}"
    return said


def _play_line(bag: Path, topics: Iterable[str]) -> str:
    return f"ros2 bag play {bag} --clock --topics {' '.join(topics)}"


def _pictures(bag: Bag) -> list[str]:
    """Return the topics for people that hold messages."""
    return [
        topic.name
        for topic in bag.topics.values()
        if topic.role == TopicRole.DISPLAY.value
        and topic.message_count
        and topic.name != DIAGNOSTICS_TOPIC
    ]
