"""Shared memory that killed processes have left behind (no ROS).

Fast DDS keeps what a participant sends in a segment, ``/dev/shm/fastrtps_<16 digits>``, and holds a
lock on the file of the same name with ``_el`` as long as the process lives. One that is killed
cannot remove them: up to 128 MB each stay until the machine starts again.
"""

from __future__ import annotations

import fcntl
import os
import re
import time
from contextlib import suppress
from pathlib import Path

from sonar_tracking.graph.catalogue.transport_profile import SHARED_MEMORY

_LOCK = re.compile(r"fastrtps_[0-9a-f]{16}_el")
_YOUNGEST = 1.0
"""Age from which on a lock file is believed to be held by whoever has made it, s."""


def remove_orphaned_segments(folder: Path = SHARED_MEMORY) -> int:
    """Remove this user's segments that no living process holds; return how many there were."""
    if not folder.is_dir():
        return 0
    locks = [path for path in folder.iterdir() if _LOCK.fullmatch(path.name)]
    return sum(_removed(lock) for lock in locks)


def _removed(lock: Path) -> bool:
    try:
        descriptor = os.open(lock, os.O_RDONLY | os.O_NOFOLLOW | os.O_CLOEXEC)
    except OSError:
        return False
    try:
        state = os.fstat(descriptor)
        if state.st_uid != os.getuid() or time.time() - state.st_ctime < _YOUNGEST:
            return False
        # Held while both files go: nobody can take a segment over meanwhile.
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        with suppress(FileNotFoundError):
            lock.with_name(lock.name.removesuffix("_el")).unlink()
        lock.unlink()
    except OSError:
        return False
    finally:
        os.close(descriptor)
    return True
