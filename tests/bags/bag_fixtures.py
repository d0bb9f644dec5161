"""Messages and bags the tests of this directory share."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from sonar_tracking.bags.contents.bag_information import WRAPPING_KEY
from sonar_tracking.bags.contents.message_definitions import installed_typestore
from sonar_tracking.bags.contents.recording_information import RecordingInformation
from sonar_tracking.bags.mcap.mcap_writer import McapWriter
from sonar_tracking.bags.storage.writer import BagWriter
from sonar_tracking.records.bearings import TrackStatus

SNAPSHOTS = "sonar_tracking_msgs/msg/ArraySnapshots"
TRACKS = "sonar_tracking_msgs/msg/BearingTracks"
CLOCK = "rosgraph_msgs/msg/Clock"
EPOCH = 1_767_225_600
SECOND = 1_000_000_000


def filled(type_name: str, **values: Any) -> Any:
    """Return a message of a type with all fields zero or empty but the given ones."""
    store = installed_typestore(type_name)
    fields = {}
    for name, (kind, detail) in store.fielddefs[type_name][1]:
        if name in values:
            fields[name] = values.pop(name)
        elif int(kind) == 2:
            fields[name] = filled_nested(store, str(detail))
        elif int(kind) == 1:
            fields[name] = "" if detail[0] == "string" else 0
        else:
            fields[name] = np.zeros(0, dtype=detail[0][1][0])
    assert not values
    return store.types[type_name](**fields)


def filled_nested(store: Any, type_name: str) -> Any:
    fields = {}
    for name, (kind, detail) in store.fielddefs[type_name][1]:
        if int(kind) == 2:
            fields[name] = filled_nested(store, str(detail))
        else:
            fields[name] = "" if detail[0] == "string" else 0
    return store.types[type_name](**fields)


def snapshots_cdr(second: int, nanosecond: int = 0, n_snapshots: int = 20) -> bytes:
    """Return a serialised snapshot block of three elements."""
    store = installed_typestore(SNAPSHOTS)
    data = np.arange(2 * 3 * n_snapshots, dtype=np.float32) + second
    places = {f"element_{axis}": np.zeros(3) for axis in "yz"} | {"element_x": np.arange(3.0)}
    message = filled(
        SNAPSHOTS,
        sensor_id="array",
        n_snapshots=n_snapshots,
        data=data,
        sample_period=0.05,
        center_frequency=750.0,
        sound_speed=1500.0,
        **places,
    )
    message.header.stamp.sec, message.header.stamp.nanosec = EPOCH + second, nanosecond
    return bytes(store.serialize_cdr(message, SNAPSHOTS))


def tracks_cdr(second: int) -> bytes:
    """Return a serialised list of one bearing track, which is tentative."""
    message = filled(
        TRACKS,
        id=np.array([7], dtype=np.uint64),
        arrival_angle=np.array([0.25]),
        status=np.array([TrackStatus.TENTATIVE], dtype=np.uint8),
    )
    message.header.stamp.sec = EPOCH + second
    return bytes(installed_typestore(TRACKS).serialize_cdr(message, TRACKS))


def clock_cdr(second: int) -> bytes:
    """Return a serialised clock."""
    message = filled(CLOCK)
    message.clock.sec = EPOCH + second
    return bytes(installed_typestore(CLOCK).serialize_cdr(message, CLOCK))


def information() -> RecordingInformation:
    """Return recording information as the orchestration gives it."""
    return RecordingInformation(
        scenario={"name": "two crossing", "seed": 3, "targets": [{"bearing_deg": 10.0}]},
        node_parameters={"bearing_tracker": {"method": "ryu"}},
        topic_roles={"/array/snapshots": "input", "/passive/bearing_tracks": "output"},
    )


def open_writer(path: Path) -> BagWriter:
    """Return a writer with three declared topics."""
    writer = BagWriter(path, information())
    writer.add_topic("/array/snapshots", SNAPSHOTS, role="input")
    writer.add_topic("/passive/bearing_tracks", TRACKS, role="output")
    writer.add_topic("/clock", CLOCK)
    return writer


def write_messages(writer: BagWriter, n_seconds: int) -> list[tuple[str, int, bytes]]:
    """Write one message a topic and second, tracks one second late; return what was written."""
    written = []
    for second in range(n_seconds):
        written.append(("/clock", second, clock_cdr(second)))
        written.append(("/array/snapshots", second, snapshots_cdr(second)))
        if second:
            written.append(("/passive/bearing_tracks", second - 1, tracks_cdr(second - 1)))
    messages = [(topic, (EPOCH + second) * SECOND, data) for topic, second, data in written]
    for topic, log_time, data in messages:
        writer.write(topic, log_time, data)
    return messages


def write_wrapped_record(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the writer wrap the record, as bags of version 0.1 have it."""
    add_metadata = McapWriter.add_metadata

    def add_wrapped(self: McapWriter, name: str, values: dict[str, str]) -> None:
        if name == "rosbag2":
            bare = yaml.safe_load(values["serialized_metadata"])
            values = {"serialized_metadata": yaml.safe_dump({WRAPPING_KEY: bare})}
        add_metadata(self, name, values)

    monkeypatch.setattr(McapWriter, "add_metadata", add_wrapped)
