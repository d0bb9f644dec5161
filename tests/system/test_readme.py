"""Protects the README: tables as in the code, files that exist, commands that are known."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[2]
README = (PROJECT / "README.md").read_text(encoding="utf-8")


def test_reference_is_written_from_the_code() -> None:
    check = [sys.executable, str(PROJECT / "scripts" / "write_reference.py"), "--check"]
    done = subprocess.run(check, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_every_linked_file_exists() -> None:
    links = re.findall(r"\]\(([^)#:]+)\)", README)
    assert links
    missing = [link for link in links if not (PROJECT / link).exists()]
    assert not missing


def test_every_verb_of_the_command_line_exists() -> None:
    verbs = set(re.findall(r"^sonar-tracking (\w+)", README, flags=re.MULTILINE))
    done = subprocess.run(
        [sys.executable, "-m", "sonar_tracking.cli", "--help"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert verbs
    assert all(re.search(rf"^\W*{verb}\b", done.stdout, flags=re.MULTILINE) for verb in verbs)


def test_listener_of_the_readme_compiles() -> None:
    (listener,) = re.findall(r"```python\n(.*?)```", README, flags=re.DOTALL)
    assert len(listener.splitlines()) <= 12
    compile(listener, "README.md", "exec")
