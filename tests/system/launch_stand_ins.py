"""Runs the launch files without the launch packages, which are not needed otherwise."""

from __future__ import annotations

import runpy
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

LAUNCH_FILES = Path(__file__).resolve().parents[2] / "launch"


class Recorded:
    """Stands in for any class of the launch packages: keeps what it was made with."""

    def __init__(self, *arguments: Any, **keywords: Any) -> None:
        self.arguments = arguments
        self.keywords = keywords


class Configuration(Recorded):
    """Stands in for a substitution: performed, it is the value given or the default."""

    def perform(self, context: dict[str, str]) -> str:
        return context[self.arguments[0]]


def launched_nodes(file: str, **given: str) -> dict[str, Recorded]:
    """Run a launch file as ros2 launch would, and return the nodes for given arguments."""
    classes: dict[str, dict[str, type]] = {
        "launch": {"LaunchContext": Recorded, "LaunchDescription": Recorded},
        "launch.actions": {"DeclareLaunchArgument": Recorded, "OpaqueFunction": Recorded},
        "launch.substitutions": {"LaunchConfiguration": Configuration},
        "launch_ros": {},
        "launch_ros.actions": {"Node": Recorded},
    }
    modules = {name: ModuleType(name) for name in classes}
    for name, members in classes.items():
        vars(modules[name]).update(members)
    before = {name: sys.modules.get(name) for name in modules}
    sys.modules.update(modules)
    try:
        path = LAUNCH_FILES / f"{file}.launch.py"
        description = runpy.run_path(str(path))["generate_launch_description"]()
    finally:
        for name, module in before.items():
            del sys.modules[name]
            if module is not None:
                sys.modules[name] = module
    *arguments, opaque = description.arguments[0]
    assert all(entry.keywords["description"] for entry in arguments)
    context = {entry.arguments[0]: entry.keywords["default_value"] for entry in arguments}
    assert set(given) <= set(context)
    nodes = opaque.keywords["function"](context | given)
    return {node.keywords["executable"]: node for node in nodes}
