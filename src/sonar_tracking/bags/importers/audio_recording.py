"""What every import of audio files shares: their time axis, surveyed bearings, the bag."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from sonar_tracking.bags.audio.recorded_files import open_recording
from sonar_tracking.bags.audio.recording import Recording
from sonar_tracking.bags.contents.metadata import OfferedQuality
from sonar_tracking.bags.contents.recording_information import RecordingInformation
from sonar_tracking.bags.importers.array_geometry_file import RecordedArray
from sonar_tracking.bags.importers.bearing_truth_file import SurveyedBearings
from sonar_tracking.bags.importers.recorded_messages import truth_cdr
from sonar_tracking.bags.storage.writer import new_bag
from sonar_tracking.records.time import END_OF_DATA, NANOSECONDS

TRUTH_TOPIC = "/truth/bearing_tracks"

Message = tuple[int, str, bytes, int]
"""Stamp, topic, serialised message, samples or snapshots in it."""


@dataclass(frozen=True)
class GivenTime:
    """What a person says of the time of a recording.

    Attributes
    ----------
    epoch : int, optional
        Instant of the first sample, ns; goes before what the geometry file or audio files say.
    pattern : str, optional
        How the time stands in the names of the files, in directives of strftime.
    """

    epoch: int | None = None
    pattern: str | None = None


NOT_GIVEN = GivenTime()


def opened_recording(
    path: Path | str, array: RecordedArray, time: GivenTime
) -> tuple[Recording, RecordedArray]:
    """Open audio files for an array; return them, and the array with the epoch they have.

    Parameters
    ----------
    path : Path or str
        File or directory.
    array : RecordedArray
        The array; its epoch counts if its file gives one.
    time : GivenTime
        What is said of its time.

    Raises
    ------
    ConfigurationError
        If they cannot be used.
    """
    given = time.epoch if time.epoch is not None else array.epoch if array.epoch_is_given else None
    wanted = max(array.channels, default=len(array.element_positions))
    recording = open_recording(path, wanted, given, array.epoch, time.pattern)
    return recording, replace(array, epoch=recording.start)


def truth_messages(surveyed: list[SurveyedBearings], array: RecordedArray) -> Iterator[Message]:
    """Yield the surveyed bearings, each with the stamp of the next as its watermark."""
    stamps = [array.epoch + round(bearings.time * NANOSECONDS) for bearings in surveyed]
    for bearings, stamp, next_stamp in zip(
        surveyed, stamps, [*stamps[1:], END_OF_DATA], strict=False
    ):
        yield stamp, TRUTH_TOPIC, truth_cdr(array, stamp, next_stamp, bearings), 0


def write_messages(
    output: Path,
    information: RecordingInformation,
    inputs: dict[str, str],
    truth: dict[str, str],
    messages: Iterable[Message],
) -> tuple[Path, dict[str, int], int]:
    """Write a bag; return it, the messages of each topic, and the samples or snapshots in all.

    Parameters
    ----------
    output : Path
        The new bag.
    information : RecordingInformation
        What the bag shall know of its making.
    inputs, truth : dict of str to str
        Topic and message type of the data, and of what is known of the targets.
    messages : iterable
        By rising stamp.

    Raises
    ------
    ConfigurationError
        If the bag cannot be written to its end; nothing is left of it then.
    """
    counts: dict[str, int] = dict.fromkeys((*inputs, *truth), 0)
    total = 0
    with new_bag(output, information) as writer:
        for topic, type_name in inputs.items():
            writer.add_topic(topic, type_name, role="input")
        for topic, type_name in truth.items():
            quality = OfferedQuality(durability="transient_local")
            writer.add_topic(topic, type_name, role="truth", qos=quality)
        for stamp, topic, data, count in messages:
            writer.write(topic, stamp, data)
            counts[topic] += 1
            total += count
    return writer.path, counts, total
