"""Protects the commands that the documentation shows: verbs, options and names that exist."""

from __future__ import annotations

import re
import shlex
from functools import cache
from typing import Any

import pytest

from docs.reference_writer import command_line
from sonar_tracking.evaluation.studies.study_catalogue import DATA_STUDIES, STUDIES
from sonar_tracking.simulation.scenarios.scenario_file import scenario_names
from tests.docs.code_blocks import PROJECT, all_blocks

LANGUAGES = {"console", "python", "yaml", "text"}
BLOCKS = all_blocks()
COMMANDS = sorted(
    {
        line.removeprefix("ros2 run sonar_tracking ")
        for block in BLOCKS
        for line in block.commands
        if re.match(r"(ros2 run sonar_tracking )?sonar-tracking\b", line)
    }
)


@cache
def commands() -> dict[str, Any]:
    """Return every command by its words."""
    return command_line.commands()


def test_every_block_has_a_language_that_is_tested() -> None:
    unknown = {block.language for block in BLOCKS if not block.language.startswith("{")} - LANGUAGES
    assert not unknown


@pytest.mark.parametrize("line", COMMANDS)
def test_command_is_one_of_the_command_line(line: str) -> None:
    words = shlex.split(line)[1:]
    name = " ".join(words[:2]) if " ".join(words[:2]) in commands() else words[0]
    command = commands()[name]
    # Parsing alone: it fails on an option that does not exist or a value of the wrong kind.
    context = command.make_context(name, words[len(name.split()) :])
    if name == "evaluate":
        assert context.params["study"] in {*STUDIES, *DATA_STUDIES}
    if name == "run" and not context.params["scenario"].endswith(".yaml"):
        assert context.params["scenario"] in scenario_names()


def test_every_verb_is_shown_somewhere() -> None:
    shown = " ".join(COMMANDS)
    assert all(f"sonar-tracking {name}" in shown for name in commands())


def test_scripts_that_are_named_exist() -> None:
    text = "\n".join(page.text for page in BLOCKS)
    scripts = set(re.findall(r"\./(scripts/\w+\.sh)", text))
    assert {"scripts/run.sh", "scripts/test.sh"} <= scripts
    assert all((PROJECT / script).is_file() for script in scripts)
