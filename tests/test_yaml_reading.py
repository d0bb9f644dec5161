"""Protects that YAML says the same whoever reads it, and that no text of it ends the process."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from sonar_tracking.resources import find_resource
from sonar_tracking.yaml_reading import read_yaml


class Plain:
    """Replaces nothing."""


FILES = sorted(find_resource("config").rglob("*.yaml"))


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_libyaml_reads_what_pyyaml_reads(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert read_yaml(text, Plain) == yaml.safe_load(text)


def test_it_does_without_libyaml(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr(yaml, "CSafeLoader", raising=False)
    assert read_yaml("a: [1, 2.5, yes]", Plain) == {"a": [1, 2.5, True]}


@pytest.mark.parametrize(
    "text",
    ["- " * 50_000, "? " * 50_000, "[" * 2_000, "{a: " * 2_000, "- [" * 999 + "- " * 999],
    ids=["entries", "keys", "lists", "mappings", "both"],
)
def test_what_is_nested_too_deeply_is_an_error(text: str) -> None:
    with pytest.raises((RecursionError, yaml.YAMLError)):
        read_yaml(text, Plain)


def test_the_sentence_of_an_error_is_that_of_pyyaml() -> None:
    with pytest.raises(yaml.YAMLError) as wanted:
        yaml.safe_load("a: [1, 2\nb: 3\n")
    with pytest.raises(yaml.YAMLError) as found:
        read_yaml("a: [1, 2\nb: 3\n", Plain)
    assert str(found.value) == str(wanted.value)
