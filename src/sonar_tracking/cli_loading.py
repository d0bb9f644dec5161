"""Verbs of the command line load what does their work when they are called, not before."""

from __future__ import annotations

import importlib
import os
from types import ModuleType

from sonar_tracking.one_thread import ONE_THREAD
from sonar_tracking.stop_signals import interruptible


def needs(module: str) -> ModuleType:
    """Import the module that does the work of a verb; from then on it can be interrupted."""
    loaded = load(module)
    interruptible()
    return loaded


def load(module: str) -> ModuleType:
    """Import the module of a verb that sees to stop signals itself."""
    os.environ.update(ONE_THREAD)
    return importlib.import_module(module)
