"""Markdown tables, and the cells that describe one parameter."""

from __future__ import annotations

from collections.abc import Iterable

from sonar_tracking.configuration import ParameterDescription


def table(header: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> str:
    """Return a Markdown table.

    Parameters
    ----------
    header : tuple of str
        One entry a column.
    rows : iterable of tuple of str
        Cells, of the length of the header; what Markdown would take for markup is escaped.

    Returns
    -------
    str
        Lines joined by newlines, without one at the end.
    """
    lines = [header, tuple("---" for _ in header), *rows]
    escaped = ([cell.replace("|", r"\|").replace("<", "&lt;") for cell in line] for line in lines)
    return "\n".join("| " + " | ".join(line) + " |" for line in escaped)


def parameter_cells(entry: ParameterDescription) -> tuple[str, str, str, str]:
    """Return default, unit, allowed values and description of a parameter."""
    text = sentence(entry.description)
    if entry.changeable:
        text += " Can be changed while the node runs."
    return default_text(entry), entry.unit, _allowed(entry), text


def sentence(text: str) -> str:
    """Return a text on one line, with a capital and a full stop; nothing stays nothing."""
    flat = " ".join(text.split()).rstrip(".")
    return flat[:1].upper() + flat[1:] + "." if flat else ""


def default_text(entry: ParameterDescription) -> str:
    """Return the default of a parameter as it is written in YAML."""
    value = entry.default
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    if isinstance(value, tuple):
        entries = (each if isinstance(each, str) else f"{each:g}" for each in value)
        return "`[" + ", ".join(entries) + "]`"
    text = f"{value:g}" if isinstance(value, float) else str(value)
    return f"`{text}`" if text else ""


def _allowed(entry: ParameterDescription) -> str:
    if entry.choices:
        return ", ".join(f"`{choice}`" for choice in entry.choices)
    low, high = entry.minimum, entry.maximum
    if low is None and high is None:
        return ""
    if high is None:
        return f"≥ {low:g}"
    return f"≤ {high:g}" if low is None else f"{low:g} … {high:g}"
