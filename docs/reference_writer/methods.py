"""The methods of the stages: from the registries that the nodes' parameters choose from."""

from __future__ import annotations

from docs.reference_writer.tables import sentence, table
from sonar_tracking.configuration import ParameterDescription
from sonar_tracking.graph.catalogue.node_catalogue import NODES


def methods() -> str:
    """Return a section for every node that has a choice, with a table for every parameter."""
    sections = []
    for node in NODES.values():
        if tables := [_table(entry) for entry in node.parameters if entry.methods is not None]:
            sections.append("\n\n".join([f"## {node.name}", *tables]))
    return "\n\n".join(sections)


def _table(entry: ParameterDescription) -> str:
    assert entry.methods is not None
    rows = [
        (f"`{row.name}`", sentence(row.description), sentence(row.traits), row.paper)
        for row in entry.methods.table()
    ]
    return table((f"`{entry.name}`", "what it does", "what goes with it", "paper"), rows)
