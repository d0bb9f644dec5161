"""The package as pip gets it: one version, what it asks for, and what it says where that is not."""

from __future__ import annotations

import ast
import os
import re
import runpy
import shutil
import subprocess
import sys
from importlib.metadata import packages_distributions
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import parse

import pytest
import setuptools
import yaml
from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet
from packaging.utils import canonicalize_name

import sonar_tracking

PROJECT = Path(__file__).resolve().parents[2]
ROS_PACKAGES = {entry.text for entry in parse(PROJECT / "package.xml").findall("exec_depend")}
WITHOUT_ROS = f"import sys; sys.modules.update(dict.fromkeys({sorted(ROS_PACKAGES, key=str)}))\n"
IMPORT_THE_LIBRARY = """
import importlib, pkgutil, sonar_tracking
above = ("sonar_tracking.graph", "sonar_tracking.evaluation.bench")
found = pkgutil.walk_packages(sonar_tracking.__path__, "sonar_tracking.")
names = [module.name for module in found if not module.name.startswith(above)]
for name in names:
    importlib.import_module(name)
print(len(names))
"""
OLD_TYPER = """
import sys, types
sys.modules["typer"] = types.ModuleType("typer")
sys.modules["typer"].__version__ = "0.9.0"
import sonar_tracking.cli
"""
OLD_PYTHON = """
import runpy, sys
sys.path.insert(0, "src")
sys.version_info, sys.version = (3, 9, 18), "3.9.18"
runpy.run_path("scripts/run_pipeline.py", run_name="__main__")
"""


def setup_arguments(monkeypatch: pytest.MonkeyPatch, *command: str) -> dict[str, Any]:
    """Return what setup.py tells setuptools."""
    told: dict[str, Any] = {}
    monkeypatch.setattr(setuptools, "setup", lambda **arguments: told.update(arguments))
    monkeypatch.setattr(sys, "argv", ["setup.py", *command])
    monkeypatch.chdir(PROJECT)
    runpy.run_path("setup.py")
    return told


def declared(told: dict[str, Any], *extras: str) -> dict[str, Requirement]:
    """Return the requirements by name."""
    texts = [*told["install_requires"], *(t for e in extras for t in told["extras_require"][e])]
    parsed = map(Requirement, texts)
    return {canonicalize_name(requirement.name): requirement for requirement in parsed}


