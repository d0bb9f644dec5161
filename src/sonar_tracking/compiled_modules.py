"""Modules that are compiled if a compiler was there when the package was installed.

Each has a twin in numpy that gives the same bits.
"""

from __future__ import annotations

import importlib
from types import ModuleType


def compiled_module(name: str) -> ModuleType | None:
    """Return a compiled module of this package, None where there is none.

    Parameters
    ----------
    name : str
        Below ``sonar_tracking``, such as ``"passive.subspaces.compiled_past"``.
    """
    try:
        return importlib.import_module(f"sonar_tracking.{name}")
    except ImportError:
        return None
