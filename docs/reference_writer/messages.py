"""The messages: from the comments of their definitions."""

from __future__ import annotations

import re
from pathlib import Path

from docs.reference_writer.tables import table

DEFINITIONS = Path(__file__).resolve().parents[2] / "msg_defs" / "msg"
LINE = re.compile(r"(?P<type>\S+)\s+(?P<name>[^\s=#]+)(=(?P<value>\S+))?\s*(#\s*(?P<text>.*))?")


def messages() -> str:
    """Return one section a message."""
    return "\n\n".join(_message(path) for path in sorted(DEFINITIONS.glob("*.msg")))


def conventions() -> str:
    """Return the lines that all messages of data have in common."""
    about = [_comment(path)[1:] for path in sorted(DEFINITIONS.glob("*.msg"))]
    lines = [line for line in about[0] if line and sum(line in other for other in about) > 1]
    return "\n".join(f"- {line}." for line in " ".join(lines).rstrip(".").split(". "))


def _message(path: Path) -> str:
    lines = path.read_text(encoding="utf-8").splitlines()
    first, *rest = _comment(path)
    shared = conventions()
    own = [line for line in rest if line.rstrip(".").split(". ")[0] not in shared]
    entries = [LINE.fullmatch(line) for line in lines if line and not line.startswith("#")]
    fields, constants = [], []
    for entry in filter(None, entries):
        text = (entry["text"] or "").replace("[", r"\[")
        if entry["value"]:
            constants.append((f"`{entry['name']}` = {entry['value']}", text))
        else:
            fields.append((f"`{entry['name']}`", f"`{entry['type']}`", text))
    parts = [f"## {path.stem}", first, "\n".join(own), table(("field", "type", "is"), fields)]
    if constants:
        parts.append(table(("constant", "means"), constants))
    return "\n\n".join(filter(None, parts))


def _comment(path: Path) -> list[str]:
    """Return the lines of the comment a definition begins with."""
    lines = path.read_text(encoding="utf-8").splitlines()
    n_lines = next(index for index, line in enumerate(lines) if not line.startswith("#"))
    return [line.lstrip("# ") for line in lines[:n_lines]]
