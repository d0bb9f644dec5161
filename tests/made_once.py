"""What several workers need and one makes: a folder of files for the whole run of pytest."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Callable
from pathlib import Path

import pytest


def made_once(factory: pytest.TempPathFactory, name: str, make: Callable[[Path], object]) -> Path:
    """Return a folder that the first worker to ask for it fills, while the others wait.

    Parameters
    ----------
    factory : pytest.TempPathFactory
        Knows the temporary folder of this run of pytest.
    name : str
        Name of the folder.
    make : callable
        Fills the folder it is given. Where it fails, so does every test that asks.

    Returns
    -------
    Path
        The folder.
    """
    base = factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        base = base.parent  # each worker has a folder of its own below that of the run
    folder = base / "made_once" / name
    folder.mkdir(parents=True, exist_ok=True)
    done = folder.with_name(f"{name}.done")
    with folder.with_name(f"{name}.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not done.exists():
            make(folder)
            done.touch()
    return folder