def imported_distributions() -> list[set[str]]:
    """Return who provides each module of others that the source imports, ROS left out."""
    modules = set()
    for path in (PROJECT / "src").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                modules |= {alias.name.partition(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                modules.add(node.module.partition(".")[0])
    modules -= {*sys.stdlib_module_names, *ROS_PACKAGES, "sonar_tracking"}
    providers = packages_distributions()
    return [{canonicalize_name(name) for name in providers[module]} for module in modules]


def run_python(*arguments: str, **variables: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, *arguments],
        env={**os.environ, **variables},
        cwd=PROJECT,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )


def test_version_is_the_same_everywhere(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is written in package.xml; what cannot read it there repeats it."""
    version = parse(PROJECT / "package.xml").findtext("version")
    assert sonar_tracking.__version__ == version
    assert setup_arguments(monkeypatch)["version"] == version
    assert parse(PROJECT / "msg_defs" / "package.xml").findtext("version") == version
    citation = yaml.safe_load((PROJECT / "CITATION.cff").read_text())
    assert citation["version"] == version
    headings = re.findall(r"^([\d.]+) \((.+)\)\n-+$", (PROJECT / "CHANGELOG.rst").read_text(), re.M)
    assert headings[0] == (version, citation["date-released"])


def test_every_import_is_declared_and_nothing_else(monkeypatch: pytest.MonkeyPatch) -> None:
    told = setup_arguments(monkeypatch)
    names = declared(told, "audio", "plot", "display", "studies").keys()
    peers = {"pyroomacoustics", "stonesoup"}
    assert peers <= declared(told, "test").keys()
    imported = imported_distributions()
    assert [providers for providers in imported if not providers & (names | peers)] == []
    served = {"uplot-python"}  # its files are found, and it is never imported
    assert names - set().union(*imported) == served


def test_versions_the_tests_run_with_are_allowed(monkeypatch: pytest.MonkeyPatch) -> None:
    allowed = declared(setup_arguments(monkeypatch), "audio", "plot", "display", "studies")
    lines = (PROJECT / "requirements" / "run.txt").read_text().splitlines()
    pins = [Requirement(line) for line in lines if not line.startswith("#")]
    assert {canonicalize_name(pin.name) for pin in pins} == {*allowed, "setuptools"}
    for pin in pins:
        (version,) = (specifier.version for specifier in pin.specifier)
        if pin.name != "setuptools":
            assert allowed[canonicalize_name(pin.name)].specifier.contains(version), pin


@pytest.mark.parametrize(
    ("version", "allowed"),
    [("3.9.18", False), ("3.10.0", True), ("3.13.9", True), ("3.14.0", False)],
)
def test_pip_refuses_another_python(
    monkeypatch: pytest.MonkeyPatch, version: str, allowed: bool
) -> None:
    """Its sentence names both versions."""
    told = setup_arguments(monkeypatch)
    assert SpecifierSet(told["python_requires"]).contains(version) == allowed
    messages = (PROJECT / "msg_defs" / "pyproject.toml").read_text()
    assert f'requires-python = "{told["python_requires"]}"' in messages


def test_the_build_refuses_an_older_python_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    """The pip of such a Python finds no version of a dependency, and says no more than that."""
    monkeypatch.setattr(sys, "version_info", (3, 9, 18))
    monkeypatch.setattr(sys, "version", "3.9.18 (main)")
    with pytest.raises(SystemExit, match=r"needs Python 3\.10 to 3\.13, and this is 3\.9\.18:"):
        setup_arguments(monkeypatch)


@pytest.mark.parametrize("command", ["install", "develop"])
def test_colcon_leaves_dependencies_to_rosdep(
    monkeypatch: pytest.MonkeyPatch, command: str
) -> None:
    """It may run setup.py in a folder that has nothing but what setup() names."""
    told = setup_arguments(monkeypatch, command)
    assert "install_requires" not in told and "extras_require" not in told
    assert any(
        script.startswith("tma_tracker = ") for script in told["entry_points"]["console_scripts"]
    )


def test_wheel_works_outside_of_the_tree(tmp_path: Path) -> None:
    """A copy, since setuptools leaves its files in the tree, and takes old ones from there."""
    for folder in ("src", "config", "launch", "msg_defs", "resource", "requirements"):
        no_rests = shutil.ignore_patterns("*.egg-info", "__pycache__")
        shutil.copytree(PROJECT / folder, tmp_path / "tree" / folder, ignore=no_rests)
    for file in ("setup.py", "setup.cfg", "pyproject.toml", "package.xml", "LICENSE"):
        shutil.copy(PROJECT / file, tmp_path / "tree")
    pip = [sys.executable, "-m", "pip", "install", "--no-deps", "--no-index", "--ignore-installed"]
    options = [
        "--no-build-isolation",
        "--no-compile",  # of which modules need it, Python does it by itself
        "--no-warn-script-location",
        f"--prefix={tmp_path / 'prefix'}",
    ]
    compiler = tmp_path / "compiler"
    compiler.write_text('#!/bin/sh\nexec cc "$@" -O0\n')  # whose code nobody waits for here
    compiler.chmod(0o755)
    compiled = {**os.environ, "CC": str(compiler), "LDSHARED": f"{compiler} -shared"}
    subprocess.run(
        [*pip, *options, str(tmp_path / "tree")], env=compiled, capture_output=True, check=True
    )
    (packages,) = (tmp_path / "prefix").glob("lib/python*/site-packages")
    command = tmp_path / "prefix" / "bin" / "sonar-tracking"
    done = run_python(str(command), "--help", PYTHONPATH=str(packages))
    assert (done.returncode, done.stderr) == (0, "")
    find = (
        "import sonar_tracking; from sonar_tracking.resources import find_resource;"
        "print(sonar_tracking.__version__, find_resource('config/scenarios/tma.yaml'),"
        " find_resource('launch/pipeline.launch.py'), find_resource('msg_defs/msg/Tracks.msg'))"
    )
    share = tmp_path / "prefix" / "share" / "sonar_tracking"
    found = run_python("-c", find, PYTHONPATH=str(packages)).stdout.split()
    assert found == [
        sonar_tracking.__version__,
        str(share / "config" / "scenarios" / "tma.yaml"),
        str(share / "launch" / "pipeline.launch.py"),
        str(share / "msg_defs" / "msg" / "Tracks.msg"),
    ]


def test_library_needs_no_ros() -> None:
    done = run_python("-c", WITHOUT_ROS + IMPORT_THE_LIBRARY)
    assert (done.returncode, done.stderr) == (0, "")
    assert int(done.stdout) > 200


@pytest.mark.parametrize(
    ("arguments", "exit_code", "parts"),
    [
        (
            ("-c", WITHOUT_ROS + "from sonar_tracking.cli import main; sys.exit(main())", "run"),
            2,
            ("rclpy is missing", "pip install 'sonar_tracking[ros]'", "./scripts/run.sh"),
        ),
        (("-c", OLD_TYPER), 1, ("typer 0.9.0 is too old", "pip install --upgrade typer")),
        (("-c", OLD_PYTHON), 1, ("Python 3.10 to 3.13, and this is 3.9.18", "./scripts/run.sh")),
        (("-I", "-S", "scripts/run_pipeline.py"), 1, ("No module named", "./scripts/run.sh")),
    ],
    ids=["no ROS", "old typer", "old Python", "no environment"],
)
def test_what_is_missing_is_a_sentence_with_its_remedy(
    arguments: tuple[str, ...], exit_code: int, parts: tuple[str, ...]
) -> None:
    done = run_python(*arguments)
    assert done.returncode == exit_code
    assert done.stdout == ""
    assert len(done.stderr.splitlines()) == 1, done.stderr
    assert all(part in done.stderr for part in parts), done.stderr


@pytest.mark.parametrize(
    "path", ["scripts/run_pipeline.py", "scripts/set_up.py", "src/sonar_tracking/__init__.py"]
)
def test_what_an_old_python_meets_first_is_no_syntax_error(path: str) -> None:
    ast.parse((PROJECT / path).read_text(encoding="utf-8"), feature_version=(3, 7))
