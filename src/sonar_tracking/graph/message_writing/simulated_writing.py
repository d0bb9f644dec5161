"""What nodes publish with every block of data, as bytes.

The same messages as of :mod:`sonar_tracking.graph.message_writing.array_writing` and
:mod:`sonar_tracking.graph.message_writing.position_writing`, and checked as these are.
"""

from __future__ import annotations

import math

import numpy as np

from sonar_tracking.errors import InputError
from sonar_tracking.graph.message_writing.cdr_writing import CdrWriter
from sonar_tracking.message_reading.array_reading import ARRAY_REALS, TRACK_WIDTHS
from sonar_tracking.records.bearings import ArraySnapshots, BearingTracks, TrackStatus
from sonar_tracking.records.own_ship import BASE_FRAME, OwnShipState
from sonar_tracking.records.positions import MAP_FRAME, TrackSource, TruthTracks

_NO_COVARIANCE = (0.0,) * 36
_BEARING_COLUMNS = (
    "arrival_angle",
    "arrival_angle_rate",
    "covariance",
    "measurement",
    "measurement_variance",
    "innovation",
    "signal_to_noise_ratio",
    "existence_probability",
)
"""Of BearingTracks between status and ambiguous, in the order of the message."""
_TRACKS_REST = 19
"""Columns of Tracks that truth has nothing to say in."""


def snapshots_to_bytes(record: ArraySnapshots) -> bytes:
    """Return a block of snapshots as a serialised ``ArraySnapshots`` (data rounded to float32)."""
    if record.data.ndim != 2 or record.data.shape[1] != len(record.element_positions):
        raise InputError(
            f"ArraySnapshots.data has shape {record.data.shape}, but there are "
            f"{len(record.element_positions)} elements; give (n_snapshots, n_elements)."
        )
    cdr = CdrWriter()
    cdr.time(record.stamp)
    cdr.text(record.sensor.frame_id)
    cdr.time(record.next_stamp)
    cdr.sensor(record.sensor)
    cdr.reals(*(getattr(record, name) for name in ARRAY_REALS))
    for axis in record.element_positions.T:
        cdr.column(axis)
    cdr.count(record.data.shape[0])
    cdr.complex_column(record.data, "float32")
    if record.noise_covariance is None:
        cdr.no_column()
    else:
        cdr.complex_column(record.noise_covariance)
    return cdr.message()


def bearing_tracks_to_bytes(record: BearingTracks) -> bytes:
    """Return bearing tracks as a serialised ``BearingTracks``."""
    rows = len(record.id)
    for name, width in TRACK_WIDTHS.items():
        size = np.size(getattr(record, name))
        if size not in (0, width * rows):
            raise InputError(
                f"BearingTracks.{name} has {size} values, but id has {rows} and {name} needs "
                f"{width * rows} or none; the sender must make them agree."
            )
    cdr = CdrWriter()
    cdr.time(record.stamp)
    cdr.text(record.sensor.frame_id)
    cdr.time(record.next_stamp)
    cdr.sensor(record.sensor)
    cdr.byte(int(record.angle_kind))
    cdr.column(record.id, "uint64")
    cdr.column(record.status, "uint8")
    for name in _BEARING_COLUMNS:
        cdr.column(getattr(record, name))
    cdr.column(record.ambiguous, "bool")
    cdr.column(record.elevation)
    cdr.column(record.elevation_variance)
    return cdr.message()


def truth_tracks_to_bytes(record: TruthTracks) -> bytes:
    """Return true positions as a serialised ``Tracks`` of source TRUTH."""
    rows = len(record.id)
    cdr = CdrWriter()
    cdr.time(record.stamp)
    cdr.text(MAP_FRAME)
    cdr.time(record.next_stamp)
    cdr.column(record.id, "uint64")
    cdr.octets(bytes([TrackStatus.CONFIRMED]) * rows)
    cdr.octets(bytes([TrackSource.TRUTH]) * rows)
    cdr.column((1.0,) * rows)
    for axis in (*record.position.T, *record.velocity.T):
        cdr.column(axis)
    for _ in range(_TRACKS_REST):
        cdr.no_column()
    return cdr.message()


def own_ship_to_bytes(record: OwnShipState) -> bytes:
    """Return own ship's state as a serialised ``Odometry``: pose in ``map``, twist in its own."""
    half = 0.5 * record.yaw
    cdr = CdrWriter()
    cdr.time(record.stamp)
    cdr.text(MAP_FRAME)
    cdr.text(BASE_FRAME)
    cdr.reals(*record.position, 0.0, 0.0, 0.0, math.sin(half), math.cos(half), *_NO_COVARIANCE)
    cdr.reals(*record.velocity, 0.0, 0.0, 0.0, record.yaw_rate, *_NO_COVARIANCE)
    return cdr.message()
