"""What could be opened of a bag, and what is missing of it."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from sonar_tracking.bags.contents.bag_information import FILE_NAME, BagInformation
from sonar_tracking.bags.contents.loss import Loss, losses_text
from sonar_tracking.bags.contents.storage_file import Storage, UnreadableFileError
from sonar_tracking.bags.storage.bag_files import BagFiles, chosen_files, open_file, plain_name


@dataclass(frozen=True)
class OpenedFiles:
    """The files of a bag that could be opened.

    Attributes
    ----------
    storages : list of Storage
        In order of recording.
    reasons : list of str
        Why not all of the bag can be read.
    losses : list of Loss
        Messages that were recorded and cannot be read.
    by_name : dict
        All files found, by their names without compression.
    """

    storages: list[Storage]
    reasons: list[str]
    losses: list[Loss]
    by_name: dict[str, Path]


def opened_files(files: BagFiles) -> OpenedFiles:
    """Open all files; one in which nothing can be read is missed, if others are there."""
    storages: list[Storage] = []
    reasons = [f"{name} is missing" for name in files.missing]
    losses = [Loss()] if files.missing else []
    unreadable: list[UnreadableFileError] = []
    counts: Counter[str] = Counter()
    for file in files.found:
        try:
            storage = open_file(file)
        except UnreadableFileError as error:
            unreadable.append(error)
            losses.append(Loss(intact_before=dict(counts)))
            continue
        storages.append(storage)
        losses += [loss.after(counts) for loss in storage.losses]
        for topic in storage.topics:
            counts[topic.name] += topic.message_count
        if storage.damage:
            where = f"{file.name}: " if len(files.found) > 1 else ""
            reasons.append(f"{where}{storage.damage}")
    if not storages:
        raise unreadable[0]
    reasons += [str(error).rstrip(".") for error in unreadable]
    return OpenedFiles(
        storages, reasons, losses, {plain_name(file.name): file for file in files.found}
    )


def recovery_sentence(
    path: Path, files: OpenedFiles, metadata: BagInformation | None, unreadable: str
) -> str | None:
    """Return the sentence on what is missing, or None.

    Parameters
    ----------
    path : Path
        The bag.
    files : OpenedFiles
        What could be opened of it.
    metadata : BagInformation or None
        What its ``metadata.yaml`` says.
    unreadable : str
        What else of it cannot be read; empty = nothing.
    """
    count = sum(topic.message_count for storage in files.storages for topic in storage.topics)
    reasons = [*files.reasons, *([unreadable] if unreadable else [])]
    last = _last_information(files.storages)
    stated = metadata.message_count if metadata else _count_of_records(path, last)
    if path.is_dir() and metadata is None:
        reasons.append(f"its {FILE_NAME} is missing or damaged")
        reasons += _missing_by_record(files, last)
    elif not reasons and stated is not None and stated != count:
        source = FILE_NAME if metadata else "metadata record"
        reasons.append(f"its {source} speaks of {stated} messages")
    if not reasons:
        return None
    begin = min((part.first for storage in files.storages for part in storage.parts), default=0)
    if files.losses:
        reasons.append(losses_text(files.losses, begin))
    of_all = f" of {stated}" if stated and stated > count else ""
    return f"{path} is not whole ({'; '.join(reasons)}); {count}{of_all} messages were recovered."


def _last_information(storages: list[Storage]) -> BagInformation | None:
    """Return what the files say of the bag; the one closed last knows of all the others."""
    stated = [storage.information for storage in storages if storage.information]
    return max(stated, key=lambda information: len(information.file_names), default=None)


def _count_of_records(path: Path, last: BagInformation | None) -> int | None:
    """Return the number of messages the files state for what is there, None = unknown.

    A file that was never closed, or of which others were to follow, states none that is final.
    """
    if last is None or (path.is_file() and len(last.file_names) > 1):
        return None
    return last.message_count or None


def _missing_by_record(files: OpenedFiles, last: BagInformation | None) -> list[str]:
    """Return what is missing of the files the bag names, unless all have other names by now."""
    chosen = chosen_files(files.by_name, last.file_names) if last else None
    return [f"{name} is missing" for name in chosen.missing] if chosen else []
