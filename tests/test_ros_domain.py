"""Protects: no two processes of tests have one ROS domain, and none has that of somebody's run."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from sonar_tracking.graph.orchestration.domain_lock import domain_lock
from tests.ros_domain import LARGEST_DOMAIN, ros_domain

PROJECT = Path(__file__).resolve().parents[1]


def domain_of_another_process(**environment: str) -> int:
    done = subprocess.run(
        [sys.executable, "-c", "from tests.ros_domain import ros_domain; print(ros_domain())"],
        cwd=PROJECT,
        env={**os.environ, **environment},
        stdout=subprocess.PIPE,
        text=True,
        check=True,
    )
    return int(done.stdout)


def test_another_process_has_another_domain() -> None:
    assert ros_domain() == ros_domain()
    assert domain_of_another_process() != ros_domain()
    assert 1 <= ros_domain() <= LARGEST_DOMAIN


def test_a_domain_in_which_somebody_works_is_passed_over(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTEST_XDIST_WORKER", "nobody")
    free = domain_of_another_process()
    monkeypatch.setenv("ROS_DOMAIN_ID", str(free))
    assert domain_of_another_process() != free
    with domain_lock():
        assert domain_of_another_process(ROS_DOMAIN_ID="0") != free
