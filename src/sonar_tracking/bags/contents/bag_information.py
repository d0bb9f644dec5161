"""What a bag says of itself: files, number of messages, compression, data of the application.

rosbag2 keeps one mapping in two places: in ``metadata.yaml`` below the key
``rosbag2_bagfile_information``, and without that key in each file (MCAP: in the metadata record
``rosbag2``; sqlite3: in the table ``metadata``), so that a file is of use without its directory.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path, PurePosixPath
from types import MappingProxyType
from typing import Any

from sonar_tracking.bags.contents.stored_text import LARGEST_YAML, StoredTextError, yaml_value

FILE_NAME = "metadata.yaml"
WRAPPING_KEY = "rosbag2_bagfile_information"
RECORD_NAME = "rosbag2"
"""Name of the MCAP metadata record."""
RECORD_KEY = "serialized_metadata"
"""Entry of that record which holds the mapping as YAML."""


@dataclass(frozen=True)
class BagInformation:
    """The part of the mapping that reading needs.

    Attributes
    ----------
    message_count : int or None
        Messages of the whole bag; None = not stated.
    file_names : tuple of str
        Names of all files of the bag, without directories, in order of recording.
    custom_data : mapping of str to str
        Names and texts of the application.
    compression_mode : str
        ``"FILE"``, ``"MESSAGE"`` or, where nothing is compressed, empty.
    compression_format : str
        E.g. ``"zstd"``.
    wrapped : bool
        Whether the mapping stood below :data:`WRAPPING_KEY`.
    """

    message_count: int | None = None
    file_names: tuple[str, ...] = ()
    custom_data: Mapping[str, str] = field(default_factory=dict)
    compression_mode: str = ""
    compression_format: str = ""
    wrapped: bool = False


def read_metadata_file(directory: Path) -> BagInformation | None:
    """Return what ``metadata.yaml`` says, or None where it is missing or unreadable."""
    try:
        with (directory / FILE_NAME).open(encoding="utf-8") as file:
            text = file.read(LARGEST_YAML + 1)
    except (OSError, UnicodeDecodeError):
        return None
    information = information_from_text(text)
    return information if information and information.wrapped else None


@lru_cache(maxsize=8)  # the files of a bag repeat it, and a bag is opened more than once
def information_from_text(text: str) -> BagInformation | None:
    """Return what a mapping written as YAML says, wrapped or bare; None where it is none."""
    try:
        values = yaml_value(text)
    except StoredTextError:
        return None
    if not isinstance(values, dict):
        return None
    wrapped = WRAPPING_KEY in values
    values = values[WRAPPING_KEY] if wrapped else values
    if not isinstance(values, dict):
        return None
    custom_data = values.get("custom_data")
    mode = _text(values.get("compression_mode")).upper()
    return BagInformation(
        message_count=_count(values.get("message_count")),
        file_names=_file_names(values.get("relative_file_paths")),
        custom_data=MappingProxyType(_texts(custom_data if isinstance(custom_data, dict) else {})),
        compression_mode="" if mode in ("NONE", "STORAGE") else mode,
        compression_format=_text(values.get("compression_format")).lower(),
        wrapped=wrapped,
    )


def _count(value: Any) -> int | None:
    return value if isinstance(value, int) and not isinstance(value, bool) else None


def _file_names(value: Any) -> tuple[str, ...]:
    """Return the names alone: bags before version 4 name the directory of the bag as well."""
    entries = value if isinstance(value, list) else []
    return tuple(PurePosixPath(entry).name for entry in entries if isinstance(entry, str))


def _text(value: Any) -> str:
    return value if isinstance(value, str) else ""


def _texts(values: Mapping[Any, Any]) -> dict[str, str]:
    return {
        name: text
        for name, text in values.items()
        if isinstance(name, str) and isinstance(text, str)
    }
