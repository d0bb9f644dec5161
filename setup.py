"""Build of sonar_tracking, for pip and for colcon.

All metadata are here: a [project] table in pyproject.toml would make colcon ignore them.
"""

import sys
from pathlib import Path

from setuptools import find_packages, setup

PACKAGE = "sonar_tracking"
NODES = (
    "array_simulator",
    "hydrophone_simulator",
    "bearing_simulator",
    "contact_simulator",
    "band_demodulator",
    "subspace_estimator",
    "bearing_tracker",
    "line_tracker",
    "tma_tracker",
    "hpda_tracker",
    "recorder",
)

node_executables = [f"{node} = {PACKAGE}.graph.nodes.{node}:main" for node in NODES]
command = ["sonar-tracking = sonar_tracking.cli:main"]

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


setup(
    name=PACKAGE,
    version="0.1.0",
    description="Sonar tracking as a ROS 2 graph",
    author="The sonar_tracking developers",
    maintainer="The sonar_tracking developers",
    maintainer_email="sonar-tracking@example.org",
    license="Apache-2.0",
    python_requires=">=3.10,<3.14",
    package_dir={"": "src"},
    packages=find_packages("src"),
    package_data={PACKAGE: ["py.typed"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{PACKAGE}"]),
        (f"share/{PACKAGE}", ["package.xml"]),
        *files_below("config"),
        *files_below("launch"),
    ],
    zip_safe=False,
    entry_points={
        "console_scripts": command + (node_executables if is_colcon else []),
        "sonar_tracking.nodes": node_executables,
    },
)
