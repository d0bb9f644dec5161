"""Protects the domain of a worker: what one file's tests leave open is closed before the next."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

FAILS = """
from tests.left_open import opened, closed

def close() -> None:
    closed(close)
    print("closed", flush=True)

def test_that_fails() -> None:
    opened(close)
    raise AssertionError

def test_of_the_same_file() -> None:
    print("same file", flush=True)
"""
GOES_ON = """
def test_of_another_file() -> None:
    print("another file", flush=True)
"""


@pytest.mark.slow
def test_what_a_failed_test_leaves_open_is_closed_after_its_file(tmp_path: Path) -> None:
    (tmp_path / "conftest.py").write_text("from tests.left_open import pytest_runtest_teardown\n")
    (tmp_path / "test_first.py").write_text(FAILS)
    (tmp_path / "test_second.py").write_text(GOES_ON)
    words = [
        "-m",
        "pytest",
        "-sq",
        "--tb=no",
        "-p",
        "no:cacheprovider",
        "-c",
        "/dev/null",
        str(tmp_path),
    ]
    project = Path(__file__).resolve().parents[2]
    ended = subprocess.run(
        [sys.executable, *words], cwd=project, capture_output=True, text=True, check=False
    )
    said = re.findall("same file|closed|another file", ended.stdout)
    assert said == ["same file", "closed", "another file"], ended.stdout
