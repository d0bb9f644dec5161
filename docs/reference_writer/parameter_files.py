"""Writes the parameter files of ``config/parameters`` from the catalogue of nodes.

    python -m docs.reference_writer.parameter_files [--check]

With ``--check`` nothing is written; the exit code is 1 if a file is not what it would be.
"""

from __future__ import annotations

import sys
import textwrap
from pathlib import Path

import yaml

from docs.reference_writer.tables import sentence
from sonar_tracking.configuration import ParameterDescription, range_text
from sonar_tracking.graph.catalogue.node_catalogue import NODES
from sonar_tracking.graph.catalogue.node_description import NodeDescription

FOLDER = Path(__file__).resolve().parents[2] / "config" / "parameters"
_WIDTH = 100
_HEAD = (
    "Every parameter at its default. Copy the lines that you change into a file of your own: what "
    "a file says goes before a scenario."
)


def parameter_file(node: NodeDescription) -> str:
    """Return a parameter file of one node, in the form of ROS and for any namespace."""
    head = f"{node.name} {node.description}. {_HEAD}"
    lines = [*_comment(head, ""), f"/**/{node.name}:", "  ros__parameters:"]
    for entry in node.parameters:
        lines += [*_comment(_text(entry), "    "), f"    {entry.name}: {_value(entry.default)}"]
    return "\n".join(lines) + "\n"


def outdated_files() -> dict[Path, str]:
    """Return what has to be written where, without files that are as they should be."""
    files = {FOLDER / f"{node.name}.yaml": parameter_file(node) for node in NODES.values()}
    return {
        path: text
        for path, text in files.items()
        if not path.is_file() or path.read_text(encoding="utf-8") != text
    }


def _text(entry: ParameterDescription) -> str:
    allowed = ""
    if entry.choices:
        allowed = f"one of {', '.join(entry.choices)}"
    elif entry.minimum is not None or entry.maximum is not None:
        allowed = ("each " if entry.kind is tuple else "") + range_text(entry)
    elif entry.unit:
        allowed = f"in {entry.unit}"
    changeable = "can be changed while the node runs" if entry.changeable else ""
    return " ".join(sentence(text) for text in (entry.description, allowed, changeable) if text)


def _comment(text: str, indent: str) -> list[str]:
    start = f"{indent}# "
    return textwrap.wrap(
        text, _WIDTH, initial_indent=start, subsequent_indent=start, break_on_hyphens=False
    )


def _value(value: object) -> str:
    plain = list(value) if isinstance(value, tuple) else value
    text = yaml.safe_dump(plain, default_flow_style=True, width=1000)
    return text.removesuffix("...\n").strip()


def main(arguments: list[str]) -> int:
    """Write the files that are out of date, or name them."""
    outdated = outdated_files()
    if arguments == ["--check"]:
        for path in outdated:
            print(f"{path} is not what the configurations say; write it again.")
        return int(bool(outdated))
    FOLDER.mkdir(exist_ok=True)
    for path, text in outdated.items():
        path.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
