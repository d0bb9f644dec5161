"""What flows into and out of the trackers of the active chain: plain arrays, immutable.

Stamps are integer nanoseconds. Positions are metres in the frame ``map``, azimuths radians
anticlockwise from its +x, amplitudes linear powers with noise mean 1.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sonar_tracking.errors import Notice
from sonar_tracking.passive.records import UNKNOWN_STAMP

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True)
class Contacts:
    """Contacts of one ping.

    Attributes
    ----------
    stamp : int
        Transmit time, ns.
    range : ndarray, shape (n,)
        Half the two-way travel time times the sound speed, m.
    azimuth : ndarray, shape (n,)
        Direction of arrival in ``map``, rad.
    amplitude : ndarray, shape (n,) or (0,)
        Linear power, noise mean 1; empty = not measured.
    range_standard_deviation, azimuth_standard_deviation : float or ndarray, shape (n,)
        m and rad; the same for all contacts, or one a contact.
    sensor_position, sensor_velocity : tuple of float
        Of the sensor at the transmit time, in ``map``, m and m/s.
    detection_probability : float
        P_D at the threshold in force; NaN = take the parameter.
    false_alarm_probability : float
        P_F per resolution cell; NaN = unknown.
    detection_threshold : float
        Linear power; NaN = unknown.
    signal_to_noise_ratio_linear : float
        Expected of a target; NaN = unknown.
    clutter_density : float
        False contacts per m^2; NaN = unknown.
    range_resolution, azimuth_resolution : float
        Size of a resolution cell, m and rad; NaN = unknown.
    maximum_range : float
        Of the survey, m; NaN = unknown.
    next_stamp : int
        Watermark, ns.
    """

    stamp: int
    range: FloatArray
    azimuth: FloatArray
    amplitude: FloatArray
    range_standard_deviation: float | FloatArray
    azimuth_standard_deviation: float | FloatArray
    sensor_position: tuple[float, float] = (0.0, 0.0)
    sensor_velocity: tuple[float, float] = (0.0, 0.0)
    detection_probability: float = np.nan
    false_alarm_probability: float = np.nan
    detection_threshold: float = np.nan
    signal_to_noise_ratio_linear: float = np.nan
    clutter_density: float = np.nan
    range_resolution: float = np.nan
    azimuth_resolution: float = np.nan
    maximum_range: float = np.nan
    next_stamp: int = UNKNOWN_STAMP


@dataclass(frozen=True)
class PositionTracks:
    """Tracks at the stamp of a ping.

    Attributes
    ----------
    stamp : int
        Instant the states refer to, ns.
    id : ndarray of int, shape (n,)
        Never reused within a run.
    status : ndarray of int, shape (n,)
        Values of :class:`~sonar_tracking.passive.records.TrackStatus`.
    existence_probability : ndarray, shape (n,)
        0..1; NaN = not estimated.
    state : ndarray, shape (n, 4)
        x, y, vx, vy in ``map``.
    covariance : ndarray, shape (n, 4, 4)
        Of the state.
    initiated, updated : ndarray of int, shape (n,)
        Stamps of the first and the last contact, ns.
    next_stamp : int
        Watermark, ns.
    """

    stamp: int
    id: IntArray
    status: IntArray
    existence_probability: FloatArray
    state: FloatArray
    covariance: FloatArray
    initiated: IntArray
    updated: IntArray
    next_stamp: int = UNKNOWN_STAMP


@dataclass(frozen=True)
class GateThresholds:
    """Detection thresholds used in the gates of the confirmed tracks.

    Attributes
    ----------
    track_id : ndarray of int, shape (n,)
        Track the gate belongs to.
    false_alarm_probability, threshold : ndarray, shape (n,)
        Per resolution cell; linear power.
    resolution_cells, gate_volume : ndarray, shape (n,)
        Cells in the gate; m^2.
    predicted_position : ndarray, shape (n, 2)
        Centre of the gate, m.
    gate_covariance : ndarray, shape (n, 2, 2)
        Of the innovation, m^2.
    search_false_alarm_probability, search_threshold : float
        Outside the gates; NaN = unknown.
    """

    track_id: IntArray
    false_alarm_probability: FloatArray
    threshold: FloatArray
    resolution_cells: FloatArray
    gate_volume: FloatArray
    predicted_position: FloatArray
    gate_covariance: FloatArray
    search_false_alarm_probability: float
    search_threshold: float


@dataclass(frozen=True)
class ContactTrackerUpdate:
    """What a tracker has to say after one ping.

    Attributes
    ----------
    tracks : PositionTracks
        The complete picture; a terminated track is told once.
    target_count : float
        Expected number of targets.
    thresholds : GateThresholds or None
        What was used in the gates; None where the tracker sets none.
    notices : tuple of Notice
        What a user should know.
    """

    tracks: PositionTracks
    target_count: float
    thresholds: GateThresholds | None = None
    notices: tuple[Notice, ...] = field(default=())
