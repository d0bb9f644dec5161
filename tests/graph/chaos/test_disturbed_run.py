"""What happens to a run is what was planned, also where its network can be disturbed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("rclpy")

from sonar_tracking.graph.chaos import disturbed_run
from sonar_tracking.graph.chaos.disturbed_run import DisturbedRun
from sonar_tracking.graph.chaos.fault_plan import Fault, FaultKind
from sonar_tracking.graph.chaos.watched_graph import watched_graph


class Noted:
    """Notes in order what it is asked to do, as a network and as a watch."""

    def __init__(self) -> None:
        self.done: list[str] = []

    def __getattr__(self, name: str) -> Any:
        return lambda *arguments: self.done.append(" ".join(map(str, (name, *arguments))))


@pytest.mark.parametrize(
    ("kind", "expected"),
    [
        (FaultKind.KILL, ["signal"]),
        (FaultKind.DELAY, ["slow", "spin 2.0", "quicken"]),
        (FaultKind.PARTITION, ["slow", "spin 10.0", "part", "spin 2.0", "slow"]),
        (FaultKind.NOTHING, []),
    ],
)
def test_in_a_campaign_of_many_kinds_each_fault_is_of_its_own(
    kind: FaultKind, expected: list[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    noted: Any = Noted()
    monkeypatch.setattr(disturbed_run, "_signal_node", lambda *_: noted.done.append("signal"))
    target = "hpda_tracker" if kind is FaultKind.KILL else ""
    run = DisturbedRun(watched_graph("active"), 1.0, tmp_path, lambda: (), noted)
    run._do(1, Fault(kind, target, 0.0, 2.0, 1), noted)
    assert noted.done == expected
