#!/usr/bin/env python3
"""Write the tables of topics, nodes, parameters and scenarios in README.md from the code.

python scripts/write_reference.py            # rewrites README.md
python scripts/write_reference.py --check    # exit code 1 when README.md is out of date
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path

from sonar_tracking.configuration import ParameterDescription, describe
from sonar_tracking.graph.catalogue.node_catalogue import NODES
from sonar_tracking.graph.catalogue.node_description import NodeDescription
from sonar_tracking.graph.catalogue.topics import Topic, TopicKind
from sonar_tracking.graph.nodes.recorder import PARAMETER_DESCRIPTIONS as RECORDER_PARAMETERS
from sonar_tracking.simulation.scenarios.array_configuration import (
    ArrayConfiguration,
    NoiseConfiguration,
)
from sonar_tracking.simulation.scenarios.bearing_sensor_configuration import (
    BearingSensorConfiguration,
)
from sonar_tracking.simulation.scenarios.contact_configuration import ContactSensorConfiguration
from sonar_tracking.simulation.scenarios.hydrophone_configuration import HydrophoneConfiguration
from sonar_tracking.simulation.scenarios.platforms import OwnShipConfiguration, TurnConfiguration
from sonar_tracking.simulation.scenarios.scenario_file import scenario_names
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario
from sonar_tracking.simulation.scenarios.target import (
    MOTIONS,
    LineConfiguration,
    TargetConfiguration,
)

README = Path(__file__).resolve().parent.parent / "README.md"
BEGIN, END = "<!-- reference: begin -->", "<!-- reference: end -->"
QUALITY = {
    TopicKind.DATA: "reliable, volatile",
    TopicKind.TRACKS: "reliable, transient local",
}


def main() -> int:
    """Rewrite or check the reference in the README; return the exit code."""
    text = README.read_text(encoding="utf-8")
    before, rest = text.split(BEGIN)
    after = rest.split(END)[1]
    current = f"{before}{BEGIN}\n{reference()}\n{END}{after}"
    if "--check" in sys.argv[1:]:
        if current != text:
            print("README.md is out of date; run python scripts/write_reference.py.")
        return int(current != text)
    README.write_text(current, encoding="utf-8")
    return 0


def reference() -> str:
    """Return the whole reference as Markdown."""
    return "\n\n".join(
        [
            "### Topics",
            _topics(),
            *(_node(node) for node in NODES.values()),
            _recorder(),
            *_scenarios(),
        ]
    )


def _topics() -> str:
    topics = {
        topic.name: topic
        for node in NODES.values()
        for topic in (*node.outputs, *node.station_outputs, *node.inputs, *node.markers)
    }
    rows = [
        (f"`{topic.name}`", _message(topic), topic.description, QUALITY[topic.kind])
        for topic in topics.values()
    ]
    rows += [
        (
            "`flow/done`",
            "`sonar_tracking_msgs/Progress`",
            "what each node has published and finished; paces the clock",
            "reliable, volatile",
        ),
        (
            "`/diagnostics`",
            "`diagnostic_msgs/DiagnosticArray`",
            "health of every node, one status a concern",
            "reliable, volatile",
        ),
        (
            "`/clock`",
            "`rosgraph_msgs/Clock`",
            "the time of the data, from the time master or the player",
            "reliable, volatile",
        ),
    ]
    return _table(("topic", "message", "carries", "quality of service"), rows)


def _message(topic: Topic) -> str:
    return f"`{topic.message_type.replace('/msg/', '/')}`"


def _node(node: NodeDescription) -> str:
    flows = []
    inputs = (*node.topic_parameters.values(), *node.inputs, *node.optional_inputs)
    if inputs:
        flows.append("takes " + ", ".join(f"`{topic.name}`" for topic in inputs))
    outputs = (*node.outputs, *node.station_outputs, *node.markers)
    if outputs:
        flows.append("gives " + ", ".join(f"`{topic.name}`" for topic in outputs))
    rows = [(f"`{entry.name}`", *_cells(entry)) for entry in node.parameters]
    table = _table(("parameter", "default", "unit", "allowed", "what it does"), rows)
    introduction = f"{_sentence(node.description)} {_sentence('; '.join(flows))}"
    return f"### `{node.name}`\n\n{introduction}\n\n{table}"


def _recorder() -> str:
    rows = [(f"`{name}`", description) for name, description in RECORDER_PARAMETERS.items()]
    introduction = "Writes topics to a bag, bytes as received. Takes any topics it is told of."
    return f"### `recorder`\n\n{introduction}\n\n{_table(('parameter', 'what it is'), rows)}"


def _scenarios() -> Iterable[str]:
    rows = []
    for name in scenario_names():
        scenario = load_scenario(name)
        rows.append((f"`{name}`", f"{scenario.duration:g}", _sentence(scenario.description)))
    return (
        "### Scenarios",
        _table(("scenario", "seconds", "what it shows"), rows),
        _scenario_keys(),
    )


def _scenario_keys() -> str:
    sections: dict[str, type] = {
        "array": ArrayConfiguration,
        "noise": NoiseConfiguration,
        "own_ship": OwnShipConfiguration,
        "own_ship.turns[]": TurnConfiguration,
        "bearing_sensors[]": BearingSensorConfiguration,
        "active_sonar": ContactSensorConfiguration,
        "hydrophones": HydrophoneConfiguration,
        "targets[]": TargetConfiguration,
        "targets[].lines[]": LineConfiguration,
    }
    sections |= {f"targets[].motion, kind: {kind}": motion for kind, motion in MOTIONS.items()}
    rows = [
        (f"`{section}`", f"`{entry.name}`", *_cells(entry))
        for section, configuration in sections.items()
        for entry in describe(configuration)
    ]
    introduction = (
        "Besides these: `name`, `description`, `epoch` (ISO 8601), `start` and `duration` (s), "
        "`seed`, and `nodes`, the parameters of each node by its name. Times are seconds from the "
        "epoch."
    )
    table = _table(("section", "key", "default", "unit", "allowed", "what it is"), rows)
    return f"### Keys of a scenario file\n\n{introduction}\n\n{table}"


def _cells(entry: ParameterDescription) -> tuple[str, str, str, str]:
    return _default(entry), entry.unit, _allowed(entry), entry.description


def _sentence(text: str) -> str:
    flat = " ".join(text.split()).rstrip(".")
    return flat[:1].upper() + flat[1:] + "."


def _default(entry: ParameterDescription) -> str:
    value = entry.default
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, tuple):
        entries = (each if isinstance(each, str) else f"{each:g}" for each in value)
        return "[" + ", ".join(entries) + "]"
    return f"{value:g}" if isinstance(value, float) else str(value)


def _allowed(entry: ParameterDescription) -> str:
    if entry.choices:
        return ", ".join(entry.choices)
    low, high = entry.minimum, entry.maximum
    if low is None and high is None:
        return ""
    if high is None:
        return f"≥ {low:g}"
    return f"≤ {high:g}" if low is None else f"{low:g} … {high:g}"


def _table(header: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> str:
    lines = [header, tuple("---" for _ in header), *rows]
    escaped = ([cell.replace("|", r"\|").replace("<", "&lt;") for cell in line] for line in lines)
    return "\n".join("| " + " | ".join(line) + " |" for line in escaped)


if __name__ == "__main__":
    sys.exit(main())
