"""Protects plain English in the field's terms, in the documentation and in the code."""

from __future__ import annotations

import re

import pytest

from tests.docs.code_blocks import PAGES, PROJECT

INSTEAD = {
    r"told once": "reported once",
    r"told twice": "appears twice",
    r"names? kept|keep their names": "identity maintained",
    r"without ears": "bearings only",
    r"to nobody|of nobody|nobody's": "unassociated",
    r"= not told\b": "unknown, or not given",
}
SOURCES = [
    *(PROJECT / "src").rglob("*.py"),
    *(path for path in (PROJECT / "tests").rglob("*.py") if path.name != "test_vocabulary.py"),
    *(PROJECT / "config").rglob("*.yaml"),
    *(PROJECT / "msg_defs" / "msg").glob("*.msg"),
    *PAGES,
]


@pytest.mark.parametrize(("private", "standard"), INSTEAD.items())
def test_terms_are_those_of_the_field(private: str, standard: str) -> None:
    found = [
        f"{path.relative_to(PROJECT)}: {match[0]}"
        for path in SOURCES
        for match in re.finditer(private, " ".join(path.read_text(encoding="utf-8").split()))
    ]
    assert not found, f"say {standard!r}"
