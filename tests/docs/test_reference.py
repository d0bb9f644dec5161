"""Protects the reference: everything the code has is in it, and every piece is on a page."""

from __future__ import annotations

import re

import pytest

from docs.reference_writer.messages import DEFINITIONS
from docs.reference_writer.pages import FRAGMENTS
from docs.reference_writer.parameter_files import FOLDER, outdated_files
from docs.reference_writer.scenarios import SECTIONS
from sonar_tracking.configuration import describe
from sonar_tracking.graph.catalogue.node_catalogue import NODES
from sonar_tracking.graph.catalogue.node_settings import read_settings, resolved_settings
from sonar_tracking.simulation.scenarios.scenario_file import scenario_names
from tests.docs.code_blocks import PAGES, PROJECT

WRITTEN = {name: make() for name, make in FRAGMENTS.items()}


@pytest.mark.parametrize("name", sorted(FRAGMENTS))
def test_fragment_is_included_by_a_page(name: str) -> None:
    assert any(f"_written/{name}.md" in page.read_text(encoding="utf-8") for page in PAGES)


@pytest.mark.parametrize("name", sorted(NODES))
def test_node_has_all_its_parameters_and_topics(name: str) -> None:
    section = WRITTEN["nodes"].split(f"## {name}\n")[1].split("\n## ")[0]
    node = NODES[name]
    for entry in node.parameters:
        (row,) = re.findall(rf"^\| `{entry.name}` \|.*$", section, flags=re.MULTILINE)
        assert entry.unit in row
        assert all(choice in row for choice in entry.choices)
    for topic in (*node.outputs, *node.inputs):
        assert f"`{topic.name}`" in section
        assert f"`{topic.name}`" in WRITTEN["topics"]


def test_parameter_files_are_as_the_configurations_say() -> None:
    outdated = [path.name for path in outdated_files()]
    assert not outdated, "run python -m docs.reference_writer.parameter_files"
    assert sorted(path.stem for path in FOLDER.iterdir()) == sorted(NODES)


@pytest.mark.parametrize("name", sorted(NODES))
def test_a_parameter_file_gives_every_parameter_its_default(name: str) -> None:
    given = read_settings(FOLDER / f"{name}.yaml")
    assert list(given) == [name]
    assert len(given[name]) == len(NODES[name].parameters)
    node = (NODES[name],)
    assert resolved_settings(given, node, "file") == resolved_settings({}, node, "default")


def test_every_field_of_every_message_is_described() -> None:
    for path in DEFINITIONS.glob("*.msg"):
        section = WRITTEN["messages"].split(f"## {path.stem}\n")[1].split("\n## ")[0]
        lines = [line for line in path.read_text().splitlines() if line and line[0] != "#"]
        for line in lines:
            name = line.split()[1].partition("=")[0]
            (row,) = re.findall(rf"^\| `{name}`.*$", section, flags=re.MULTILINE)
            comment = line.partition("#")[2].strip()
            assert comment.replace("[", r"\[").replace("|", r"\|").replace("<", "&lt;") in row


def test_every_scenario_and_every_key_is_in_the_reference() -> None:
    assert all(f"| `{name}` |" in WRITTEN["scenarios"] for name in scenario_names())
    for section, configuration in SECTIONS.items():
        text = WRITTEN["scenario_keys"].split(f"### `{section}`\n")[1].split("\n### ")[0]
        assert all(f"| `{entry.name}` |" in text for entry in describe(configuration))


def test_every_linked_file_exists() -> None:
    for page in PAGES:
        text = re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)
        for link in re.findall(r"\]\(([^)#:\s]+)(?:#[^)]*)?\)", text):
            assert (page.parent / link).exists(), f"{page.relative_to(PROJECT)}: {link}"


def test_readme_is_short_and_names_the_two_commands() -> None:
    text = (PROJECT / "README.md").read_text(encoding="utf-8")
    assert len(text.splitlines()) <= 200
    assert "./scripts/run.sh" in text
    assert "./scripts/test.sh" in text
