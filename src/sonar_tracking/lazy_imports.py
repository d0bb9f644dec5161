"""Imports that wait until they are needed: a node imports what it runs and nothing else."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Mapping, Sequence
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


def lazy_exports(
    package: str, names_by_module: Mapping[str, Sequence[str]]
) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """Return the ``__getattr__`` and ``__dir__`` of a package that imports a name at its first use.

    Parameters
    ----------
    package : str
        Full name of the package.
    names_by_module : mapping of str to sequence of str
        What the package exports, by the module below the package in which it is.

    References
    ----------
    PEP 562, "Module __getattr__ and __dir__".
    """
    module_of = {name: module for module, names in names_by_module.items() for name in names}

    def get(name: str) -> Any:
        if name not in module_of:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        value = load_object(f"{package}.{module_of[name]}:{name}")
        setattr(sys.modules[package], name, value)
        return value

    def names() -> list[str]:
        return sorted({*vars(sys.modules[package]), *module_of})

    return get, names
