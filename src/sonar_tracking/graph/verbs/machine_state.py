"""What a machine has of what a graph needs: looked up here, judged in doctor (no ROS import)."""

from __future__ import annotations

import json
import os
import platform
import shutil
import subprocess
import sys
import sysconfig
from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path

from sonar_tracking.graph.catalogue.transport_profile import SHARED_MEMORY
from sonar_tracking.resources import find_resource

MESSAGE_PACKAGE = "sonar_tracking_msgs"
TRANSFORM_PACKAGE = "tf2_msgs"

REQUIRED = {
    "numpy": "numpy",
    "scipy": "scipy",
    "yaml": "PyYAML",
    "rich": "rich",
    "rosbags": "rosbags",
    "mcap": "mcap",
    "lz4": "lz4",
    "backports.zstd": "backports.zstd",
}
"""Python packages every graph needs: name in an import, name for pip."""

OPTIONAL = {
    "plot": {"matplotlib": "matplotlib"},
    "page": {"tornado": "tornado", "uplot": "uplot-python"},
    "studies": {"matplotlib": "matplotlib", "dask": "dask", "distributed": "distributed"},
    "docs": {"sphinx": "sphinx", "myst_parser": "myst-parser"},
    "test": {"pytest": "pytest", "stonesoup": "stonesoup"},
}
"""The same of what only some verbs need, by the extra of pip that brings it."""

COMPILERS = ("c++", "g++", "clang++")
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")

_TRIAL = (
    f"import rclpy; from {MESSAGE_PACKAGE}.msg import Contacts; "
    "Contacts.__class__.__import_type_support__()"
)
_TRIAL_SECONDS = 60.0


@dataclass(frozen=True)
class MachineState:
    """What was found on a machine.

    Attributes
    ----------
    python : tuple of int
        Major and minor version.
    executable : str
        The Python that is running.
    environment : mapping of str to str
        Environment variables.
    versions : mapping of str to str
        Python packages that are there, by their name in an import; ``"unknown"`` where a package
        does not tell its version.
    ros_origin : str
        Folder of rclpy; empty = there is none.
    ros_wheels : bool
        Whether rclpy was installed by pip.
    import_error : str
        Why rclpy and the messages cannot be loaded; empty = they can.
    installed_hashes, shipped_hashes : mapping of str to str
        REP-2011 hash of each message type, as compiled on this machine and as this version of
        sonar_tracking defines it.
    middlewares : tuple of str
        RMW implementations that are there.
    shared_memory : tuple of int
        Size and free space of the file system for shared memory, bytes; empty = there is none.
    compiler, browser : str
        Path of a C++ compiler and of Chromium; empty = there is none.
    python_headers : bool
        Whether C and C++ code can be compiled for this Python.
    """

    python: tuple[int, int]
    executable: str = "python3"
    environment: Mapping[str, str] = field(default_factory=dict)
    versions: Mapping[str, str] = field(default_factory=dict)
    ros_origin: str = ""
    ros_wheels: bool = False
    import_error: str = ""
    installed_hashes: Mapping[str, str] = field(default_factory=dict)
    shipped_hashes: Mapping[str, str] = field(default_factory=dict)
    middlewares: tuple[str, ...] = ()
    shared_memory: tuple[int, ...] = ()
    compiler: str = ""
    browser: str = ""
    python_headers: bool = False


def examined_machine() -> MachineState:
    """Return the state of this machine, seen from the Python that is running."""
    major, minor, _ = platform.python_version_tuple()
    names = dict(REQUIRED)
    for group in OPTIONAL.values():
        names |= group
    prefixes = ros_prefixes(os.environ)
    rclpy = find_spec("rclpy")
    there = rclpy is not None and find_spec(MESSAGE_PACKAGE) is not None
    headers = Path(sysconfig.get_path("include")) / "Python.h"
    return MachineState(
        python=(int(major), int(minor)),
        executable=sys.executable,
        environment=dict(os.environ),
        versions=_versions(
            names | {name: name for name in ("rclpy", MESSAGE_PACKAGE, TRANSFORM_PACKAGE)}
        ),
        ros_origin=str(Path(rclpy.origin).parent) if rclpy and rclpy.origin else "",
        ros_wheels=_distribution_version("ros-rclpy") != "",
        import_error=_import_error() if there else "",
        installed_hashes=installed_hashes(prefixes),
        shipped_hashes=shipped_hashes() if find_spec("rosbags") else {},
        middlewares=middlewares(prefixes),
        shared_memory=tuple(shutil.disk_usage(SHARED_MEMORY)[::2])
        if SHARED_MEMORY.is_dir()
        else (),
        compiler=_program(COMPILERS),
        browser=_program(BROWSERS),
        python_headers=headers.is_file(),
    )


def ros_prefixes(environment: Mapping[str, str]) -> tuple[Path, ...]:
    """Return where ROS packages are looked for, first the workspaces that are sourced."""
    listed = environment.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    return tuple(dict.fromkeys([*(Path(entry) for entry in listed if entry), Path(sys.prefix)]))


def installed_hashes(prefixes: tuple[Path, ...]) -> dict[str, str]:
    """Return the hash of each message type as the first compiled message package tells it."""
    for prefix in prefixes:
        files = sorted((prefix / "share" / MESSAGE_PACKAGE / "msg").glob("*.json"))
        if files:
            return {
                entry["type_name"]: entry["hash_string"]
                for file in files
                for entry in json.loads(file.read_text(encoding="utf-8"))["type_hashes"]
                if entry["type_name"] == f"{MESSAGE_PACKAGE}/msg/{file.stem}"
            }
    return {}


def shipped_hashes() -> dict[str, str]:
    """Return the hash of each message type as this version of the package defines it."""
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    texts = {
        f"{MESSAGE_PACKAGE}/msg/{file.stem}": file.read_text(encoding="utf-8")
        for file in sorted(find_resource("msg_defs/msg").glob("*.msg"))
    }
    store = get_typestore(Stores.ROS2_JAZZY)
    store.register(
        {k: v for name in texts for k, v in get_types_from_msg(texts[name], name).items()}
    )
    return {name: store.hash_rihs01(name) for name in texts}


def middlewares(prefixes: tuple[Path, ...]) -> tuple[str, ...]:
    """Return the RMW implementations whose libraries lie below the prefixes."""
    libraries = [file.stem for prefix in prefixes for file in (prefix / "lib").glob("librmw_*.so")]
    names = {name.removeprefix("lib") for name in libraries if "shared" not in name}
    return tuple(sorted(n for n in names if n.endswith("_cpp") and "__" not in n))


def _versions(names: Mapping[str, str]) -> dict[str, str]:
    found = {}
    for module, distribution in names.items():
        try:
            there = find_spec(module) is not None
        except ModuleNotFoundError:  # the package around it
            there = False
        if there:
            found[module] = _distribution_version(distribution) or "unknown"
    return found


def _distribution_version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return ""


def _program(names: tuple[str, ...]) -> str:
    return next(filter(None, map(shutil.which, names)), "")


def _import_error() -> str:
    """Load rclpy and the messages in a process of their own, as a node would."""
    try:
        trial = subprocess.run(
            [sys.executable, "-c", _TRIAL],
            capture_output=True,
            text=True,
            check=False,
            timeout=_TRIAL_SECONDS,
        )
    except subprocess.TimeoutExpired:
        return f"loading them takes more than {_TRIAL_SECONDS:.0f} s"
    lines = trial.stderr.strip().splitlines()
    return (lines or ["no reason given"])[-1] if trial.returncode else ""
