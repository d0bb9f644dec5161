"""Protects the layers: a file imports from its own room and from rooms below it, never from above.

Rooms are listed once, here, from the ground up; so no two rooms can import each other. Within a
room no circle of files is allowed either.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

from tests import package_source

PACKAGE = package_source.PACKAGE.name

ROOMS = (
    "stop_signals",
    "errors",
    "one_thread",
    "resources",
    "lazy_imports",
    "compiled_modules",
    "method_registry",
    "yaml_reading",
    "configuration",
    # what flows between the stages, and the mathematics they share
    "records",
    "geometry",
    "geodesy",
    "motion",
    "own_ship_interpolation",
    "sensor_pose",
    "filtering",
    "alignment",
    # stages, one package each, independent of one another
    "passive.performance",
    "passive.directions",
    "passive.sources",
    "passive.array_fit",
    "passive.subspaces",
    "passive.near_field",
    "passive.track_start",
    "passive.bearings",
    "passive.lines",
    "passive",
    "tma.estimators",
    "tma.baselines",
    "tma.batch",
    "tma.performance",
    "tma.targets",
    "tma.stations",
    "tma.tracker",
    "tma",
    "active.contacts",
    "active.detection",
    "active.tracks",
    "active.association",
    "active.baselines",
    "active",
    # what all stages found, in one picture
    "fusion",
    "scene",
    # the world, and what sensors receive of it
    "simulation.scenarios",
    "simulation.world",
    "simulation.signals",
    "simulation.sensors",
    "simulation",
    # files
    "message_reading",
    "bags.contents",
    "bags.mcap",
    "bags.sqlite",
    "bags.storage",
    "bags.audio",
    "bags.nmea",
    "bags.tables",
    "bags.positions",
    "bags.importers",
    "bags.exporters",
    "bags",
    # Monte Carlo over the layers below
    "evaluation.metrics",
    "evaluation.monte_carlo",
    "evaluation.offline",
    "evaluation.studies.doa_fusion",
    "evaluation.studies.doa_coherent",
    "evaluation.studies.doa_start",
    "evaluation.studies.detection_threshold",
    "evaluation.studies.multi_target_clutter",
    "evaluation.studies.mismatch_contacts",
    "evaluation.studies.maritime_contacts",
    "evaluation.studies.room_array",
    "evaluation.studies.scenario_seeds",
    "evaluation.studies.ship_bearings",
    "evaluation.studies.tma_frequency_fusion",
    "evaluation.studies.track_fusion",
    "evaluation.studies.mismatch_positions",
    "evaluation.studies.mismatch_bearings",
    "evaluation.studies",
    "evaluation.bench",
    "evaluation",
    # people
    "display.waterfalls",
    "display.page",
    "display",
    "graph.catalogue",
    "graph.message_writing",
    "graph.node_base",
    "graph.nodes",
    "graph.orchestration",
    "graph.chaos",
    "graph.bench",
    "graph.verbs",
    "graph",
    "cli_options",
    "cli_loading",
    "cli_bench",
    "cli_export",
    "cli_import",
    "cli_inspect",
    "cli_show",
    "cli_smooth",
    "cli",
    "",
)
"""From the ground up; a file belongs to the longest name it begins with."""

ROOMS_WITH_ROS = (
    "graph.message_writing",
    "graph.node_base",
    "graph.nodes",
    "graph.orchestration",
    "graph.chaos",
    "graph.bench",
)
"""Where ROS may be imported; anything else works without."""

STAGES = {"passive", "tma", "active"}


def module_name(path: Path) -> str:
    """Return the name of a module below the package, e.g. ``passive.subspaces.past``."""
    parts = path.relative_to(package_source.PACKAGE).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


FILES = {module_name(path): path for path in package_source.FILES}
PACKAGES = {name for name, path in FILES.items() if path.name == "__init__.py"}


def room_of(module: str) -> str:
    """Return the room of a module."""
    return max((r for r in ROOMS if f"{module}.".startswith(f"{r}." if r else "")), key=len)


@cache
def imports_of(path: Path) -> tuple[str, ...]:
    """Return the full name of every module a file imports, wherever in the file it does so."""
    return tuple(_imports_of(path))


def _imports_of(path: Path) -> Iterator[str]:
    for node in package_source.nodes_of(path):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                below = f"{node.module}.{alias.name}".removeprefix(f"{PACKAGE}.")
                yield f"{PACKAGE}.{below}" if below in FILES else node.module


def own_imports(module: str) -> set[str]:
    """Return the modules of the package that a module imports."""
    names = {name for name in imports_of(FILES[module]) if name.startswith(f"{PACKAGE}.")}
    return {name.removeprefix(f"{PACKAGE}.") for name in names} - {module}


def test_every_package_is_a_room() -> None:
    unknown = [name for name in PACKAGES if name not in ROOMS]
    assert not unknown, f"give {unknown} a place among the rooms"


def test_imports_go_down() -> None:
    height = {module: ROOMS.index(room_of(module)) for module in FILES}
    upward = {
        f"{module} imports {name} from above"
        for module in FILES
        for name in own_imports(module)
        if height[name] > height[module]
    }
    assert not upward


def test_no_circle_of_files() -> None:
    # A circle raises, and names its files.
    TopologicalSorter({module: own_imports(module) for module in FILES}).prepare()


def test_stages_know_nothing_of_one_another() -> None:
    across = {
        f"{module} imports {name}"
        for module in FILES
        for name in own_imports(module)
        if {module.partition(".")[0], name.partition(".")[0]} <= STAGES
        and module.partition(".")[0] != name.partition(".")[0]
    }
    assert not across


def test_ros_is_imported_by_the_graph_alone() -> None:
    with_ros = {
        module
        for module, path in FILES.items()
        if any(name.partition(".")[0] == "rclpy" for name in imports_of(path))
    }
    assert with_ros
    assert {room_of(module) for module in with_ros} <= {*ROOMS_WITH_ROS}
