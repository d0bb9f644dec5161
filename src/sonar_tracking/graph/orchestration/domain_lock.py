"""One run at a time in a namespace of a ROS domain: two would mix their data up (no ROS)."""

from __future__ import annotations

import fcntl
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from sonar_tracking.errors import ConfigurationError

LARGEST_DOMAIN = 232
"""DDS computes its UDP ports from the domain; above this they do not exist."""


@contextmanager
def domain_lock(folder: Path | None = None, namespace: str = "") -> Iterator[None]:
    """Hold a namespace of the ROS domain of this process as long as the run lasts.

    The lock ends with the process, however that ends. It guards one machine; a run on another one
    is noticed when the nodes meet.

    Parameters
    ----------
    folder : Path, optional
        Where the lock files are; default: the folder for temporary files.
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
    path = (folder or Path(tempfile.gettempdir())) / f"sonar_tracking-domain-{domain}{place}.lock"
    try:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
    except OSError:
        # Made by another user: without the lock, the nodes still notice each other.
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
