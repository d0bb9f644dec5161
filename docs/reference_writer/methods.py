"""The methods of the stages: from the registries that the nodes' parameters choose from."""

from __future__ import annotations

from collections.abc import Iterator

from docs.reference_writer.tables import sentence, table
from sonar_tracking.configuration import ParameterDescription
from sonar_tracking.graph.catalogue.node_catalogue import NODES
from sonar_tracking.graph.catalogue.node_description import NodeDescription


def methods() -> str:
    """Return the tables of methods of all nodes, one section a node that has a choice."""
    sections = []
    for node in NODES.values():
        if tables := "\n\n".join(method_tables(node)):
            sections.append(f"## {node.name}\n\n{tables}")
    return "\n\n".join(sections)


def method_tables(node: NodeDescription) -> Iterator[str]:
    """Yield the table of methods of every parameter of a node that chooses among methods."""
    for entry in node.parameters:
        if entry.methods is not None:
            yield _method_table(entry)


def _method_table(entry: ParameterDescription) -> str:
    assert entry.methods is not None
    rows = [
        (f"`{row.name}`", sentence(row.description), sentence(row.traits), row.paper)
        for row in entry.methods.table()
    ]
    return table((f"`{entry.name}`", "what it does", "what goes with it", "paper"), rows)
