"""What killed processes leave in shared memory goes at the next start, and nothing else."""

from __future__ import annotations

import fcntl
import os
from pathlib import Path

import pytest

from sonar_tracking.graph.orchestration import orphaned_shared_memory
from sonar_tracking.graph.orchestration.orphaned_shared_memory import HeldPorts, remove_orphaned

SEGMENT = "fastrtps_0123456789abcdef"
PORT = "fastrtps_port7412"


@pytest.fixture
def memory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a folder that stands for shared memory, with one segment."""
    monkeypatch.setattr(orphaned_shared_memory, "_YOUNGEST", -1.0)
    (tmp_path / SEGMENT).write_bytes(bytes(1000))
    (tmp_path / f"{SEGMENT}_el").touch()
    return tmp_path


def test_a_segment_nobody_holds_is_removed(memory: Path) -> None:
    assert remove_orphaned(memory) == 1
    assert list(memory.iterdir()) == []


def test_a_segment_that_a_process_holds_stays(memory: Path) -> None:
    with (memory / f"{SEGMENT}_el").open() as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        assert remove_orphaned(memory) == 0
    assert (memory / SEGMENT).exists()


def test_what_was_made_just_now_stays(memory: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its process may be about to take the lock."""
    monkeypatch.setattr(orphaned_shared_memory, "_YOUNGEST", 3600.0)
    assert remove_orphaned(memory) == 0


def test_segments_of_others_stay(memory: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    other = os.getuid() + 1
    monkeypatch.setattr(os, "getuid", lambda: other)
    assert remove_orphaned(memory) == 0


def test_a_port_nobody_listens_to_is_removed_and_its_lock_can_be_taken_again(memory: Path) -> None:
    for name in (PORT, f"{PORT}_el", "fastrtps_port7413", "fastrtps_port7413_el"):
        (memory / name).touch()
    with (memory / "fastrtps_port7413_el").open() as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        remove_orphaned(memory)
    assert not (memory / PORT).exists()
    assert (memory / f"{PORT}_el").exists()
    assert (memory / "fastrtps_port7413").exists()


def test_ports_of_the_dead_are_held_until_they_are_released(memory: Path) -> None:
    """A process that starts now finds the lock taken, and listens to another port."""
    for name in (PORT, f"{PORT}_el", "fastrtps_port7413_el"):
        (memory / name).touch()
    ports = HeldPorts(memory)
    assert ports.hold() == 1, "the other one was removed, nobody can write to it"
    with (memory / f"{PORT}_el").open() as starting:
        with pytest.raises(BlockingIOError):
            fcntl.flock(starting, fcntl.LOCK_EX | fcntl.LOCK_NB)
        ports.release()
        fcntl.flock(starting, fcntl.LOCK_EX | fcntl.LOCK_NB)


def test_the_port_of_a_living_process_is_not_held(memory: Path) -> None:
    for name in (PORT, f"{PORT}_el"):
        (memory / name).touch()
    with (memory / f"{PORT}_el").open() as living:
        fcntl.flock(living, fcntl.LOCK_EX)
        assert HeldPorts(memory).hold() == 0


def test_other_files_stay(memory: Path) -> None:
    for name in ("fastrtps_port7400", "psm_1234", "fastrtps_12_el"):
        (memory / name).touch()
    remove_orphaned(memory)
    assert len(list(memory.iterdir())) == 3


def test_a_link_is_not_followed(memory: Path) -> None:
    target = memory / "precious"
    target.touch()
    (memory / f"{SEGMENT}_el").unlink()
    (memory / f"{SEGMENT}_el").symlink_to(target)
    assert remove_orphaned(memory) == 0


def test_without_shared_memory_there_is_nothing_to_do(tmp_path: Path) -> None:
    assert remove_orphaned(tmp_path / "none") == 0
