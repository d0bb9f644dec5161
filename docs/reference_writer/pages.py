"""Writes everything that is made from the code into one folder, for the pages to include."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

from docs.reference_writer.api import PACKAGES, package
from docs.reference_writer.command_line import command_line
from docs.reference_writer.examples import examples
from docs.reference_writer.messages import conventions, messages, odometry
from docs.reference_writer.methods import methods
from docs.reference_writer.nodes import nodes
from docs.reference_writer.scenarios import scenario_keys, scenarios
from docs.reference_writer.topics import topics

FRAGMENTS: dict[str, Callable[[], str]] = {
    "command_line": command_line,
    "examples": examples,
    "message_conventions": conventions,
    "messages": messages,
    "methods": methods,
    "nodes": nodes,
    "odometry": odometry,
    "scenario_keys": scenario_keys,
    "scenarios": scenarios,
    "topics": topics,
    **{f"api_{name}": partial(package, name) for name in PACKAGES},
}


def write_fragments(folder: Path) -> None:
    """Write every fragment to ``<folder>/<name>.md``; one that has not changed stays untouched."""
    folder.mkdir(exist_ok=True)
    for name, make in FRAGMENTS.items():
        file, text = folder / f"{name}.md", make() + "\n"
        if not file.is_file() or file.read_text(encoding="utf-8") != text:
            file.write_text(text, encoding="utf-8")
