"""Writing of bags: rosbag2 directories (MCAP) that stock ROS 2 tools and Foxglove open.

A killed writer loses at most the last :data:`FLUSH_PERIOD` of wall time: what is older is with
the operating system. ``metadata.yaml`` is there from the start and completed at the end.
"""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sonar_tracking.bags.contents.bag_information import FILE_NAME, RECORD_KEY, RECORD_NAME
from sonar_tracking.bags.contents.message_definitions import MessageDefinition, installed_definition
from sonar_tracking.bags.contents.metadata import (
    OfferedQuality,
    TopicSummary,
    metadata_file_text,
    metadata_mapping,
    metadata_record_text,
)
from sonar_tracking.bags.contents.recording_information import (
    CUSTOM_DATA_KEY,
    RecordingInformation,
    Role,
)
from sonar_tracking.bags.mcap.mcap_writer import McapWriter
from sonar_tracking.errors import ConfigurationError, SonarTrackingError

FLUSH_PERIOD = 0.5
"""Longest time a message waits before it is handed to the operating system, s."""


@dataclass
class _Topic:
    channel: int
    definition: MessageDefinition
    quality: OfferedQuality
    count: int = 0


class BagWriter:
    """Writes one bag.

    Parameters
    ----------
    path : Path or str
        Directory to make; it must not exist.
    recording : RecordingInformation, optional
        Stored in ``metadata.yaml`` and in the MCAP file.
    custom_data : mapping of str to str, optional
        Names and texts of other applications, stored beside it.

    Raises
    ------
    ConfigurationError
        If the directory exists or cannot be made.
    """

    def __init__(
        self,
        path: Path | str,
        recording: RecordingInformation | None = None,
        custom_data: Mapping[str, str] | None = None,
    ) -> None:
        self.path = Path(path)
        try:
            self.path.mkdir(parents=True)
        except FileExistsError:
            raise ConfigurationError(
                f"{self.path} exists already; give another name or remove it."
            ) from None
        except OSError as error:
            raise ConfigurationError(
                f"The bag {self.path} cannot be made ({error.strerror})."
            ) from error
        own_data = {CUSTOM_DATA_KEY: recording.to_json()} if recording else {}
        self._custom_data = {**(custom_data or {}), **own_data}
        self._file_name = f"{self.path.resolve().name}_0.mcap"
        self._mcap = McapWriter(self.path / self._file_name, "sonar_tracking")
        self._topics: dict[str, _Topic] = {}
        self._schemas: dict[tuple[str, str], int] = {}
        self._times: tuple[int, int] | None = None
        self._last_flush = time.monotonic()
        self._closed = False
        if recording:
            self._mcap.add_metadata(CUSTOM_DATA_KEY, own_data)
        self._store_metadata()

    def add_topic(
        self,
        name: str,
        type_name: str,
        definition: MessageDefinition | None = None,
        role: Role = "other",
        qos: OfferedQuality | None = None,
    ) -> None:
        """Declare a topic; needed before its first message.

        Parameters
        ----------
        name : str
            Fully resolved topic name.
        type_name : str
            Message type, e.g. ``"nav_msgs/msg/Odometry"``.
        definition : MessageDefinition, optional
            Default: that of the installed package.
        role : Role
            Kept with the channel, so that it survives where the rest of the bag does not.
        qos : OfferedQuality, optional
            Default: reliable, volatile, depth 10.

        Raises
        ------
        ConfigurationError
            If the type is not installed, or the topic was declared already.
        """
        if name in self._topics:
            raise ConfigurationError(f"The topic {name} is declared twice in {self.path}.")
        definition = definition or installed_definition(type_name)
        quality = qos or OfferedQuality()
        key = (type_name, definition.text)
        if key not in self._schemas:
            self._schemas[key] = self._mcap.add_schema(
                type_name, definition.encoding, definition.text
            )
        channel = self._mcap.add_channel(
            name,
            self._schemas[key],
            {
                "offered_qos_profiles": quality.as_text(),
                "topic_type_hash": definition.type_hash,
                "sonar_tracking.role": role,
            },
        )
        self._topics[name] = _Topic(channel, definition, quality)
        self._mcap.flush()
        self._store_metadata()

    def write(self, topic: str, log_time: int, data: bytes) -> None:
        """Write one serialised message as it is.

        Parameters
        ----------
        topic : str
            A declared topic.
        log_time : int
            ns, not negative.
        data : bytes
            CDR with its encapsulation header.
        """
        entry = self._topics[topic]
        entry.count += 1
        self._mcap.add_message(entry.channel, log_time, data)
        first, last = self._times or (log_time, log_time)
        self._times = (min(first, log_time), max(last, log_time))
        self.flush_if_due()

    def flush_if_due(self) -> None:
        """Hand the messages to the system if :data:`FLUSH_PERIOD` has passed since the last time.

        Called by :meth:`write`; a recorder also calls it regularly, for the last messages before
        a pause.
        """
        now = time.monotonic()
        if now - self._last_flush >= FLUSH_PERIOD:
            self._last_flush = now
            if self._mcap.pending_messages:
                self._mcap.flush()

    def close(self) -> None:
        """Complete the file and ``metadata.yaml`` and see them to the disk; may be repeated."""
        if self._closed:
            return
        self._closed = True
        # Stock recorders leave the same record, so that the file can be used without its directory.
        self._mcap.add_metadata(RECORD_NAME, {RECORD_KEY: metadata_record_text(self._metadata())})
        self._mcap.close()
        self._store_metadata()
        for name in (self._file_name, FILE_NAME):
            with (self.path / name).open("rb") as file:
                os.fsync(file.fileno())

    def _metadata(self) -> dict[str, Any]:
        topics = [
            TopicSummary(
                name,
                topic.definition.type_name,
                topic.definition.type_hash,
                topic.quality,
                topic.count,
            )
            for name, topic in self._topics.items()
        ]
        return metadata_mapping(self._file_name, topics, self._times, self._custom_data)

    def _store_metadata(self) -> None:
        """Replace ``metadata.yaml`` in one step: a reader never sees half a file."""
        temporary = self.path / f".{FILE_NAME}"
        try:
            temporary.write_text(metadata_file_text(self._metadata()), encoding="utf-8")
            temporary.replace(self.path / FILE_NAME)
        except OSError:
            temporary.unlink(missing_ok=True)
            raise


@contextmanager
def new_bag(
    path: Path | str,
    recording: RecordingInformation | None = None,
    custom_data: Mapping[str, str] | None = None,
) -> Iterator[BagWriter]:
    """Write a bag that is whole at the end, or not there at all.

    Parameters
    ----------
    path, recording, custom_data
        See :class:`BagWriter`.

    Yields
    ------
    BagWriter
        Closed at the end of the block.

    Raises
    ------
    ConfigurationError
        If the bag exists, cannot be made or not be written to its end.
    """
    existed = Path(path).exists()
    try:
        writer = BagWriter(path, recording, custom_data)
        yield writer
        writer.close()
    except (OSError, SonarTrackingError) as error:
        if not existed:
            shutil.rmtree(path, ignore_errors=True)
        if isinstance(error, OSError):
            raise ConfigurationError(
                f"The bag {path} cannot be written ({error.strerror}); make room or give another "
                "path. Nothing is left of it."
            ) from error
        raise
