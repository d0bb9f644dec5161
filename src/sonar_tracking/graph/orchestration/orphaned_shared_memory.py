"""Shared memory that killed processes have left behind (no ROS).

Fast DDS keeps what a participant sends in a segment, ``/dev/shm/fastrtps_<16 digits>``, and what it
receives in ports, ``/dev/shm/fastrtps_port<number>``. As long as the process lives it holds a lock
on the file of the same name with ``_el``. One that is killed cannot remove them: up to 128 MB each
stay until the machine starts again.

A process that takes its place would take its ports, too. To those who wrote to the dead they are
still the old ones, until a watchdog, a second or two later, finds that nobody empties them: what
they send meanwhile is lost to the new process. While somebody else holds the locks it takes others.
"""

from __future__ import annotations

import fcntl
import os
import re
import time
from contextlib import suppress
from pathlib import Path

from sonar_tracking.graph.catalogue.transport_profile import SHARED_MEMORY

_SEGMENT = re.compile(r"fastrtps_[0-9a-f]{16}_el")
_PORT = re.compile(r"fastrtps_port[0-9]+_el")
_YOUNGEST = 1.0
"""Age from which on a lock file is believed to be held by whoever has made it, s."""


def remove_orphaned(folder: Path = SHARED_MEMORY) -> int:
    """Remove this user's segments and ports that no living process holds; return their number."""
    removed = 0
    for lock in (*_locks(folder, _SEGMENT), *_locks(folder, _PORT)):
        descriptor = _taken(lock)
        if descriptor is not None:
            # Held while the files go: nobody can take them over meanwhile.
            removed += _removed(_locked_by(lock))
            if _SEGMENT.fullmatch(lock.name):  # a port is opened again under the same lock
                _removed(lock)
            os.close(descriptor)
    return removed


class HeldPorts:
    """Keeps the ports of killed processes from those that take their place.

    Parameters
    ----------
    folder : Path
        Where the system keeps shared memory.
    """

    def __init__(self, folder: Path = SHARED_MEMORY) -> None:
        self._folder = folder
        self._descriptors: list[int] = []

    def hold(self) -> int:
        """Hold every port that has lost its process; return how many are held."""
        orphaned = [lock for lock in _locks(self._folder, _PORT) if _locked_by(lock).exists()]
        taken = [_taken(lock) for lock in orphaned]
        self._descriptors.extend(descriptor for descriptor in taken if descriptor is not None)
        return len(self._descriptors)

    def release(self) -> None:
        """Let all of them be taken again."""
        while self._descriptors:
            os.close(self._descriptors.pop())


def _locks(folder: Path, pattern: re.Pattern[str]) -> list[Path]:
    if not folder.is_dir():
        return []
    return [path for path in folder.iterdir() if pattern.fullmatch(path.name)]


def _locked_by(lock: Path) -> Path:
    return lock.with_name(lock.name.removesuffix("_el"))


def _removed(path: Path) -> bool:
    with suppress(OSError):
        path.unlink()
        return True
    return False


def _taken(lock: Path) -> int | None:
    """Return the descriptor that holds a lock of this user which nobody else held, or None."""
    try:
        descriptor = os.open(lock, os.O_RDONLY | os.O_NOFOLLOW | os.O_CLOEXEC)
    except OSError:
        return None
    try:
        state = os.fstat(descriptor)
        if state.st_uid == os.getuid() and time.time() - state.st_ctime >= _YOUNGEST:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            return descriptor
    except OSError:
        pass
    os.close(descriptor)
    return None
