"""A bag is read by the definitions it holds: recordings of earlier versions stay readable."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sonar_tracking.bags.storage.writer as writer_module
from sonar_tracking.bags.contents.earlier_layouts import earlier_layout
from sonar_tracking.bags.contents.message_definitions import (
    MessageDefinition,
    installed_definition,
    installed_typestore,
    typestore_of,
)
from sonar_tracking.bags.storage.bag_records import position_tracks_of
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.bags.storage.writer import BagWriter
from sonar_tracking.records.positions import COLUMNS
from tests.bags.bag_fixtures import EPOCH, SECOND
from tests.bags.position_fixtures import POSITIONS

ADDED = ("z", "z_standard_deviation", "measurement", "measurement_covariance")
"""Columns of tracks that earlier versions did not have."""


def earlier_definition() -> MessageDefinition:
    """Return the definition of track lists as they were without heights and measurements."""
    now = installed_definition(POSITIONS)
    added = tuple(f"float64[] {name} " for name in ADDED)
    kept = [line for line in now.text.splitlines() if not line.startswith(added)]
    assert len(kept) == len(now.text.splitlines()) - len(ADDED)
    return MessageDefinition(POSITIONS, "\n".join(kept), "")


def earlier_message(earlier: MessageDefinition) -> bytes:
    """Return one track in the earlier layout, serialised."""
    store = typestore_of(earlier)
    types = store.types
    fields: dict[str, Any] = {
        name: np.zeros(0, column.dtype)
        for name, column in COLUMNS.items()
        if name not in (*ADDED, "state")
    }
    fields |= {"id": np.array([7], np.uint64), "status": np.ones(1, np.uint8)}
    fields |= {name: np.array([value]) for name, value in zip("xy", (3.0, 4.0), strict=True)}
    fields |= {"vx": np.zeros(1), "vy": np.zeros(1), "contributor_sensor": []}
    fields["observability"] = np.array([0.75])
    time = types["builtin_interfaces/msg/Time"]
    header = types["std_msgs/msg/Header"](time(EPOCH, 0), "map")
    message = types[POSITIONS](header=header, next_stamp=time(0, 0), **fields)
    return bytes(store.serialize_cdr(message, POSITIONS))


def test_tracks_without_heights_are_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    earlier = earlier_definition()
    data = earlier_message(earlier)
    monkeypatch.setattr(writer_module, "installed_definition", lambda _name: earlier)
    writer = BagWriter(tmp_path / "run")
    writer.add_topic("/passive/tracks", POSITIONS, role="output")
    writer.write("/passive/tracks", EPOCH * SECOND, data)
    writer.close()

    (tracks,) = position_tracks_of(read_bag(tmp_path / "run"), "/passive/tracks")
    np.testing.assert_array_equal(tracks.state, [[3.0, 4.0, 0.0, 0.0]])
    np.testing.assert_array_equal(tracks.observability, [0.75])
    assert np.isnan(tracks.z).all() and np.isnan(tracks.z_standard_deviation).all()


def test_tracks_without_heights_are_replayed() -> None:
    """In the layout that is installed, the new columns empty; what is in it stays as it is."""
    earlier = earlier_definition()
    translate = earlier_layout(earlier)
    assert translate is not None
    data = translate(earlier_message(earlier))
    message: Any = installed_typestore(POSITIONS).deserialize_cdr(data, POSITIONS)
    assert message.id.tolist() == [7] and message.x.tolist() == [3.0]
    assert message.observability.tolist() == [0.75]
    assert message.z.size == 0 and message.z_standard_deviation.size == 0
    assert earlier_layout(installed_definition(POSITIONS)) is None
