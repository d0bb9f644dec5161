"""Protects the point cloud of contacts: decoded by others, it holds what was heard."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from rclpy.serialization import serialize_message
from rosbags.typesys import Stores, get_typestore
from sensor_msgs.msg import PointCloud2

from sonar_tracking.graph.message_writing.point_cloud_writing import contact_points_to_message
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.contacts import Contacts

STAMP = 1_767_225_600 * 10**9 + 5
TYPES = get_typestore(Stores.ROS2_JAZZY)
NUMPY_TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 8: "f8"}
"""By the numbers of PointField.datatype."""

PING = Contacts(
    stamp=STAMP,
    range=np.array([1000.0, 2000.0, 3000.0]),
    azimuth=np.array([0.0, 0.5, -3.0]),
    amplitude=np.array([7.5, 20.0, 100.0]),
    range_standard_deviation=1.0,
    azimuth_standard_deviation=0.01,
)
POSITIONS = np.array([[1000.0, 0.0], [1755.0, 959.0], [-2970.0, -423.0]])


def decoded(message: PointCloud2) -> tuple[Any, np.ndarray]:
    """Return a cloud as another implementation reads it, its points by the fields it names."""
    raw = serialize_message(message)
    cloud: Any = TYPES.deserialize_cdr(raw, "sensor_msgs/msg/PointCloud2")
    order = ">" if cloud.is_bigendian else "<"
    layout = np.dtype(
        {
            "names": [field.name for field in cloud.fields],
            "formats": [order + NUMPY_TYPES[field.datatype] for field in cloud.fields],
            "offsets": [field.offset for field in cloud.fields],
            "itemsize": cloud.point_step,
        }
    )
    assert cloud.row_step == cloud.point_step * cloud.width
    assert len(cloud.data) == cloud.row_step * cloud.height
    return cloud, np.frombuffer(cloud.data.tobytes(), layout)


def test_another_reader_finds_every_contact() -> None:
    cloud, points = decoded(contact_points_to_message(PING, POSITIONS))
    assert (cloud.header.frame_id, cloud.height, cloud.width) == ("map", 1, 3)
    assert cloud.header.stamp.sec * 10**9 + cloud.header.stamp.nanosec == STAMP
    assert points.dtype.names == ("x", "y", "z", "amplitude", "range", "azimuth")
    assert {str(points.dtype[name]) for name in points.dtype.names} == {"float32"}
    assert points["x"].tolist() == POSITIONS[:, 0].tolist()
    assert points["y"].tolist() == POSITIONS[:, 1].tolist()
    assert not points["z"].any()
    assert points["amplitude"].tolist() == [7.5, 20.0, 100.0]
    assert points["range"].tolist() == [1000.0, 2000.0, 3000.0]
    assert points["azimuth"] == pytest.approx([0.0, 0.5, -3.0])
    assert cloud.is_dense


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_what_has_no_place_is_left_out(bad: float) -> None:
    positions = POSITIONS.copy()
    positions[1, 0] = bad
    cloud, points = decoded(contact_points_to_message(PING, positions))
    assert points["range"].tolist() == [1000.0, 3000.0]
    assert cloud.is_dense


def test_an_amplitude_that_was_not_measured_is_unknown() -> None:
    none: FloatArray = np.empty(0)
    cloud, points = decoded(contact_points_to_message(replace(PING, amplitude=none), POSITIONS))
    assert np.isnan(points["amplitude"]).all()
    assert points["range"].tolist() == [1000.0, 2000.0, 3000.0]
    assert not cloud.is_dense


def test_a_ping_without_contacts_is_an_empty_cloud() -> None:
    nothing = replace(PING, range=np.empty(0), azimuth=np.empty(0), amplitude=np.empty(0))
    cloud, points = decoded(contact_points_to_message(nothing, np.empty((0, 2))))
    assert (cloud.width, len(points), cloud.point_step) == (0, 0, 24)
