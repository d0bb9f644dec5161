"""Which files a bag consists of, and how each is opened."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable
from dataclasses import dataclass
from pathlib import Path

from sonar_tracking.bags.contents.bag_information import BagInformation
from sonar_tracking.bags.contents.decompression import decompressed_file
from sonar_tracking.bags.contents.loss import Loss
from sonar_tracking.bags.contents.storage_file import Storage, UnreadableFileError
from sonar_tracking.bags.storage.compressed_messages import with_whole_messages
from sonar_tracking.errors import ConfigurationError

_KINDS = (".mcap", ".db3")
_COMPRESSED = (".zstd", ".zst")


@dataclass(frozen=True)
class BagFiles:
    """The files of a bag.

    Attributes
    ----------
    found : tuple of Path
        In order of recording.
    missing : tuple of str
        Names of those the bag speaks of and that are not there.
    """

    found: tuple[Path, ...]
    missing: tuple[str, ...] = ()


def files_of(path: Path, metadata: BagInformation | None) -> BagFiles:
    """Return the files of a bag.

    Parameters
    ----------
    path : Path
        Directory or single file.
    metadata : BagInformation or None
        What ``metadata.yaml`` of the directory says.

    Raises
    ------
    ConfigurationError
        If there are none, or they are compressed in a way that cannot be read.
    """
    if not path.exists():
        raise ConfigurationError(f"{path} does not exist; give a bag directory.")
    if path.is_file():
        if not _is_bag_file(path):
            raise ConfigurationError(
                f"{path} is not a bag; give a rosbag2 directory, a .mcap or a .db3 file, or one "
                "of these compressed by zstd."
            )
        return BagFiles((path,))
    if metadata is not None:
        _check_compression(str(path), metadata, ("FILE", "MESSAGE"))
    named = metadata.file_names if metadata else ()
    there = _one_of_each((entry for entry in path.iterdir() if _is_bag_file(entry)), named)
    if not there:
        entries = ", ".join(sorted(entry.name for entry in path.iterdir())[:5]) or "nothing"
        raise ConfigurationError(
            f"{path} is not a bag: it holds no .mcap or .db3 file, but {entries}."
        )
    return chosen_files(there, named) or BagFiles(tuple(there.values()))


def chosen_files(there: dict[str, Path], named: Iterable[str]) -> BagFiles | None:
    """Return the files that a bag names, compressed or not; None if not one of them is there.

    Parameters
    ----------
    there : dict
        Files by their names without compression.
    named : iterable of str
        Names in order of recording.
    """
    names = [plain_name(name) for name in named]
    found = tuple(there[name] for name in names if name in there)
    return BagFiles(found, tuple(name for name in names if name not in there)) if found else None


def plain_name(name: str) -> str:
    """Return the name a file has when it is not compressed."""
    stem, dot, last = name.rpartition(".")
    return stem if dot + last in _COMPRESSED else name


def natural_order(name: str) -> tuple[tuple[str, int], ...]:
    """Return a key that puts numbers in names in order of their size: ``k_2`` before ``k_10``."""
    return tuple((text, int(number or 0)) for text, number in re.findall(r"(\D*)(\d*)", name))


def open_file(path: Path) -> Storage:
    """Open a file of a bag.

    Raises
    ------
    UnreadableFileError
        If nothing in it can be read.
    ConfigurationError
        If it is compressed and cannot be decompressed here, or exceeds a bound.
    """
    if path.suffix not in _COMPRESSED:
        return _opened(path, str(path))
    try:
        with decompressed_file(path) as (plain, damage):
            try:
                storage = _opened(plain, str(path))
            except UnreadableFileError as error:
                sentence = f"{path} cannot be read ({damage})." if damage else str(error)
                raise UnreadableFileError(sentence) from error
    except OSError as error:
        raise UnreadableFileError(f"{path} cannot be read ({error.strerror}).") from error
    storage.damage = damage or storage.damage
    if damage and not storage.losses:
        storage.losses.append(Loss())
    return storage


def _opened(path: Path, name: str) -> Storage:
    storage: Storage
    if path.suffix == ".db3":
        from sonar_tracking.bags.sqlite.sqlite_storage import open_sqlite

        storage = open_sqlite(path, name)
    else:
        from sonar_tracking.bags.mcap.mcap_storage import McapStorage

        storage = McapStorage(path, name)
    if storage.information is not None:
        _check_compression(name, storage.information, ("MESSAGE",))
    return with_whole_messages(storage, name)


def _is_bag_file(path: Path) -> bool:
    return Path(plain_name(path.name)).suffix in _KINDS and path.is_file()


def _one_of_each(files: Iterable[Path], named: Collection[str]) -> dict[str, Path]:
    """Return the files by their names without compression, in natural order.

    A player leaves what it has decompressed beside the compressed file, and a recorder that was
    killed what it was compressing. Where both are there, the bag names the one that is whole; where
    it names none, the recorder was killed, and the whole one is that which is not compressed.
    """
    chosen: dict[str, Path] = {}
    for file in sorted(files, key=lambda file: (file.name in named, file.name), reverse=True):
        name = plain_name(file.name)
        if name not in chosen or (file.name == name and chosen[name].name not in named):
            chosen[name] = file
    return dict(sorted(chosen.items(), key=lambda item: natural_order(item[0])))


def _check_compression(name: str, information: BagInformation, modes: Collection[str]) -> None:
    """Refuse what a bag says to be compressed by anything but zstd.

    Parameters
    ----------
    name : str
        Of the bag or file.
    information : BagInformation
        What it says of itself.
    modes : collection of str
        The modes of compression that matter: a file that is open is not compressed as a file.
    """
    compression = information.compression_format
    # A name with one wrong letter is a damaged one; the data tell whether they are compressed.
    damaged = len(compression) == 4 and sum(map(str.__ne__, compression, "zstd")) <= 1
    if information.compression_mode in modes and compression and not damaged:
        raise ConfigurationError(
            f"{name} is compressed by {compression}, which cannot be read here; only zstd can: "
            "decompress it with the tool that wrote it."
        )
