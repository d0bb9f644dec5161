"""What is read from a bag must be what the nodes would have read."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.bags.contents.message_definitions import installed_typestore
from sonar_tracking.bags.storage.bag_records import (
    BEARING_TRACKS_TYPE,
    bearing_tracks_of,
    records_of,
    snapshots_of,
    topics_of_type,
)
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.bags.storage.writer import BagWriter
from sonar_tracking.errors import ConfigurationError, InputError
from sonar_tracking.records.bearings import TrackStatus
from tests.bags.bag_fixtures import EPOCH, SECOND, SNAPSHOTS, filled, open_writer, write_messages


def snapshots_message(n_values: int) -> bytes:
    positions = np.array([0.0, 0.5, 1.0])
    message = filled(
        SNAPSHOTS,
        sensor_id="bow",
        n_snapshots=2,
        element_x=positions,
        element_y=np.zeros(3),
        element_z=np.zeros(3),
        sample_period=0.1,
        center_frequency=300.0,
        sound_speed=1500.0,
        data=np.arange(n_values, dtype=np.float32),
    )
    message.header.stamp.sec = EPOCH
    return bytes(installed_typestore(SNAPSHOTS).serialize_cdr(message, SNAPSHOTS))


def test_snapshots_are_read_as_records(tmp_path: Path) -> None:
    writer = BagWriter(tmp_path / "run")
    writer.add_topic("/array/snapshots", SNAPSHOTS)
    writer.write("/array/snapshots", EPOCH * SECOND, snapshots_message(12))
    writer.close()
    (block,) = snapshots_of(read_bag(tmp_path / "run"), "/array/snapshots")
    assert (block.stamp, block.sensor.sensor_id) == (EPOCH * SECOND, "bow")
    assert block.data.dtype == np.complex128 and block.noise_covariance is None
    np.testing.assert_array_equal(block.data, [[1j, 2 + 3j, 4 + 5j], [6 + 7j, 8 + 9j, 10 + 11j]])
    np.testing.assert_array_equal(block.element_positions[:, 0], [0.0, 0.5, 1.0])


def test_tracks_are_read_with_nan_for_what_was_not_reported(tmp_path: Path) -> None:
    writer = open_writer(tmp_path / "run")
    write_messages(writer, 3)
    writer.close()
    bag = read_bag(tmp_path / "run")
    assert topics_of_type(bag, BEARING_TRACKS_TYPE, "output") == ["/passive/bearing_tracks"]
    assert topics_of_type(bag, BEARING_TRACKS_TYPE, "truth") == []
    tracks = list(bearing_tracks_of(bag, "/passive/bearing_tracks"))
    assert [t.stamp for t in tracks] == [EPOCH * SECOND, (EPOCH + 1) * SECOND]
    assert tracks[0].id == [7] and tracks[0].arrival_angle == [0.25]
    assert np.isnan(tracks[0].covariance).all() and tracks[0].covariance.shape == (1, 2, 2)
    assert tracks[0].status == [TrackStatus.TENTATIVE] and tracks[0].ambiguous.all()


def test_a_message_that_contradicts_itself_is_named(tmp_path: Path) -> None:
    writer = BagWriter(tmp_path / "run")
    writer.add_topic("/array/snapshots", SNAPSHOTS)
    writer.write("/array/snapshots", EPOCH * SECOND, snapshots_message(9))
    writer.close()
    with pytest.raises(
        InputError, match=r"/array/snapshots: .*data has 9 values, but .* 2 x 3 .* need 12"
    ):
        list(snapshots_of(read_bag(tmp_path / "run"), "/array/snapshots"))
    rejected: list[str] = []
    assert list(snapshots_of(read_bag(tmp_path / "run"), "/array/snapshots", rejected)) == []
    assert len(rejected) == 1


def test_records_are_of_the_kind_their_topic_carries(tmp_path: Path) -> None:
    writer = BagWriter(tmp_path / "run")
    writer.add_topic("/array/snapshots", SNAPSHOTS)
    writer.add_topic("/array/notes", "std_msgs/msg/Header")
    writer.write("/array/snapshots", EPOCH * SECOND, snapshots_message(12))
    writer.close()
    bag = read_bag(tmp_path / "run")
    (block,) = records_of(bag, "/array/snapshots")
    (same,) = snapshots_of(bag, "/array/snapshots")
    np.testing.assert_array_equal(block.data, same.data)
    with pytest.raises(ConfigurationError, match="did you mean /array/snapshots"):
        records_of(bag, "/array/snapshot")
    with pytest.raises(ConfigurationError, match=r"no record; ask for one of /array/snapshots\."):
        records_of(bag, "/array/notes")
