"""Build of sonar_tracking, for pip and for colcon.

All metadata are here: a [project] table in pyproject.toml would make colcon ignore them.
"""

import sys
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import parse

from setuptools import Extension, find_packages, setup

PACKAGE = "sonar_tracking"
if sys.version_info < (3, 10):  # noqa: UP036  (the pip of an older one names a dependency instead)
    sys.exit(
        f"{PACKAGE} needs Python 3.10 to 3.13, and this is {sys.version.split()[0]}: make the"
        " environment with another one, e.g. python3.12 -m venv .venv."
    )
VERSION = parse("package.xml").findtext("version")
NODES = (
    "world_simulator",
    "array_simulator",
    "hydrophone_simulator",
    "bearing_simulator",
    "contact_simulator",
    "own_ship_nmea",
    "ais_truth",
    "band_demodulator",
    "subspace_estimator",
    "bearing_tracker",
    "line_tracker",
    "tma_tracker",
    "hpda_tracker",
    "track_fusion",
    "nmea_output",
    "scene_publisher",
    "operator_display",
    "recorder",
)

# Without a compiler the package installs all the same, with the coding in numpy alone.
compiled = [
    Extension(
        f"{PACKAGE}.{name}",
        [f"src/{PACKAGE}/{name.replace('.', '/')}.c"],
        # The last: registers of several numbers are returned by what is inlined alone.
        extra_compile_args=["-O3", "-ffp-contract=off", "-Wno-psabi"],
        optional=True,
    )
    for name in (
        "passive.sources.compiled_smoothing",
        "passive.subspaces.compiled_past",
        "active.baselines.compiled_clusters",
        "active.baselines.compiled_medians",
        "active.tracks.compiled_clouds",
        "active.tracks.compiled_densities",
        "active.tracks.compiled_gates",
        "active.tracks.compiled_modes",
        "simulation.signals.compiled_waveform",
        "tma.batch.compiled_linear",
        "tma.estimators.compiled_conditioning",
        "tma.estimators.compiled_errors",
        "tma.estimators.compiled_innovations",
        "tma.estimators.compiled_modes",
        "tma.estimators.compiled_monitor",
        "tma.estimators.compiled_rows",
        "tma.targets.compiled_information",
    )
]

node_executables = [f"{node} = {PACKAGE}.graph.nodes.{node}:main" for node in NODES]
command = ["sonar-tracking = sonar_tracking.__main__:main"]

# colcon puts console scripts where `ros2 run` looks for them, lib/sonar_tracking (setup.cfg). pip
# would put them into bin/, where nodes do not belong: there scripts/set_up.py makes them, from the
# entry point group sonar_tracking.nodes.
is_colcon = bool({"install", "develop"} & set(sys.argv))


def files_below(folder: str) -> list[tuple[str, list[str]]]:
    """List the files of a folder, directory by directory, for installation below share/."""
    directories = [Path(folder), *(path for path in Path(folder).rglob("*") if path.is_dir())]
    contents = {
        directory: [str(path) for path in sorted(directory.iterdir()) if path.is_file()]
        for directory in sorted(directories)
        if directory.name != "__pycache__"
    }
    return [(f"share/{PACKAGE}/{directory}", files) for directory, files in contents.items()]


def requirements_of_pip() -> dict[str, Any]:
    """Return what pip has to install; of Ubuntu 24.04 all but typer is new enough, if there."""
    run = [
        "backports.zstd>=1,<2",
        "lz4>=4,<5",
        "mcap>=1.2,<2",
        "numpy>=1.26,<3",
        "PyYAML>=6,<7",
        "rich>=13.7,<16",
        "rosbags>=0.11,<0.12",
        "scipy>=1.11,<2",
        "typer>=0.13,<1",
    ]
    plot = ["matplotlib>=3.6,<4"]
    page = ["tornado>=6.2,<7", "uplot-python>=1.1,<2"]
    audio = ["soundfile>=0.12,<1"]
    studies = [*plot, "dask>=2024.1", "distributed>=2024.1"]
    return {
        "install_requires": run,
        "extras_require": {
            # On a machine without ROS 2: rclpy and all messages as wheels (Linux on x86-64).
            "ros": [f"sonar-tracking-msgs=={VERSION}"],
            "audio": audio,
            "plot": plot,
            "page": page,
            "display": [*plot, *page],
            "studies": studies,
            "test": [*studies, *audio, *pinned("test.txt")],
            "docs": pinned("docs.txt"),
        },
    }


def pinned(name: str) -> list[str]:
    """Read the exact versions tests and documentation are made with."""
    lines = Path("requirements", name).read_text().splitlines()
    return [line for line in lines if line and not line.startswith("#")]


setup(
    name=PACKAGE,
    version=VERSION,
    description="Sonar tracking as a ROS 2 graph",
    author="The sonar_tracking developers",
    maintainer="The sonar_tracking developers",
    maintainer_email="sonar-tracking@example.org",
    license="Apache-2.0",
    python_requires=">=3.10,<3.14",
    package_dir={"": "src"},
    packages=find_packages("src"),
    package_data={PACKAGE: ["py.typed", "display/page/static/*", "display/page/static/views/*"]},
    ext_modules=compiled,
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{PACKAGE}"]),
        (f"share/{PACKAGE}", ["package.xml"]),
        *files_below("config"),
        *files_below("launch"),
        *files_below("msg_defs/msg"),
    ],
    zip_safe=False,
    entry_points={
        "console_scripts": command + (node_executables if is_colcon else []),
        "sonar_tracking.nodes": node_executables,
    },
    # rosdep installs what package.xml names; and a program that colcon makes must not ask for more.
    **({} if is_colcon else requirements_of_pip()),
)
