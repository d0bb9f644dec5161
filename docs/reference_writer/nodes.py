"""The nodes and their parameters: from the catalogue of nodes and its configurations."""

from __future__ import annotations

from docs.reference_writer.tables import parameter_cells, sentence, table
from sonar_tracking.graph.catalogue.node_catalogue import NODES
from sonar_tracking.graph.catalogue.node_description import NodeDescription
from sonar_tracking.graph.catalogue.recorder_parameters import RECORDER_PARAMETERS
from sonar_tracking.graph.catalogue.topics import COMMANDS


def nodes() -> str:
    """Return one section a node."""
    return "\n\n".join([*map(_node, NODES.values()), _recorder()])


def _node(node: NodeDescription) -> str:
    flows = []
    commands = () if node.commanded_topic is None else (COMMANDS,)
    inputs = (*node.topic_parameters.values(), *node.inputs, *node.optional_inputs, *commands)
    if inputs:
        flows.append("takes " + ", ".join(f"`{topic.name}`" for topic in inputs))
    outputs = (*node.outputs, *node.station_outputs, *node.markers)
    if outputs:
        flows.append("gives " + ", ".join(f"`{topic.name}`" for topic in outputs))
    rows = [(f"`{entry.name}`", *parameter_cells(entry)) for entry in node.parameters]
    parameters = table(("parameter", "default", "unit", "allowed", "what it does"), rows)
    introduction = f"{sentence(node.description)} {sentence('; '.join(flows))}"
    return f"## {node.name}\n\n{introduction}\n\n{parameters}"


def _recorder() -> str:
    rows = [(f"`{name}`", sentence(text)) for name, text in RECORDER_PARAMETERS.items()]
    introduction = "Writes topics to a bag, bytes as received. Takes any topics it is given."
    return f"## recorder\n\n{introduction}\n\n{table(('parameter', 'what it is'), rows)}"
