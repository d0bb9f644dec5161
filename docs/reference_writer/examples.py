"""The examples: what each shows, and its text."""

from __future__ import annotations

import ast
from pathlib import Path

FOLDER = Path(__file__).resolve().parents[2] / "examples"


def examples() -> str:
    """Return one section an example, in their order."""
    return "\n\n".join(map(_example, sorted(FOLDER.glob("[0-9]*.py"))))


def _example(path: Path) -> str:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    about = ast.get_docstring(tree) or ""
    first_line = (tree.body[0].end_lineno or 0) + 2  # after what is said above it already
    number, _, words = path.stem.partition("_")
    title = words.replace("_", " ")
    return (
        f"## {int(number)}. {title[:1].upper()}{title[1:]}\n\n{about}\n\n"
        f"```{{literalinclude}} /../examples/{path.name}\n:language: python\n"
        f":caption: examples/{path.name}\n:lines: {first_line}-\n```"
    )
