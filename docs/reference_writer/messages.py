"""The messages: from the comments of their definitions, and from the table of how they are read."""

from __future__ import annotations

import re
from pathlib import Path

from docs.reference_writer.tables import table
from sonar_tracking.message_reading.field_use import FIELD_USES, FieldUse, Unfilled

DEFINITIONS = Path(__file__).resolve().parents[2] / "msg_defs" / "msg"
LINE = re.compile(r"(?P<type>\S+)\s+(?P<name>[^\s=#]+)(=(?P<value>\S+))?\s*(#\s*(?P<text>.*))?")

UNFILLED = {
    Unfilled.REQUIRED: "**must be filled in**",
    Unfilled.UNKNOWN: "unknown",
    Unfilled.COLUMN: "unknown",
    Unfilled.POSE: "[see above](#what-is-not-filled-in)",
    Unfilled.VALUE: "",
}
"""What a field says that was left as it is in a new message."""


def messages() -> str:
    """Return one section a message."""
    return "\n\n".join(_message(path) for path in sorted(DEFINITIONS.glob("*.msg")))


def conventions() -> str:
    """Return the lines that all messages of data have in common."""
    about = [_comment(path)[1:] for path in sorted(DEFINITIONS.glob("*.msg"))]
    lines = [line for line in about[0] if line and sum(line in other for other in about) > 1]
    return "\n".join(f"- {line}." for line in " ".join(lines).rstrip(".").split(". "))


def odometry() -> str:
    """Return the table of what is read of odometry, which is a message of others."""
    uses = FIELD_USES["Odometry"].items()
    return table(("field", "if it is left"), ((f"`{name}`", left(use)) for name, use in uses))


def left(use: FieldUse | None) -> str:
    """Return what a field says that was left as it is in a new message; None = is not data."""
    if use is None:
        return ""
    text = use.condition if use.unfilled is Unfilled.REQUIRED else use.text
    return "; ".join(filter(None, (UNFILLED[use.unfilled], text)))


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
            use = FIELD_USES.get(path.stem, {}).get(entry["name"])
            fields.append((f"`{entry['name']}`", f"`{entry['type']}`", text, left(use)))
    columns = 4 if path.stem in FIELD_USES else 3
    header = ("field", "type", "is", "if it is left as in a new message")[:columns]
    rows = [row[:columns] for row in fields]
    parts = [f"## {path.stem}", first, "\n".join(own), table(header, rows)]
    if constants:
        parts.append(table(("constant", "means"), constants))
    return "\n\n".join(filter(None, parts))


def _comment(path: Path) -> list[str]:
    """Return the lines of the comment a definition begins with."""
    lines = path.read_text(encoding="utf-8").splitlines()
    n_lines = next(index for index, line in enumerate(lines) if not line.startswith("#"))
    return [line.lstrip("# ") for line in lines[:n_lines]]
