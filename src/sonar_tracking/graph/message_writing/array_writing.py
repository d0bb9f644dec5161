"""Records of the stages to messages.

The other way is :mod:`sonar_tracking.message_reading.array_reading`.

Position tracks have a module of their own,
:mod:`sonar_tracking.graph.message_writing.position_writing`.

Every message is checked before it is published: columns of unequal length raise
:class:`sonar_tracking.errors.InputError` naming message, field and lengths.
"""

from __future__ import annotations

import math
from typing import Any

from nav_msgs.msg import Odometry
from sonar_tracking_msgs.msg import ArraySnapshots as ArraySnapshotsMessage
from sonar_tracking_msgs.msg import BearingTracks as BearingTracksMessage
from sonar_tracking_msgs.msg import SubspaceEstimates as SubspaceEstimatesMessage

from sonar_tracking.errors import InputError
from sonar_tracking.graph.message_writing.field_writing import (
    packed,
    packed_complex,
    set_element_positions,
    set_quaternion,
    set_sensor,
    set_stamps,
    set_vector,
    time_from_stamp,
)
from sonar_tracking.message_reading.array_reading import (
    ARRAY_REALS,
    TRACK_REALS,
    TRACK_WIDTHS,
    bearing_tracks_from_message,
    check_eigenvalues,
)
from sonar_tracking.message_reading.field_reading import check_columns
from sonar_tracking.records.bearings import ArraySnapshots, BearingTracks, SubspaceEstimates
from sonar_tracking.records.own_ship import BASE_FRAME, OwnShipState
from sonar_tracking.records.positions import MAP_FRAME


def snapshots_to_message(record: ArraySnapshots) -> ArraySnapshotsMessage:
    """Return a block of snapshots as a message (data rounded to float32)."""
    message = ArraySnapshotsMessage()
    set_stamps(message, record.stamp, record.next_stamp)
    set_sensor(message, record.sensor)
    _set_array(message, record)
    if record.data.ndim != 2 or record.data.shape[1] != len(record.element_positions):
        raise InputError(
            f"ArraySnapshots.data has shape {record.data.shape}, but there are "
            f"{len(record.element_positions)} elements; give (n_snapshots, n_elements)."
        )
    message.n_snapshots = record.data.shape[0]
    message.data = packed_complex(record.data, "float32")
    return message


def subspaces_to_message(record: SubspaceEstimates) -> SubspaceEstimatesMessage:
    """Return subspace estimates as a message."""
    message = SubspaceEstimatesMessage()
    set_stamps(message, record.stamp, record.next_stamp)
    set_sensor(message, record.sensor)
    _set_array(message, record)
    expected = (len(record.time_offsets), len(record.element_positions))
    if record.basis.ndim != 3 or record.basis.shape[:2] != expected:
        raise InputError(
            f"SubspaceEstimates.basis has shape {record.basis.shape}, but there are "
            f"{expected[0]} time offsets and {expected[1]} elements; "
            "give (n_subspaces, n_elements, n_columns)."
        )
    message.method = record.method
    message.effective_snapshots = float(record.effective_snapshots)
    message.rank = int(record.rank)
    message.source_count = int(record.source_count)
    message.n_subspaces = record.basis.shape[0]
    message.n_columns = record.basis.shape[2]
    message.time_offsets = packed(record.time_offsets)
    message.basis = packed_complex(record.basis)
    message.eigenvalues = packed(record.eigenvalues)
    message.noise_power = float(record.noise_power)
    if record.covariance is not None:
        message.covariance = packed_complex(record.covariance)
    message.covariance_snapshots = int(record.covariance_snapshots)
    message.covariance_time_offset = float(record.covariance_time_offset)
    check_eigenvalues(message)
    return message


def bearing_tracks_to_message(record: BearingTracks) -> BearingTracksMessage:
    """Return bearing tracks as a message."""
    message = BearingTracksMessage(angle_kind=int(record.angle_kind))
    set_stamps(message, record.stamp, record.next_stamp)
    set_sensor(message, record.sensor)
    message.id = packed(record.id, "uint64")
    message.status = packed(record.status, "uint8")
    message.covariance = packed(record.covariance)
    message.ambiguous = [bool(value) for value in record.ambiguous]
    message.elevation = packed(record.elevation)
    message.elevation_variance = packed(record.elevation_variance)
    for name in TRACK_REALS:
        setattr(message, name, packed(getattr(record, name)))
    check_columns(message, "id", TRACK_WIDTHS)
    return message


def own_ship_to_message(record: OwnShipState) -> Odometry:
    """Return own ship's state as odometry: pose in ``map``, twist in ``own_ship/base_link``."""
    message = Odometry(child_frame_id=BASE_FRAME)
    message.header.stamp = time_from_stamp(record.stamp)
    message.header.frame_id = MAP_FRAME
    half = 0.5 * record.yaw
    set_vector(message.pose.pose.position, (*record.position, 0.0))
    set_quaternion(message.pose.pose.orientation, (0.0, 0.0, math.sin(half), math.cos(half)))
    set_vector(message.twist.twist.linear, (*record.velocity, 0.0))
    set_vector(message.twist.twist.angular, (0.0, 0.0, record.yaw_rate))
    return message


def _set_array(message: Any, record: ArraySnapshots | SubspaceEstimates) -> None:
    set_element_positions(message, record.element_positions)
    for name in ARRAY_REALS:
        setattr(message, name, float(getattr(record, name)))
    if record.noise_covariance is not None:
        message.noise_covariance = packed_complex(record.noise_covariance)


NO_BEARING_TRACKS = bearing_tracks_from_message(BearingTracksMessage())
"""The empty picture."""
