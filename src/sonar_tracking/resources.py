"""Files that belong to the package but are no Python: scenarios, parameters, profiles, launch files.

They lie at three places, depending on how the package was installed: in the source tree (a
checkout, also when installed editable), below ``share/sonar_tracking`` of the Python environment
(pip), and below ``share/sonar_tracking`` of a colcon prefix.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from pathlib import Path

from sonar_tracking.errors import ConfigurationError

_SHARE = Path("share") / "sonar_tracking"


def find_resource(relative_path: str) -> Path:
    """Find a file or folder that belongs to the package.

    Parameters
    ----------
    relative_path : str
        As in the source tree, e.g. ``"config/scenarios"``.

    Returns
    -------
    Path
        Where it is; the source tree is preferred to the environment and this to colcon prefixes.

    Raises
    ------
    ConfigurationError
        If it is at none of the places.
    """
    searched = list(_resource_folders())
    for folder in searched:
        if (folder / relative_path).exists():
            return folder / relative_path
    raise ConfigurationError(
        f"{relative_path} of sonar_tracking was found in none of "
        f"{', '.join(str(folder) for folder in searched)}: install the package again"
    )


def _resource_folders() -> Iterator[Path]:
    source_tree = Path(__file__).resolve().parents[2]
    if (source_tree / "package.xml").is_file():
        yield source_tree
    yield Path(sys.prefix) / _SHARE
    for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep):
        if prefix:
            yield Path(prefix) / _SHARE
