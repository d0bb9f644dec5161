"""What killed processes leave in shared memory goes at the next start, and nothing else."""

from __future__ import annotations

import fcntl
import os
from pathlib import Path

import pytest

from sonar_tracking.graph.orchestration import orphaned_segments
from sonar_tracking.graph.orchestration.orphaned_segments import remove_orphaned_segments

SEGMENT = "fastrtps_0123456789abcdef"


@pytest.fixture
def memory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a folder that stands for shared memory, with one segment."""
    monkeypatch.setattr(orphaned_segments, "_YOUNGEST", -1.0)
    (tmp_path / SEGMENT).write_bytes(bytes(1000))
    (tmp_path / f"{SEGMENT}_el").touch()
    return tmp_path


def test_a_segment_nobody_holds_is_removed(memory: Path) -> None:
    assert remove_orphaned_segments(memory) == 1
    assert list(memory.iterdir()) == []


def test_a_segment_that_a_process_holds_stays(memory: Path) -> None:
    with (memory / f"{SEGMENT}_el").open() as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        assert remove_orphaned_segments(memory) == 0
    assert (memory / SEGMENT).exists()


def test_what_was_made_just_now_stays(memory: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its process may be about to take the lock."""
    monkeypatch.setattr(orphaned_segments, "_YOUNGEST", 3600.0)
    assert remove_orphaned_segments(memory) == 0


def test_segments_of_others_stay(memory: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    other = os.getuid() + 1
    monkeypatch.setattr(os, "getuid", lambda: other)
    assert remove_orphaned_segments(memory) == 0


def test_other_files_stay(memory: Path) -> None:
    for name in ("fastrtps_port7412_el", "fastrtps_port7412", "psm_1234", "fastrtps_12_el"):
        (memory / name).touch()
    remove_orphaned_segments(memory)
    assert len(list(memory.iterdir())) == 4


def test_a_link_is_not_followed(memory: Path) -> None:
    target = memory / "precious"
    target.touch()
    (memory / f"{SEGMENT}_el").unlink()
    (memory / f"{SEGMENT}_el").symlink_to(target)
    assert remove_orphaned_segments(memory) == 0


def test_without_shared_memory_there_is_nothing_to_do(tmp_path: Path) -> None:
    assert remove_orphaned_segments(tmp_path / "none") == 0
