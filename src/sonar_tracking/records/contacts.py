"""What flows into and out of the trackers of the active chain: plain arrays, immutable.

Stamps are integer nanoseconds. Positions are metres in the frame ``map``, azimuths radians
anticlockwise from its +x, amplitudes linear powers with noise mean 1.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from sonar_tracking.errors import Notice
from sonar_tracking.records.arrays import BoolArray, FloatArray, IntArray
from sonar_tracking.records.positions import MAP_FRAME, PositionTracks
from sonar_tracking.records.time import UNKNOWN_STAMP


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
        Direction of arrival in ``frame_id``, rad.
    amplitude : ndarray, shape (n,) or (0,)
        Linear power, noise mean 1; empty = not measured.
    range_standard_deviation, azimuth_standard_deviation : float or ndarray, shape (n,)
        m and rad; the same for all contacts, or one a contact. NaN = unknown.
    sensor_position, sensor_velocity : tuple of float
        Of the sensor at the transmit time, in ``map``, m and m/s; NaN = unknown.
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
    minimum_range : float
        Of the survey, m; NaN = unknown.
    minimum_azimuth, azimuth_width : float
        Where the surveyed sector begins, in ``frame_id``, and how wide it is, rad; NaN = all
        round.
    ping_interval : float
        To the next ping, s; NaN = unknown.
    sensor_id : str
        Name of the sensor, constant during a run.
    frame_id : str
        Frame of the azimuths: ``map``, or one that turns with the sensor.
    sensor_yaw : float
        Azimuth of +x of the sensor in ``map``, rad; NaN = unknown. Needed where the azimuths are
        not in ``map``.
    unset_pose : bool
        Whether the pose is that of a new message, so that it may be unknown: see
        :mod:`sonar_tracking.sensor_pose`.
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
    minimum_range: float = np.nan
    minimum_azimuth: float = np.nan
    azimuth_width: float = np.nan
    ping_interval: float = np.nan
    sensor_id: str = "sonar"
    frame_id: str = MAP_FRAME
    sensor_yaw: float = np.nan
    unset_pose: bool = False

    def selected(self, keep: BoolArray) -> Contacts:
        """Return the contacts chosen by a mask, of the same ping.

        Parameters
        ----------
        keep : ndarray of bool, shape (n,)
            Which contacts to keep.
        """
        columns = ("range", "azimuth", "range_standard_deviation", "azimuth_standard_deviation")
        chosen = {name: _rows(getattr(self, name), keep) for name in columns}
        amplitude = self.amplitude[keep] if len(self.amplitude) else self.amplitude
        return replace(self, amplitude=amplitude, **chosen)


def _rows(values: Any, keep: BoolArray) -> Any:
    return values[keep] if np.ndim(values) else values


@dataclass(frozen=True)
class GateThresholds:
    """Detection thresholds used in the gates of the confirmed tracks.

    Attributes
    ----------
    stamp : int
        Of the ping, ns.
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
    signal_to_noise_ratio_linear : ndarray, shape (n,)
        Linear power ratio the thresholds were computed for.
    method : str
        How they were computed: a value of the parameter ``gate_threshold``.
    next_stamp : int
        Watermark, ns.
    """

    stamp: int
    track_id: IntArray
    false_alarm_probability: FloatArray
    threshold: FloatArray
    resolution_cells: FloatArray
    gate_volume: FloatArray
    predicted_position: FloatArray
    gate_covariance: FloatArray
    search_false_alarm_probability: float
    search_threshold: float
    signal_to_noise_ratio_linear: FloatArray
    method: str
    next_stamp: int = UNKNOWN_STAMP


@dataclass(frozen=True)
class ContactTrackerUpdate:
    """What a tracker has to say after one ping.

    Attributes
    ----------
    tracks : PositionTracks
        The complete picture; a terminated track is reported once.
    target_count : float
        Expected number of targets.
    thresholds : GateThresholds
        What was used in the gates; without rows where the tracker has no gates.
    notices : tuple of Notice
        What a user should know.
    """

    tracks: PositionTracks
    target_count: float
    thresholds: GateThresholds
    notices: tuple[Notice, ...] = field(default=())
