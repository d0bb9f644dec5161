"""Data that others have recorded: where the tests look for them, and where their owners offer them.

The extracts are no part of the project: their owners publish the data under terms of their own.
"""

from __future__ import annotations

import os
from pathlib import Path

import pytest

FOLDER_VARIABLE = "SONAR_TRACKING_DATA"
PROJECT = Path(__file__).resolve().parents[1]
FOLDERS = (PROJECT / "data", PROJECT.parent / "shared" / "data")
"""Where the data are, unless the variable names a folder: in the project, or beside it."""

PUBLISHED = {
    "harp_ship_bearings": "https://github.com/ericSnyderSIO/wheresWhaledo",
    "maritime_contacts": "https://github.com/Autoferry/sensor_fusion_dataset",
    "ula32_room_responses": "https://github.com/polimi-ispl/rs-mnmf",
    "whale_click_bearings": "https://github.com/ericSnyderSIO/wheresWhaledo",
}
"""Data set to the address where its owners publish it."""


def recorded_data(file: str) -> Path:
    """Return a file of recorded data, or skip the test and say where to get it.

    Parameters
    ----------
    file : str
        ``<data set>/<file>``.

    Returns
    -------
    Path
        The file.
    """
    named = os.environ.get(FOLDER_VARIABLE)
    folders = (Path(named),) if named else FOLDERS
    for folder in folders:
        if (folder / file).is_file():
            return folder / file
    address = PUBLISHED[file.partition("/")[0]]
    pytest.skip(
        f"needs {file}, an extract of {address} (see docs/reference/data_sets.md): put it into the "
        f"folder data/ of the project, or name the folder of all data sets with {FOLDER_VARIABLE}"
    )
