"""Files and directories that hold one recording: which file follows, and which is beside, another.

Several files are either consecutive, each with all channels, or of one hydrophone each: then they
are told apart by what remains of their names without the time.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Sequence
from datetime import datetime, timezone
from pathlib import Path

from sonar_tracking.bags.audio.audio_file import AudioFile
from sonar_tracking.bags.audio.open_audio import AUDIO_ENDINGS, open_audio
from sonar_tracking.bags.audio.recording import AudioPart, Recording, joined
from sonar_tracking.bags.audio.start_times import NamedStart, start_in_name
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.records.time import NANOSECONDS, seconds

_DISAGREEING = 2.0
"""Difference of two statements of the begin of a file that is reported, s."""


def open_recording(
    path: Path | str,
    wanted_channels: int = 0,
    epoch: int | None = None,
    default_epoch: int = 0,
    time_pattern: str | None = None,
) -> Recording:
    """Open a file, or all audio files in a directory, as one recording.

    The instant of the first sample is ``epoch``; else that in the name of the first file; else
    that in its ``bext`` chunk; else ``default_epoch``, and this is reported.

    Parameters
    ----------
    path : Path or str
        File or directory.
    wanted_channels : int
        Channels the array needs: several files with fewer of them are one beside the other; 0 =
        not known: those that begin together are.
    epoch : int, optional
        Given for the first sample, ns.
    default_epoch : int
        Where nothing tells the time, ns.
    time_pattern : str, optional
        How the time stands in the names, in directives of strftime.

    Raises
    ------
    ConfigurationError
        If there is no audio file, one cannot be read, some have times and others have not, or they
        do not belong together.
    """
    path = Path(path)
    paths = audio_paths(path)
    files = _opened(paths)
    if not files[0]:
        raise ConfigurationError(files[1][0])
    notes = list(files[1])
    named = {file.path: start_in_name(file.path.stem, time_pattern) for file in files[0]}
    _check_pattern(named, time_pattern)
    starts = _starts(files[0], named, notes)
    parts = _parts(files[0], named, starts, wanted_channels, notes)
    first = min((part.start for part in parts if part.start is not None), default=None)
    chosen, source = _epoch(epoch, first, default_epoch)
    notes += source
    return joined(path, parts, chosen, notes)


def audio_paths(path: Path) -> list[Path]:
    """Return a file, or the audio files of a directory in natural order.

    Raises
    ------
    ConfigurationError
        If the directory has none.
    """
    if not path.is_dir():
        return [path]
    found = [
        each
        for each in path.iterdir()
        if each.suffix.lower() in AUDIO_ENDINGS and not each.name.startswith(".")
    ]
    if not found:
        raise ConfigurationError(
            f"The directory {path} has no audio file ({', '.join(AUDIO_ENDINGS)}); give another."
        )
    return sorted(found, key=lambda each: natural_order(each.name))


def natural_order(name: str) -> list[tuple[int, str]]:
    """Return a key of the name of a file by which file 10 comes after file 9."""
    parts = re.split(r"(\d+)", name)
    return [(int(part), "") if index % 2 else (0, part) for index, part in enumerate(parts)]


def _opened(paths: Sequence[Path]) -> tuple[list[AudioFile], list[str]]:
    """Return the files that can be read, and a sentence for each of a directory that cannot."""
    files, notes = [], []
    for path in paths:
        try:
            files.append(open_audio(path))
        except ConfigurationError as error:
            if len(paths) == 1:
                raise
            notes.append(f"{error} It is left out.")
    return files, notes


def _check_pattern(named: dict[Path, NamedStart | None], pattern: str | None) -> None:
    if pattern is None:
        return
    for path, start in named.items():
        if start is None:
            raise ConfigurationError(
                f"{path.name} does not fit --time-pattern {pattern!r}; give one that fits all "
                "names, or take the file out of the directory."
            )


def _starts(
    files: Sequence[AudioFile], named: dict[Path, NamedStart | None], notes: list[str]
) -> dict[Path, tuple[int, float]]:
    """Return the begin of each file, ns, and its resolution, s, where name or file say it."""
    starts = {}
    for file in files:
        name, origin = named[file.path], file.description.origin
        if name is not None:
            starts[file.path] = name.instant, name.resolution
            apart = seconds(origin.instant - name.instant) if origin is not None else 0.0
            if abs(apart) > _DISAGREEING:
                notes.append(
                    f"{file.path}: its bext chunk is {abs(apart):.0f} s "
                    f"{'after' if apart > 0 else 'before'} the time in its name, which is taken."
                )
        elif origin is not None:
            starts[file.path] = origin.instant, 1.0
            notes += [origin.doubt] if origin.doubt else []
    if starts and len(starts) < len(files):
        lacking = next(file.path for file in files if file.path not in starts)
        raise ConfigurationError(
            f"{lacking} has no time in its name or a bext chunk, and {len(starts)} of "
            f"{len(files)} files have; name them alike, give --time-pattern, or take it out."
        )
    return starts


def _parts(
    files: Sequence[AudioFile],
    named: dict[Path, NamedStart | None],
    starts: dict[Path, tuple[int, float]],
    wanted_channels: int,
    notes: list[str],
) -> list[AudioPart]:
    """Return the files as parts: each on its own, or those of all hydrophones together."""
    beside = len(files) > 1 and all(file.n_channels < wanted_channels for file in files)
    if not wanted_channels:
        begins = [starts[file.path][0] for file in files if file.path in starts]
        beside = len(set(begins)) < len(begins)
    if not beside:
        if not starts and len(files) > 1:
            notes.append(
                f"{len(files)} files without times are taken one after the other without a gap, in "
                "the order of their names; --time-pattern says where the time stands in a name."
            )
        return [AudioPart((file,), *starts.get(file.path, (None, 1.0))) for file in files]
    groups: dict[str, list[AudioFile]] = defaultdict(list)
    for file in files:
        name = named[file.path]
        groups[name.rest if name is not None else file.path.name].append(file)
    if len(groups) == 1:
        # Names that hold only the time: those of one time are side by side.
        return [AudioPart((file,), *starts.get(file.path, (None, 1.0))) for file in files]
    return _side_by_side([groups[key] for key in sorted(groups, key=natural_order)], starts, notes)


def _side_by_side(
    hydrophones: Sequence[Sequence[AudioFile]],
    starts: dict[Path, tuple[int, float]],
    notes: list[str],
) -> list[AudioPart]:
    first = hydrophones[0]
    order = ", ".join(files[0].path.name for files in hydrophones[:3])
    more = f" and {len(hydrophones) - 3} more" if len(hydrophones) > 3 else ""
    notes.append(
        f"{len(hydrophones)} hydrophones have a file each, in this order of channels: "
        f"{order}{more}. They are taken to begin at the same sample: bearings need recorders that "
        "were synchronised."
    )
    parts = []
    for files in hydrophones:
        if len(files) != len(first):
            raise ConfigurationError(
                f"{files[0].path} and those after it are {len(files)} files, "
                f"{first[0].path} and those after it {len(first)}; give as many files of each "
                "hydrophone."
            )
    differing: list[str] = []
    for beside in zip(*hydrophones, strict=True):
        begin = starts.get(beside[0].path, (None, 1.0))
        for file in beside[1:]:
            apart = (starts.get(file.path, begin)[0] or 0) - (begin[0] or 0)
            if abs(apart) > begin[1] * NANOSECONDS:
                raise ConfigurationError(
                    f"{file.path} begins {seconds(apart):+.1f} s from {beside[0].path}; files of "
                    "hydrophones must begin together: cut them to the same begin."
                )
            if abs(file.n_samples - beside[0].n_samples) > 0:
                apart_ms = 1e3 * (file.seconds - beside[0].seconds)
                differing.append(f"{file.path.name} by {apart_ms:+.1f} ms")
        parts.append(AudioPart(tuple(beside), *begin))
    if differing:
        shown = ", ".join(differing[:3]) + (
            f" and {len(differing) - 3} more" if len(differing) > 3 else ""
        )
        notes.append(
            f"{len(differing)} files differ in length from that of the first hydrophone, as where "
            f"clocks drift: {shown}; what all have is used."
        )
    return parts


def _epoch(given: int | None, first: int | None, default_epoch: int) -> tuple[int, list[str]]:
    """Return the instant of the first sample, ns, and a sentence on where it comes from."""
    if given is not None:
        if first is None or abs(seconds(given - first)) <= _DISAGREEING:
            return given, []
        return given, [
            f"The first sample is put at {_text(given)}, as given; the files say {_text(first)}."
        ]
    if first is not None:
        return first, [f"The first sample is at {_text(first)}, as the files say, taken as UTC."]
    return default_epoch, [
        f"Nothing says when the recording began: it is put at {_text(default_epoch)}; give "
        "--epoch, or --time-pattern if the name has the time."
    ]


def _text(instant: int) -> str:
    when = datetime.fromtimestamp(instant // NANOSECONDS, tz=timezone.utc)
    fraction = instant % NANOSECONDS // 1_000_000
    return f"{when:%Y-%m-%dT%H:%M:%S}" + (f".{fraction:03d}Z" if fraction else "Z")
