"""The methods of the stages: from the registries that the nodes' parameters choose from."""

from __future__ import annotations

from typing import Any

from docs.reference_writer.tables import sentence, table
from sonar_tracking.graph.catalogue.node_catalogue import NODES
from sonar_tracking.method_registry import MethodRegistry


def methods() -> str:
    """Return a section for every node that has a choice, with a table for every parameter."""
    sections = []
    for node in NODES.values():
        tables = [
            methods_table(f"`{entry.name}`", entry.methods)
            for entry in node.parameters
            if entry.methods is not None
        ]
        if tables:
            sections.append("\n\n".join([f"## {node.name}", *tables]))
    return "\n\n".join(sections)


def methods_table(heading: str, registry: MethodRegistry[Any]) -> str:
    """Return the methods of a registry, one a row.

    Parameters
    ----------
    heading : str
        Of the column of names.
    registry : MethodRegistry
        The methods.
    """
    rows = [
        (f"`{row.name}`", sentence(row.description), sentence(row.traits), row.paper)
        for row in registry.table()
    ]
    return table((heading, "what it does", "what goes with it", "paper"), rows)
