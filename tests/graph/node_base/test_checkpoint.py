"""Protects what a tracker is restarted with: the whole state of its own run, or nothing."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

from sonar_tracking.graph.catalogue import resumption, run_identity
from sonar_tracking.graph.node_base import checkpoint
from sonar_tracking.graph.node_base.checkpoint import Checkpoint
from sonar_tracking.records.time import NANOSECONDS

BEGIN = 1_800_000_000 * NANOSECONDS


class Tracker:
    """A process of a tracker."""

    def __init__(self, state: Any = None) -> None:
        self.tracks = state
        self.said: list[str] = []
        self.checkpoint = Checkpoint(
            lambda: self.tracks, self._take, lambda *words: self.said.append(words[-1])
        )

    def _take(self, state: Any) -> None:
        self.tracks = state


@pytest.fixture(autouse=True)
def path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Let the run keep checkpoints."""
    path = tmp_path / "tracker.checkpoint"
    monkeypatch.setenv(resumption.CHECKPOINT, str(path))
    monkeypatch.setenv(run_identity.VARIABLE, "a run")
    monkeypatch.setattr(checkpoint, "SHARE", math.inf)
    monkeypatch.setattr(checkpoint, "LEAST_PAUSE", 0.0)
    return path


def taken_up(seconds: float) -> Any:
    """Return what a new process goes on with, so long after the begin."""
    tracker = Tracker()
    tracker.checkpoint.take_up(BEGIN + round(seconds * NANOSECONDS))
    return tracker.tracks


def test_a_new_process_goes_on_with_the_last_state(path: Path) -> None:
    tracker = Tracker([1])
    tracker.checkpoint.keep(BEGIN)
    tracker.tracks = [1, 2]
    tracker.checkpoint.keep(BEGIN + NANOSECONDS)
    assert taken_up(1.5) == [1, 2]
    assert [each.name for each in path.parent.iterdir()] == [path.name]


def test_checkpoints_take_a_small_share_of_the_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each is followed by a pause that is as much longer as it has taken."""
    clock = iter([0.0, 0.1, 4.9, 5.2, 5.3])
    monkeypatch.setattr(checkpoint, "SHARE", 0.02)
    monkeypatch.setattr(checkpoint.time, "monotonic", lambda: next(clock))
    tracker = Tracker([1])
    for second, kept in ((0, [1]), (1, [1]), (2, [1, 2])):
        tracker.checkpoint.keep(BEGIN + second * NANOSECONDS)
        assert taken_up(second + 0.5) == kept
        tracker.tracks = [1, 2]


def test_of_another_time_run_or_version_nothing_is_taken_up(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    Tracker([1]).checkpoint.keep(BEGIN)
    assert taken_up(0.0) is taken_up(-5.0) is taken_up(3600.0) is None
    monkeypatch.setenv(run_identity.VARIABLE, "another run")
    assert taken_up(1.0) is None
    monkeypatch.setenv(run_identity.VARIABLE, "a run")
    assert taken_up(1.0) == [1]
    monkeypatch.setattr("sonar_tracking.__version__", "0.0.1", raising=False)
    assert taken_up(1.0) is None


def test_a_damaged_checkpoint_is_none(path: Path) -> None:
    Tracker([1]).checkpoint.keep(BEGIN)
    path.write_bytes(path.read_bytes()[:-3])
    assert taken_up(1.0) is None


def test_what_cannot_be_written_is_said(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(resumption.CHECKPOINT, str(path / "not" / "there"))
    tracker = Tracker([1])
    tracker.checkpoint.keep(BEGIN)
    assert "cannot be written" in tracker.said[0]


def test_nodes_started_by_hand_keep_nothing(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(resumption.CHECKPOINT)
    Tracker([1]).checkpoint.keep(BEGIN)
    assert not path.exists()
