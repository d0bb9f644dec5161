"""Runs the examples as a reader would, and keeps them short and to the public interface."""

from __future__ import annotations

import ast
import importlib
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.system.command_line import environment

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
PATIENCE = 120.0
FILES = sorted(path.name for path in EXAMPLES.glob("*.py"))
WITH_ROS = "06_a_node_of_your_own.py"
LARK = "ignore:module 'sre_:DeprecationWarning"
"""A warning of lark, which the message packages import."""
MODULES = {"configuration", "errors", "geometry", "motion"}
"""Modules at the top of the package; of packages only what they export is public."""


def imports_of(file: str) -> Iterator[tuple[str, str]]:
    """Yield module and name of everything an example imports of the project."""
    for node in ast.walk(ast.parse((EXAMPLES / file).read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("sonar_tracking."):
            for alias in node.names:
                yield str(node.module), alias.name


def printed(file: str, folder: Path) -> str:
    """Return what an example prints; warnings are errors."""
    done = subprocess.run(
        [sys.executable, "-W", "error", "-W", LARK, str(EXAMPLES / file)],
        cwd=folder,
        env=environment(folder),
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert not done.stderr
    return done.stdout


def numbers(line: str) -> list[float]:
    return [float(each) for each in re.findall(r"-?\d+(?:\.\d+)?", line)]


def test_there_are_six_in_growing_order() -> None:
    assert [file[:3] for file in FILES] == [f"0{number}_" for number in range(1, 7)]


@pytest.mark.parametrize("file", FILES)
def test_an_example_is_short_and_says_what_it_shows(file: str) -> None:
    text = (EXAMPLES / file).read_text(encoding="utf-8")
    assert len(text.splitlines()) < 60
    assert len((ast.get_docstring(ast.parse(text)) or "").splitlines()) >= 3


@pytest.mark.parametrize("file", FILES)
def test_an_example_uses_what_is_public(file: str) -> None:
    for module, name in imports_of(file):
        if module.removeprefix("sonar_tracking.") in MODULES:
            continue
        # Read, not resolved: that would need ROS for some.
        assert name in importlib.import_module(module).__all__, f"{module}.{name}"


@pytest.mark.slow
def test_music_tells_apart_what_the_beamformer_does_not(tmp_path: Path) -> None:
    lines = printed(FILES[0], tmp_path).splitlines()
    found = {line.split("  ")[0]: numbers(line) for line in lines}
    assert found["sources by MDL 3"] == [3.0]
    assert len(found["beamformer"]) == 2
    assert found["MUSIC"] == pytest.approx([-30.0, 10.0, 14.0], abs=0.5)


@pytest.mark.slow
def test_the_range_is_known_after_the_turn_and_not_before(tmp_path: Path) -> None:
    lines = printed(FILES[1], tmp_path).splitlines()
    before, after = numbers(lines[3]), numbers(lines[-2])
    assert (before[0], after[0]) == (600.0, 1500.0)
    assert before[3] > 1000.0 and before[-1] < 0.1
    assert after[1] == pytest.approx(after[2], rel=0.03)
    assert after[3] < 200.0 and after[-1] > 0.9
    assert after[4] == pytest.approx(200.0, abs=3.0)


@pytest.mark.slow
def test_both_targets_keep_their_tracks_through_the_crossing(tmp_path: Path) -> None:
    rows = [numbers(line) for line in printed(FILES[2], tmp_path).splitlines()[1:]]
    pings = sorted({row[0] for row in rows})
    names = [{row[2] for row in rows if row[0] == ping} for ping in pings]
    assert pings == [5.0, 30.0, 60.0, 110.0]
    assert len(names[0]) == 2 and all(each == names[0] for each in names)


@pytest.mark.slow
def test_the_errors_meet_the_bound_at_high_levels(tmp_path: Path) -> None:
    rows = [numbers(line) for line in printed(FILES[3], tmp_path).splitlines()[1:]]
    level, resolved, music, fit, bound = rows[-1]
    assert (level, resolved) == (20.0, 100.0)
    assert music == pytest.approx(bound, rel=0.15) and fit == pytest.approx(bound, rel=0.15)
    assert rows[0][1] < 20.0
    assert all(row[3] > 0.97 * row[4] for row in rows)


@pytest.mark.slow
def test_a_bag_is_made_and_read(tmp_path: Path) -> None:
    text = printed(FILES[4], tmp_path)
    assert "The bag is whole." in text
    assert re.search(r"/active/contacts +30 input +sonar_tracking_msgs/msg/Contacts", text)
    assert text.splitlines()[-1].endswith("5.0 m/s")
    assert not list(tmp_path.glob("*.csv"))


@pytest.mark.graph
def test_a_node_of_ones_own_thins_the_contacts_and_keeps_the_tracks(tmp_path: Path) -> None:
    rows = [numbers(line) for line in printed(WITH_ROS, tmp_path).splitlines()]
    assert [row[0] for row in rows] == [20.0, 40.0, 60.0, 80.0, 100.0, 120.0]
    assert all(0.2 < passed_on / received < 0.5 for _, received, passed_on, _ in rows)
    assert all(3 <= tracks <= 5 for *_, tracks in rows)
