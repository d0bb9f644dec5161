"""The Python interface: everything that the packages of the stages export, one page a package."""

from __future__ import annotations

import dataclasses
import importlib
import inspect
from types import ModuleType

from docs.reference_writer.methods import methods_table
from docs.reference_writer.tables import parameter_cells, table
from sonar_tracking.configuration import describe
from sonar_tracking.graph.catalogue.topics import Topic
from sonar_tracking.method_registry import MethodRegistry

PACKAGES = (
    "records",
    "passive",
    "tma",
    "active",
    "filtering",
    "simulation",
    "bags",
    "evaluation",
    "geometry",
    "geodesy",
    "motion",
    "message_reading",
    "graph",
)
"""Packages and modules that a user of the library imports from."""


def package(name: str) -> str:
    """Return what a package is for, a table of what it exports, and each export in full.

    Parameters
    ----------
    name : str
        One of :data:`PACKAGES`.
    """
    module = importlib.import_module(f"sonar_tracking.{name}")
    values = {export: _value(module, export) for export in exports_of(module)}
    exports = [export for export, value in values.items() if value is not None]
    parts = [
        _directive(f".. automodule:: {module.__name__}"),
        _directive(
            f".. currentmodule:: {module.__name__}",
            "",
            ".. autosummary::",
            "   :nosignatures:",
            "",
            *(f"   {export}" for export in exports),
        ),
    ]
    if missing := [f"`{export}`" for export, value in values.items() if value is None]:
        parts.append(f"These pages were built without ROS 2, which {', '.join(missing)} need.")
    for export in exports:
        parts += [f"## {export}", _entry(f"{module.__name__}.{export}", values[export])]
    return "\n\n".join(parts)


def exports_of(module: ModuleType) -> list[str]:
    """Return the names that a package exports, or the public ones that a module defines."""
    defined = (
        name
        for name, value in vars(module).items()
        if not name.startswith("_") and getattr(value, "__module__", "") == module.__name__
    )
    return sorted(getattr(module, "__all__", defined))


def _value(module: ModuleType, export: str) -> object | None:
    """Return what is exported; None if it needs a package that is not installed."""
    try:
        value: object = getattr(module, export)
    except ModuleNotFoundError:
        return None
    return value


def _entry(path: str, value: object) -> str:
    if isinstance(value, MethodRegistry):
        names = _directive(f".. py:data:: {path}", "", "   A registry: the methods by name.")
        return f"{names}\n\n{methods_table(f'`{value.parameter}`', value)}"
    if inspect.isclass(value):
        parts = [_class(path, value)]
        if dataclasses.is_dataclass(value) and path.endswith("Configuration"):
            rows = [(f"`{entry.name}`", *parameter_cells(entry)) for entry in describe(value)]
            parts.append(table(("field", "default", "unit", "allowed", "what it does"), rows))
        return "\n\n".join(parts)
    if isinstance(value, Topic):
        text = f"   Topic ``{value.name}``, ``{value.message_type}``: {value.description}."
        return _directive(f".. py:data:: {path}", "", text)
    if inspect.isroutine(value):
        return _directive(f".. autofunction:: {path}")
    return _directive(f".. autodata:: {path}", "   :no-value:")


def _class(path: str, value: type) -> str:
    members = [
        name
        for name, member in vars(value).items()
        if not name.startswith("_")
        and (inspect.isfunction(member) or isinstance(member, classmethod | staticmethod))
    ]
    options = [f"   :members: {', '.join(members)}"] if members else []
    return _directive(f".. autoclass:: {path}", *options)


def _directive(*lines: str) -> str:
    return "\n".join(["```{eval-rst}", *lines, "```"])
