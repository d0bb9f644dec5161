"""One run at a time in a namespace of a ROS domain: two would mix their data up (no ROS)."""

from __future__ import annotations

import fcntl
import os
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from sonar_tracking.errors import ConfigurationError

LARGEST_DOMAIN = 232
"""DDS computes its UDP ports from the domain; above this they do not exist."""


@contextmanager
def domain_lock(folder: Path | None = None, namespace: str = "") -> Iterator[None]:
    """Hold a namespace of the ROS domain of this process as long as the run lasts.

    The lock ends with the process, however that ends. It guards one machine and one user; a run
    of another is noticed when the nodes meet.

    Parameters
    ----------
    folder : Path, optional
        Where the lock files are; default: :func:`runtime_folder`.
    namespace : str
        Of the graph, e.g. ``"/shipA"``; default: the root.

    Raises
    ------
    ConfigurationError
        If another run holds it, or there is no such domain.
    """
    domain = os.environ.get("ROS_DOMAIN_ID") or "0"
    if not (domain.isdecimal() and int(domain) <= LARGEST_DOMAIN):
        raise ConfigurationError(
            f"ROS_DOMAIN_ID is {domain!r}; set it to a number from 0 to {LARGEST_DOMAIN}, "
            "or unset it."
        )
    place = namespace.replace("/", "-")
    path = (folder or runtime_folder()) / f"sonar_tracking-domain-{domain}{place}.lock"
    try:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC, 0o600)
    except OSError:
        # No place for it, or no plain file: without the lock, the nodes still notice each other.
        yield
        return
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        holder = os.read(descriptor, 20).decode(errors="replace").strip() or "unknown"
        os.close(descriptor)
        where = f", namespace {namespace}" if namespace else ""
        raise ConfigurationError(
            f"another run (process {holder}) uses ROS domain {domain}{where}: wait for its end, "
            "or set ROS_DOMAIN_ID to another number for this one, or give run a --namespace of "
            "its own."
        ) from None
    try:
        os.ftruncate(descriptor, 0)
        os.pwrite(descriptor, f"{os.getpid()}\n".encode(), 0)
        yield
    finally:
        os.close(descriptor)


def runtime_folder() -> Path:
    """Return a folder that nobody else can write to, for what lasts as long as a process.

    It is that of the session (``XDG_RUNTIME_DIR``, ``/run/user``) if there is one, else one below
    the folder for temporary files, which is made.

    Raises
    ------
    ConfigurationError
        If there is only a folder of that name which others can write to.
    """
    user = os.getuid()
    for known in (os.environ.get("XDG_RUNTIME_DIR"), f"/run/user/{user}"):
        if known and _is_private(Path(known)):
            return Path(known)
    folder = Path(tempfile.gettempdir()) / f"sonar_tracking-{user}"
    with suppress(FileExistsError):
        folder.mkdir(mode=0o700)
    if not _is_private(folder):
        raise ConfigurationError(
            f"{folder} is not a folder of this user alone: somebody else may have made it; remove "
            "it, or set XDG_RUNTIME_DIR to a folder with mode 700."
        )
    return folder


def _is_private(folder: Path) -> bool:
    """Tell whether a folder, itself and not by a link, belongs to this user alone."""
    try:
        state = folder.lstat()
    except OSError:
        return False
    mine = stat.S_ISDIR(state.st_mode) and state.st_uid == os.getuid()
    return mine and not state.st_mode & (stat.S_IRWXG | stat.S_IRWXO)
