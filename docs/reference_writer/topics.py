"""The topics: from the catalogue of nodes, with those every graph has."""

from __future__ import annotations

from docs.reference_writer.tables import sentence, table
from sonar_tracking.graph.catalogue.node_catalogue import NODES
from sonar_tracking.graph.catalogue.topics import COMMANDS, REQUESTS, Topic, TopicKind

QUALITY = {
    TopicKind.DATA: "reliable, volatile",
    TopicKind.TRACKS: "reliable, transient local",
    TopicKind.COMMANDS: "reliable, transient local, all of a run",
}
OF_EVERY_GRAPH = (
    (
        "flow/done",
        "sonar_tracking_msgs/Progress",
        "what each node has published and finished; paces the clock",
    ),
    (
        "/diagnostics",
        "diagnostic_msgs/DiagnosticArray",
        "health of every node, one status a concern",
    ),
    (
        "/clock",
        "rosgraph_msgs/Clock",
        "the time of the data, from the time master or the player",
    ),
)


def topics() -> str:
    """Return the table of all topics."""
    known = {
        topic.name: topic
        for node in NODES.values()
        for topic in (*node.outputs, *node.station_outputs, *node.inputs, *node.markers)
    }
    known |= {topic.name: topic for topic in (REQUESTS, COMMANDS)}
    rows = [
        (f"`{topic.name}`", _message(topic), sentence(topic.description), QUALITY[topic.kind])
        for topic in known.values()
    ]
    rows += [
        (f"`{name}`", f"`{message}`", sentence(description), QUALITY[TopicKind.DATA])
        for name, message, description in OF_EVERY_GRAPH
    ]
    return table(("topic", "message", "carries", "quality of service"), rows)


def _message(topic: Topic) -> str:
    package, name = topic.message_type.split("/msg/")
    if package == "sonar_tracking_msgs":
        return f"[{name}](messages.md#{name.lower()})"
    return f"`{package}/{name}`"
