"""What every import of a WAV file shares: stamps of samples, a missing end, surveyed bearings."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

from sonar_tracking.bags.importers.array_geometry_file import RecordedArray
from sonar_tracking.bags.importers.bearing_truth_file import SurveyedBearings
from sonar_tracking.bags.importers.recorded_messages import truth_cdr
from sonar_tracking.bags.importers.wav_file import WavFile
from sonar_tracking.bags.storage.bag_records import BEARING_TRACKS_TYPE
from sonar_tracking.bags.storage.metadata import OfferedQuality
from sonar_tracking.bags.storage.recording_information import RecordingInformation
from sonar_tracking.bags.storage.writer import new_bag
from sonar_tracking.records.time import END_OF_DATA, NANOSECONDS

TRUTH_TOPIC = "/truth/bearing_tracks"

Message = tuple[int, str, bytes, int]
"""Stamp, topic, serialised message, samples or snapshots in it."""


def sample_stamp(array: RecordedArray, wav: WavFile, sample: int) -> int:
    """Return the instant of a sample, ns."""
    return array.epoch + (sample * NANOSECONDS + wav.sample_rate // 2) // wav.sample_rate


def missing_end(wav: WavFile) -> list[str]:
    """Return a sentence if the file is shorter than it says."""
    if not wav.missing_samples:
        return []
    announced = (wav.n_samples + wav.missing_samples) / wav.sample_rate
    return [
        f"{wav.path} is cut off: it announces {announced:.1f} s and holds "
        f"{wav.n_samples / wav.sample_rate:.1f} s; copy it again if the rest is wanted."
    ]


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
    messages: Iterable[Message],
) -> tuple[Path, dict[str, int], int]:
    """Write a bag; return it, the messages of each topic, and the samples or snapshots in all.

    Parameters
    ----------
    output : Path
        The new bag.
    information : RecordingInformation
        What the bag shall know of its making; its roles say whether there is truth.
    inputs : dict of str to str
        Topic and message type of the data.
    messages : iterable
        By rising stamp.

    Raises
    ------
    ConfigurationError
        If the bag cannot be written to its end; nothing is left of it then.
    """
    counts: dict[str, int] = dict.fromkeys((*inputs, TRUTH_TOPIC), 0)
    total = 0
    with new_bag(output, information) as writer:
        for topic, type_name in inputs.items():
            writer.add_topic(topic, type_name, role="input")
        if TRUTH_TOPIC in information.topic_roles:
            quality = OfferedQuality(durability="transient_local")
            writer.add_topic(TRUTH_TOPIC, BEARING_TRACKS_TYPE, role="truth", qos=quality)
        for stamp, topic, data, count in messages:
            writer.write(topic, stamp, data)
            counts[topic] += 1
            total += count
    return writer.path, counts, total
