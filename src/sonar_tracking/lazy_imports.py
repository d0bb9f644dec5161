"""Imports that wait until they are needed: a node imports what it runs and nothing else."""

from __future__ import annotations

import importlib
from functools import reduce
from typing import Any


def load_object(reference: str) -> Any:
    """Return what an object reference names.

    Parameters
    ----------
    reference : str
        ``"package.module:name"`` or ``"package.module:Class.method"``, as in the entry points of
        Python packages.

    Raises
    ------
    ImportError
        If there is no such module.
    AttributeError
        If the module has no such name.
    """
    module, _, name = reference.partition(":")
    return reduce(getattr, name.split("."), importlib.import_module(module))
