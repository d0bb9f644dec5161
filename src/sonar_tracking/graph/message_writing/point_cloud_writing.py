"""Contacts as a point cloud, for whatever reads ``sensor_msgs/PointCloud2``."""

from __future__ import annotations

import sys

import numpy as np
from sensor_msgs.msg import PointCloud2, PointField

from sonar_tracking.graph.message_writing.field_writing import packed
from sonar_tracking.graph.message_writing.marker_writing import picture_header
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.contacts import Contacts
from sonar_tracking.records.positions import MAP_FRAME

FIELDS = ("x", "y", "z", "amplitude", "range", "azimuth")
"""Of each point, all float32: m in ``map``, linear power, m from the sensor, rad in ``map``."""

WIDTH = np.dtype(np.float32).itemsize


def contact_points_to_message(contacts: Contacts, positions: FloatArray) -> PointCloud2:
    """Return the contacts of a ping as a point cloud.

    Parameters
    ----------
    contacts : Contacts
        Of one ping, with azimuths in ``map``. An amplitude that was not measured is NaN.
    positions : ndarray, shape (n, 2)
        In ``map``, m; what is not finite is left out.

    Returns
    -------
    PointCloud2
        In the frame ``map``, one row, z = 0.
    """
    amplitude = contacts.amplitude if len(contacts.amplitude) else np.nan
    columns = (*positions.T, 0.0, amplitude, contacts.range, contacts.azimuth)
    points = np.empty((len(positions), len(FIELDS)), np.float32)
    for index, column in enumerate(columns):
        points[:, index] = column
    points = points[np.isfinite(positions).all(axis=1)]
    return PointCloud2(
        header=picture_header(contacts.stamp, MAP_FRAME),
        height=1,
        width=len(points),
        fields=[
            PointField(name=name, offset=WIDTH * index, datatype=PointField.FLOAT32, count=1)
            for index, name in enumerate(FIELDS)
        ],
        is_bigendian=sys.byteorder == "big",
        point_step=WIDTH * len(FIELDS),
        row_step=WIDTH * points.size,
        data=packed(points.view(np.uint8), "uint8"),
        is_dense=bool(np.isfinite(points).all()),
    )
