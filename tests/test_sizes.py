"""Protects: files and functions stay small enough to be read at one go."""

from __future__ import annotations

import ast
import statistics
from collections.abc import Iterator

from tests.package_source import FILES, PACKAGE, nodes_of, text_of

LONGEST_FILE, LONGEST_FUNCTION, MEDIAN_FUNCTION = 350, 60, 10
"""Lines, docstrings included."""

SOURCES = {str(path.relative_to(PACKAGE)): path for path in FILES}


def functions() -> Iterator[tuple[str, int]]:
    """Yield every function and its length."""
    for name, path in SOURCES.items():
        for node in nodes_of(path):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                yield f"{name}: {node.name}", (node.end_lineno or 0) - node.lineno + 1


def test_no_file_is_long() -> None:
    assert not [name for name, path in SOURCES.items() if text_of(path).count("\n") > LONGEST_FILE]


def test_no_function_is_long_and_most_are_short() -> None:
    lengths = list(functions())
    assert not [name for name, length in lengths if length > LONGEST_FUNCTION]
    assert statistics.median(length for _, length in lengths) <= MEDIAN_FUNCTION
