"""Messages to the records of the stages: the one place where it is done.

Every message is checked here: columns of unequal length raise
:class:`sonar_tracking.errors.InputError` naming message, field and lengths. What the numbers mean
(NaN, geometry, powers) is checked by the stages.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from sonar_tracking.errors import InputError
from sonar_tracking.message_reading.field_limits import check_duration, check_size
from sonar_tracking.message_reading.field_reading import (
    check_columns,
    check_largest,
    check_vector,
    column,
    complex_column,
    count,
    element_positions,
    known,
    real,
    rows_or_nan,
    sensor,
    stamp_from_time,
    unfilled,
)
from sonar_tracking.records.arrays import ComplexArray
from sonar_tracking.records.bearings import (
    AngleKind,
    ArraySnapshots,
    BearingTracks,
    SubspaceEstimates,
    TrackStatus,
)
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.sensor_pose import yaw_of

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

LONGEST_OFFSET = 3600.0
"""Of a covariance from its stamp, s."""

ARRAY_REALS = ("sample_period", "center_frequency", "bandwidth", "sound_speed")


def snapshots_from_message(message: Any) -> ArraySnapshots:
    """Return the block of snapshots a message carries."""
    positions = element_positions(message)
    n_elements = len(positions)
    check_duration("ArraySnapshots", message.n_snapshots * message.sample_period)
    return ArraySnapshots(
        stamp=stamp_from_time(message.header.stamp),
        data=complex_column(
            message,
            "data",
            (count(message, "n_snapshots"), n_elements),
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
    check_size("SubspaceEstimates", "n_subspaces", n_subspaces)
    if len(message.time_offsets) != n_subspaces:
        raise InputError(
            f"SubspaceEstimates.time_offsets has {len(message.time_offsets)} values, but "
            f"n_subspaces is {n_subspaces}; the sender must give one time per subspace."
        )
    check_eigenvalues(message)
    for name in ("eigenvalues", "time_offsets"):
        check_largest(message, name, column(message, name))
    covariance = _square_or_none(message, "covariance", n_elements)
    if covariance is not None and not abs(message.covariance_time_offset) <= LONGEST_OFFSET:
        raise InputError(
            f"SubspaceEstimates.covariance_time_offset is {message.covariance_time_offset:g} s; "
            f"it must be at most {LONGEST_OFFSET:g} s, from the stamp to the middle of the "
            "snapshots."
        )
    counted = len(message.eigenvalues) > 0
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
        effective_snapshots=real(message, "effective_snapshots"),
        rank=message.rank if message.rank or counted else -1,
        source_count=message.source_count if message.source_count or counted else -1,
        covariance=covariance,
        covariance_snapshots=(
            message.covariance_snapshots
            if covariance is None
            else count(message, "covariance_snapshots")
        ),
        covariance_time_offset=(np.nan if covariance is None else message.covariance_time_offset),
        eigenvalues=column(message, "eigenvalues"),
        eigenvectors=None,
        noise_power=np.array(real(message, "noise_power")),
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
        A column not reported is NaN, the status confirmed, a cone ambiguous; elevations stay empty.

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
    reals = {name: rows_or_nan(message, name, (rows,)) for name in TRACK_REALS}
    kind = AngleKind(message.angle_kind)
    status, ambiguous = column(message, "status", "uint8"), column(message, "ambiguous", "bool")
    return BearingTracks(
        stamp=stamp_from_time(message.header.stamp),
        id=column(message, "id", "uint64"),
        status=status if status.size else np.full(rows, TrackStatus.CONFIRMED, np.uint8),
        covariance=rows_or_nan(message, "covariance", (rows, 2, 2)),
        ambiguous=ambiguous if ambiguous.size else np.full(rows, kind is AngleKind.CONE),
        next_stamp=stamp_from_time(message.next_stamp),
        sensor=sensor(message),
        angle_kind=kind,
        elevation=column(message, "elevation"),
        elevation_variance=known(message, "elevation_variance"),
        **reals,
    )


def measured_directions_from_message(message: Any) -> BearingTracks:
    """Return bearing tracks with their measurements, for who needs those.

    Raises
    ------
    InputError
        As :func:`directions_from_message`, and when the message reports no measurements.
    """
    if len(message.id) and not len(message.measurement):
        raise unfilled(message, "measurement", "is empty")
    return directions_from_message(message)


def own_ship_from_message(message: Any) -> OwnShipState:
    """Return the horizontal motion odometry carries."""
    position, turn = message.pose.pose.position, message.pose.pose.orientation
    linear, angular = message.twist.twist.linear, message.twist.twist.angular
    check_vector(message, "pose.pose.position", position)
    check_vector(message, "twist.twist.linear", linear)
    check_vector(message, "twist.twist.angular", angular)
    yaw_rate = 0.0 if math.isnan(angular.z) else angular.z
    orientation = (turn.x, turn.y, turn.z, turn.w)
    numbers = (position.x, position.y, *orientation, linear.x, linear.y, yaw_rate)
    if not all(map(math.isfinite, numbers)) or not any(orientation):
        raise InputError(
            "Odometry has a position, orientation or velocity that is not a finite number, or an "
            "orientation of length zero; the sender must give own ship's pose in map and its "
            "twist in own_ship/base_link."
        )
    return OwnShipState(
        stamp=stamp_from_time(message.header.stamp),
        position=(position.x, position.y),
        yaw=yaw_of(orientation),
        velocity=(linear.x, linear.y),
        yaw_rate=yaw_rate,
    )


def _array_reals(message: Any) -> dict[str, float]:
    return {name: real(message, name) for name in ARRAY_REALS}


def _square_or_none(message: Any, name: str, size: int) -> ComplexArray | None:
    if len(getattr(message, name)) == 0:
        return None
    return complex_column(message, name, (size, size), "elements x elements")


def check_eigenvalues(message: Any) -> None:
    """Check that SubspaceEstimates has one eigenvalue an element, or none."""
    check_columns(message, "element_x", {"eigenvalues": 1})
