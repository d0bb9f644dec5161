"""Processes are started, watched, and stopped in bounded time whatever they do."""

import os
import signal
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from sonar_tracking.graph.orchestration import process_supervisor
from sonar_tracking.graph.orchestration.process_supervisor import (
    ProcessPlan,
    ProcessSupervisor,
    SupervisedProcess,
)

POLITE = """
import signal, time
stop = []
signal.signal(signal.SIGINT, lambda *_: stop.append(1))
print("ready", flush=True)
while not stop:
    time.sleep(0.01)
"""
STUBBORN = """
import signal, time
signal.signal(signal.SIGINT, signal.SIG_IGN)
signal.signal(signal.SIGTERM, signal.SIG_IGN)
print("ready", flush=True)
while True:
    time.sleep(0.01)
"""


@pytest.fixture
def plan(tmp_path: Path) -> Callable[[str], ProcessPlan]:
    def make(text: str) -> ProcessPlan:
        (tmp_path / "a_node.py").write_text(text)
        environment = {**os.environ, "PYTHONPATH": str(tmp_path)}
        return ProcessPlan("node", "a_node", (), environment)

    return make


def wait_for(condition: Callable[[], bool]) -> None:
    deadline = time.monotonic() + 20.0
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.01)


def test_a_polite_process_ends_with_code_zero(
    tmp_path: Path, plan: Callable[[str], ProcessPlan]
) -> None:
    supervisor = ProcessSupervisor(tmp_path)
    supervisor.start(plan(POLITE))
    wait_for(lambda: "ready" in supervisor.log_tail("node"))
    supervisor.stop(["node"])
    process = supervisor.processes["node"]
    assert process.exit_code == 0
    assert process.unexpected_exits == 0
    assert process.cpu_seconds > 0.0


def test_a_stubborn_process_is_killed(
    tmp_path: Path, plan: Callable[[str], ProcessPlan], monkeypatch: pytest.MonkeyPatch
) -> None:
    stages = ((signal.SIGINT, 0.2), (signal.SIGTERM, 0.2), (signal.SIGKILL, 10.0))
    monkeypatch.setattr(process_supervisor, "STOP_STAGES", stages)
    supervisor = ProcessSupervisor(tmp_path)
    supervisor.start(plan(STUBBORN))
    wait_for(lambda: "ready" in supervisor.log_tail("node"))
    supervisor.stop(["node"])
    assert supervisor.processes["node"].exit_code == -signal.SIGKILL


def test_a_death_is_reported_once_and_the_next_process_has_its_own_log_tail(
    tmp_path: Path, plan: Callable[[str], ProcessPlan]
) -> None:
    supervisor = ProcessSupervisor(tmp_path)
    supervisor.start(plan("raise SystemExit('the sky falls')"))
    ended: list[SupervisedProcess] = []

    def has_ended() -> bool:
        ended.extend(supervisor.poll())
        return bool(ended)

    wait_for(has_ended)
    assert [process.plan.name for process in ended] == ["node"]
    assert supervisor.poll() == []
    assert ended[0].exit_code == 1
    assert "the sky falls" in supervisor.log_tail("node")
    supervisor.start(plan(POLITE))
    wait_for(lambda: supervisor.log_tail("node") == "ready")
    assert supervisor.processes["node"].restarts == 1
    supervisor.stop(["node"])


def test_a_process_that_ends_just_before_it_is_told_to_is_still_accounted_for(
    tmp_path: Path, plan: Callable[[str], ProcessPlan]
) -> None:
    supervisor = ProcessSupervisor(tmp_path)
    supervisor.start(plan("raise SystemExit(3)"))
    pid = supervisor.processes["node"].popen.pid
    # Ended, but not collected yet.
    os.waitid(os.P_PID, pid, os.WEXITED | os.WNOWAIT)
    supervisor.stop(["node"])
    assert supervisor.processes["node"].exit_code == 3
    assert supervisor.running() == []
