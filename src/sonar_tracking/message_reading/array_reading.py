"""Messages to the records of the stages: the one place where it is done.

Every message is checked here: columns of unequal length raise
:class:`sonar_tracking.errors.InputError` naming message, field and lengths. What the numbers mean
(NaN, geometry, powers) is checked by the stages.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sonar_tracking.errors import InputError
from sonar_tracking.message_reading.field_reading import (
    check_columns,
    column,
    complex_column,
    element_positions,
    sensor,
    stamp_from_time,
)
from sonar_tracking.records.arrays import ComplexArray, FloatArray
from sonar_tracking.records.bearings import (
    AngleKind,
    ArraySnapshots,
    BearingTracks,
    SubspaceEstimates,
)
from sonar_tracking.records.own_ship import OwnShipState

CONE = 0
"""Value of BearingTracks.angle_kind for arrival angles from array broadside."""

TRACK_REALS = (
    "arrival_angle",
    "arrival_angle_rate",
    "measurement",
    "measurement_variance",
    "innovation",
    "signal_to_noise_ratio",
    "existence_probability",
)
TRACK_WIDTHS = (
    dict.fromkeys(TRACK_REALS, 1)
    | {"covariance": 4, "status": 1, "ambiguous": 1}
    | {"elevation": 1, "elevation_variance": 1}
)
"""Values per track of every column of BearingTracks."""

ARRAY_REALS = ("sample_period", "center_frequency", "bandwidth", "sound_speed")


def snapshots_from_message(message: Any) -> ArraySnapshots:
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


def subspaces_from_message(message: Any) -> SubspaceEstimates:
    """Return the subspace estimates a message carries."""
    positions = element_positions(message)
    n_elements = len(positions)
    n_subspaces = int(message.n_subspaces)
    if len(message.time_offsets) != n_subspaces:
        raise InputError(
            f"SubspaceEstimates.time_offsets has {len(message.time_offsets)} values, but "
            f"n_subspaces is {n_subspaces}; the sender must give one time per subspace."
        )
    check_eigenvalues(message)
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


def bearing_tracks_from_message(message: Any) -> BearingTracks:
    """Return the bearing tracks a message carries, if they are cone angles.

    Raises
    ------
    InputError
        When they are azimuths, or columns have unequal lengths.
    """
    if message.angle_kind != CONE:
        raise InputError(
            f"BearingTracks.angle_kind is {message.angle_kind}; only cone angles (0) are "
            "understood here, so send arrival angles from array broadside."
        )
    return directions_from_message(message)


def directions_from_message(message: Any) -> BearingTracks:
    """Return the bearing tracks a message carries, cone angles or azimuths.

    Parameters
    ----------
    message : BearingTracks
        Received, or decoded from a bag.

    Returns
    -------
    BearingTracks
        A column not reported is NaN (or zero); elevations stay empty then.

    Raises
    ------
    InputError
        When the kind of angle is not known, or columns have unequal lengths.
    """
    if message.angle_kind not in tuple(AngleKind):
        raise InputError(
            f"BearingTracks.angle_kind is {message.angle_kind}; it must be 0 (cone angles from "
            "array broadside) or 1 (azimuths in the frame of the header)."
        )
    rows = check_columns(message, "id", TRACK_WIDTHS)
    reals = {name: _rows_or_nan(message, name, (rows,)) for name in TRACK_REALS}
    return BearingTracks(
        stamp=stamp_from_time(message.header.stamp),
        id=column(message, "id", "uint64"),
        status=_rows_or_zero(message, "status", rows, "uint8"),
        covariance=_rows_or_nan(message, "covariance", (rows, 2, 2)),
        ambiguous=_rows_or_zero(message, "ambiguous", rows, "bool"),
        next_stamp=stamp_from_time(message.next_stamp),
        sensor=sensor(message),
        angle_kind=AngleKind(message.angle_kind),
        elevation=column(message, "elevation"),
        elevation_variance=column(message, "elevation_variance"),
        **reals,
    )


def own_ship_from_message(message: Any) -> OwnShipState:
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


def _array_reals(message: Any) -> dict[str, float]:
    return {name: getattr(message, name) for name in ARRAY_REALS}


def _square_or_none(message: Any, name: str, size: int) -> ComplexArray | None:
    if len(getattr(message, name)) == 0:
        return None
    return complex_column(message, name, (size, size), "elements x elements")


def _rows_or_nan(message: Any, name: str, shape: tuple[int, ...]) -> FloatArray:
    values = column(message, name)
    return values.reshape(shape) if values.size else np.full(shape, np.nan)


def _rows_or_zero(message: Any, name: str, rows: int, dtype: str) -> NDArray[Any]:
    values = column(message, name, dtype)
    return values if values.size else np.zeros(rows, dtype)


def check_eigenvalues(message: Any) -> None:
    """Check that SubspaceEstimates has one eigenvalue an element, or none."""
    check_columns(message, "element_x", {"eigenvalues": 1})
