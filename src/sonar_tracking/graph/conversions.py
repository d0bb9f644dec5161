"""Messages to and from the records of the stages: the one place where it is done.

Every message is checked here, on publish and on receive: columns of unequal length raise
:class:`sonar_tracking.errors.InputError` naming message, field and lengths. What the numbers mean
(NaN, geometry, powers) is checked by the stages.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from nav_msgs.msg import Odometry
from numpy.typing import NDArray
from sonar_tracking_msgs.msg import ArraySnapshots as ArraySnapshotsMessage
from sonar_tracking_msgs.msg import BearingTracks as BearingTracksMessage
from sonar_tracking_msgs.msg import SubspaceEstimates as SubspaceEstimatesMessage
from sonar_tracking_msgs.msg import Tracks as TracksMessage

from sonar_tracking.errors import InputError
from sonar_tracking.graph.message_fields import (
    check_columns,
    column,
    complex_column,
    element_positions,
    packed,
    packed_complex,
    sensor,
    set_element_positions,
    set_quaternion,
    set_sensor,
    set_stamps,
    set_vector,
    stamp_from_time,
    time_from_stamp,
)
from sonar_tracking.passive.records import (
    ArraySnapshots,
    BearingTracks,
    SubspaceEstimates,
    TrackStatus,
)
from sonar_tracking.simulation.records import OwnShipState, TruthTracks

MAP_FRAME = "map"
BASE_FRAME = "own_ship/base_link"

_TRACK_REALS = (
    "arrival_angle",
    "arrival_angle_rate",
    "measurement",
    "measurement_variance",
    "innovation",
    "signal_to_noise_ratio",
    "existence_probability",
)
_TRACK_WIDTHS = (
    dict.fromkeys(_TRACK_REALS, 1)
    | {"covariance": 4, "status": 1, "ambiguous": 1}
    | {"elevation": 1, "elevation_variance": 1}
)
_ARRAY_REALS = ("sample_period", "center_frequency", "bandwidth", "sound_speed")


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


def snapshots_from_message(message: ArraySnapshotsMessage) -> ArraySnapshots:
    """Return the block of snapshots a message carries."""
    positions = element_positions(message)
    n_elements = len(positions)
    return ArraySnapshots(
        stamp=stamp_from_time(message.header.stamp),
        data=complex_column(
            message,
            "data",
            (int(message.n_snapshots), n_elements),
            "n_snapshots x elements",
            "float32",
        ),
        element_positions=positions,
        noise_covariance=_square_or_none(message, "noise_covariance", n_elements),
        next_stamp=stamp_from_time(message.next_stamp),
        sensor=sensor(message),
        **_array_reals(message),
    )


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
    _check_eigenvalues(message)
    return message


def subspaces_from_message(message: SubspaceEstimatesMessage) -> SubspaceEstimates:
    """Return the subspace estimates a message carries."""
    positions = element_positions(message)
    n_elements = len(positions)
    n_subspaces = int(message.n_subspaces)
    if len(message.time_offsets) != n_subspaces:
        raise InputError(
            f"SubspaceEstimates.time_offsets has {len(message.time_offsets)} values, but "
            f"n_subspaces is {n_subspaces}; the sender must give one time per subspace."
        )
    _check_eigenvalues(message)
    return SubspaceEstimates(
        stamp=stamp_from_time(message.header.stamp),
        method=message.method,
        basis=complex_column(
            message,
            "basis",
            (n_subspaces, n_elements, int(message.n_columns)),
            "n_subspaces x elements x n_columns",
        ),
        time_offsets=column(message, "time_offsets"),
        element_positions=positions,
        effective_snapshots=message.effective_snapshots,
        rank=message.rank,
        source_count=message.source_count,
        covariance=_square_or_none(message, "covariance", n_elements),
        covariance_snapshots=message.covariance_snapshots,
        covariance_time_offset=message.covariance_time_offset,
        eigenvalues=column(message, "eigenvalues"),
        noise_power=np.array(message.noise_power),
        noise_covariance=_square_or_none(message, "noise_covariance", n_elements),
        next_stamp=stamp_from_time(message.next_stamp),
        sensor=sensor(message),
        **_array_reals(message),
    )


def bearing_tracks_to_message(record: BearingTracks) -> BearingTracksMessage:
    """Return bearing tracks (cone angles) as a message."""
    message = BearingTracksMessage(angle_kind=BearingTracksMessage.CONE)
    set_stamps(message, record.stamp, record.next_stamp)
    set_sensor(message, record.sensor)
    message.id = packed(record.id, "uint64")
    message.status = packed(record.status, "uint8")
    message.covariance = packed(record.covariance)
    message.ambiguous = [bool(value) for value in record.ambiguous]
    for name in _TRACK_REALS:
        setattr(message, name, packed(getattr(record, name)))
    check_columns(message, "id", _TRACK_WIDTHS)
    return message


def bearing_tracks_from_message(message: BearingTracksMessage) -> BearingTracks:
    """Return the bearing tracks a message carries; a column not reported is NaN (or zero)."""
    if message.angle_kind != BearingTracksMessage.CONE:
        raise InputError(
            f"BearingTracks.angle_kind is {message.angle_kind}; only cone angles (0) are "
            "understood here, so send arrival angles from array broadside."
        )
    rows = check_columns(message, "id", _TRACK_WIDTHS)
    reals = {name: _rows_or_nan(message, name, (rows,)) for name in _TRACK_REALS}
    return BearingTracks(
        stamp=stamp_from_time(message.header.stamp),
        id=column(message, "id", "uint64"),
        status=_rows_or_zero(message, "status", rows, "uint8"),
        covariance=_rows_or_nan(message, "covariance", (rows, 2, 2)),
        ambiguous=_rows_or_zero(message, "ambiguous", rows, "bool"),
        next_stamp=stamp_from_time(message.next_stamp),
        sensor=sensor(message),
        **reals,
    )


def truth_tracks_to_message(record: TruthTracks) -> TracksMessage:
    """Return true positions as a track list of source TRUTH."""
    rows = len(record.id)
    message = TracksMessage()
    set_stamps(message, record.stamp, record.next_stamp)
    message.header.frame_id = MAP_FRAME
    message.id = packed(record.id, "uint64")
    message.status = packed(np.full(rows, TrackStatus.CONFIRMED), "uint8")
    message.source = packed(np.full(rows, TracksMessage.TRUTH), "uint8")
    message.existence_probability = packed(np.ones(rows))
    message.x, message.y = packed(record.position[:, 0]), packed(record.position[:, 1])
    message.vx, message.vy = packed(record.velocity[:, 0]), packed(record.velocity[:, 1])
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


def own_ship_from_message(message: Odometry) -> OwnShipState:
    """Return the horizontal motion odometry carries."""
    position, turn = message.pose.pose.position, message.pose.pose.orientation
    linear, angular = message.twist.twist.linear, message.twist.twist.angular
    numbers = (position.x, position.y, turn.x, turn.y, turn.z, turn.w, linear.x, linear.y)
    if not all(map(math.isfinite, numbers)) or not any((turn.x, turn.y, turn.z, turn.w)):
        raise InputError(
            "Odometry has a position, orientation or velocity that is not a finite number, or an "
            "orientation of length zero; the sender must give own ship's pose in map and its "
            "twist in own_ship/base_link."
        )
    yaw = math.atan2(
        2.0 * (turn.w * turn.z + turn.x * turn.y),
        turn.w**2 + turn.x**2 - turn.y**2 - turn.z**2,
    )
    return OwnShipState(
        stamp=stamp_from_time(message.header.stamp),
        position=(position.x, position.y),
        yaw=yaw,
        velocity=(linear.x, linear.y),
        yaw_rate=angular.z,
    )


def _set_array(message: Any, record: ArraySnapshots | SubspaceEstimates) -> None:
    set_element_positions(message, record.element_positions)
    for name in _ARRAY_REALS:
        setattr(message, name, float(getattr(record, name)))
    if record.noise_covariance is not None:
        message.noise_covariance = packed_complex(record.noise_covariance)


def _array_reals(message: Any) -> dict[str, float]:
    return {name: getattr(message, name) for name in _ARRAY_REALS}


def _square_or_none(message: Any, name: str, size: int) -> NDArray[np.complex128] | None:
    if len(getattr(message, name)) == 0:
        return None
    return complex_column(message, name, (size, size), "elements x elements")


def _check_eigenvalues(message: SubspaceEstimatesMessage) -> None:
    check_columns(message, "element_x", {"eigenvalues": 1})


def _rows_or_nan(message: Any, name: str, shape: tuple[int, ...]) -> NDArray[np.float64]:
    values = column(message, name)
    return values.reshape(shape) if values.size else np.full(shape, np.nan)


def _rows_or_zero(message: Any, name: str, rows: int, dtype: str) -> NDArray[Any]:
    values = column(message, name, dtype)
    return values if values.size else np.zeros(rows, dtype)


NO_BEARING_TRACKS = bearing_tracks_from_message(BearingTracksMessage())
"""The empty picture."""
