"""Protects: files and functions stay small enough to be read at one go."""

from __future__ import annotations

import ast
import inspect
import statistics
from collections.abc import Iterator
from pathlib import Path

import sonar_tracking

LONGEST_FILE, LONGEST_FUNCTION, MEDIAN_FUNCTION = 350, 60, 10
"""Lines, docstrings included."""

PACKAGE = Path(inspect.getfile(sonar_tracking)).parent
SOURCES = {str(path.relative_to(PACKAGE)): path.read_text() for path in PACKAGE.rglob("*.py")}


def functions() -> Iterator[tuple[str, int]]:
    """Yield every function and its length."""
    for name, text in SOURCES.items():
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                yield f"{name}: {node.name}", (node.end_lineno or 0) - node.lineno + 1


def test_no_file_is_long() -> None:
    assert not [name for name, text in SOURCES.items() if text.count("\n") > LONGEST_FILE]


def test_no_function_is_long_and_most_are_short() -> None:
    lengths = list(functions())
    assert not [name for name, length in lengths if length > LONGEST_FUNCTION]
    assert statistics.median(length for _, length in lengths) <= MEDIAN_FUNCTION
