"""Protects the public interface: what a package exports exists, is described, and costs nothing.

Nodes import the files of the packages, and with them every package; so a package imports what it
exports only when it is asked for.
"""

from __future__ import annotations

import ast
import importlib
import inspect
import subprocess
import sys
from pathlib import Path

import pytest

import sonar_tracking

PACKAGES = (
    "active",
    "bags",
    "evaluation",
    "filtering",
    "graph",
    "graph.message_writing",
    "message_reading",
    "passive",
    "records",
    "simulation",
    "tma",
)
WITH_ROS = ("graph", "graph.message_writing")
SOURCE = Path(sonar_tracking.__file__).parent


def module_of(package: str) -> object:
    return importlib.import_module(f"sonar_tracking.{package}")


def names_for_type_checkers(package: str) -> set[str]:
    """Return the names that a package imports for type checkers only."""
    file = SOURCE.joinpath(*package.split("."), "__init__.py")
    (guarded,) = (node for node in ast.parse(file.read_text()).body if isinstance(node, ast.If))
    assert ast.unparse(guarded.test) == "TYPE_CHECKING"
    imports = [node for node in guarded.body if isinstance(node, ast.ImportFrom)]
    return {alias.name for node in imports for alias in node.names}


def first_line(value: object) -> str:
    return (inspect.getdoc(value) or "").splitlines()[0] if inspect.getdoc(value) else ""


@pytest.mark.parametrize("package", PACKAGES)
def test_what_is_exported_is_listed_once_for_everybody(package: str) -> None:
    module = module_of(package)
    exported = module.__all__  # type: ignore[attr-defined]
    assert len(set(exported)) == len(exported)
    assert set(exported) == names_for_type_checkers(package)
    assert set(exported) <= {*dir(module)}


@pytest.mark.parametrize("package", PACKAGES)
def test_every_export_resolves_and_says_what_it_is(package: str) -> None:
    if package in WITH_ROS:
        pytest.importorskip("rclpy")
    module = module_of(package)
    for name in module.__all__:  # type: ignore[attr-defined]
        value = getattr(module, name)
        if inspect.isclass(value) or inspect.isroutine(value):
            assert value.__name__ == name
            assert value.__module__.startswith("sonar_tracking."), name
            assert first_line(value).endswith("."), name
    assert getattr(module, module.__all__[0]) is getattr(module, module.__all__[0])  # type: ignore[attr-defined]


def test_an_unknown_name_is_no_attribute() -> None:
    import sonar_tracking.passive

    with pytest.raises(AttributeError, match=r"sonar_tracking\.passive.* no attribute 'beampower'"):
        sonar_tracking.passive.beampower  # type: ignore[attr-defined] # noqa: B018


def test_a_package_by_itself_imports_neither_numpy_nor_scipy_nor_ros() -> None:
    code = "\n".join(
        [
            *(f"import sonar_tracking.{package}" for package in PACKAGES),
            "import sys",
            "heavy = {'numpy', 'scipy', 'rclpy', 'rosbags', 'yaml'} & {*sys.modules}",
            "own = [name for name in sys.modules if name.startswith('sonar_tracking.')]",
            "print(sorted(heavy), len(own))",
        ]
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60
    )
    # The packages themselves, and what imports for them.
    assert done.stdout.split("]")[0] == "["
    assert int(done.stdout.split()[-1]) == len(PACKAGES) + 1


def test_what_is_asked_for_is_imported_and_nothing_else() -> None:
    code = (
        "from sonar_tracking.passive import music_bearings; import sys;"
        "print('scipy' in sys.modules,"
        " 'sonar_tracking.passive.bearings.bearing_tracker_stage' in sys.modules)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60
    )
    assert done.stdout.split() == ["False", "False"]
