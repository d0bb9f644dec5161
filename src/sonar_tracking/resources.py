"""Files of the package that are no Python: scenarios, parameters, profiles, launch files.

In a checkout (also when that is installed editable) they lie at the top of the source tree;
installed by pip or colcon, below ``share/sonar_tracking`` of the prefix the package is in.
"""

from __future__ import annotations

from pathlib import Path

from sonar_tracking.errors import ConfigurationError

_THIS_FILE = Path(__file__).resolve()


def find_resource(relative_path: str, package_file: Path = _THIS_FILE) -> Path:
    """Find a file or folder that belongs to the package.

    Parameters
    ----------
    relative_path : str
        As in the source tree, e.g. ``"config/scenarios"``.
    package_file : Path
        A module of the package the file belongs to.

    Returns
    -------
    Path
        Where it is.

    Raises
    ------
    ConfigurationError
        If the package was installed without it.
    """
    source_tree = package_file.parents[2]
    if (source_tree / "package.xml").is_file():
        folders = [source_tree]
    else:
        folders = [prefix / "share" / "sonar_tracking" for prefix in package_file.parents]
    for folder in folders:
        if (folder / relative_path).exists():
            return folder / relative_path
    raise ConfigurationError(
        f"{relative_path} does not belong to sonar_tracking as installed at "
        f"{package_file.parent}: see whether the name is right, or install the package again."
    )
