"""Bearing tracks of stations that measure azimuths and elevations, one track a station."""

from __future__ import annotations

import numpy as np

from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import AngleKind, BearingTracks, Sensor, TrackStatus
from sonar_tracking.records.positions import MAP_FRAME


def seen_from(station: FloatArray, place: FloatArray) -> FloatArray:
    """Return azimuth and elevation of a place, rad; both places x, y, z, m."""
    x, y, z = place - station
    return np.array([np.arctan2(y, x), np.arctan2(z, np.hypot(x, y))])


def reported(
    name: str,
    station: FloatArray,
    azimuth: float,
    elevation: float,
    deviation: float,
    stamp: int,
    azimuth_deviation: float | None = None,
) -> BearingTracks:
    """Return what a station reports of a direction, rad, of a deviation in both angles."""
    unknown = np.full(1, np.nan)
    variance = np.array([(azimuth_deviation or deviation) ** 2])
    angle = np.array([wrap_angle(azimuth)])
    x, y, z = (float(one) for one in station)
    return BearingTracks(
        stamp=stamp,
        id=np.ones(1, np.uint64),
        status=np.full(1, TrackStatus.CONFIRMED, np.uint8),
        arrival_angle=angle,
        arrival_angle_rate=np.zeros(1),
        covariance=np.diag([variance[0], 1e-4])[None],
        measurement=angle,
        measurement_variance=variance,
        innovation=unknown,
        signal_to_noise_ratio=unknown,
        existence_probability=unknown,
        ambiguous=np.zeros(1, bool),
        sensor=Sensor(name, MAP_FRAME, (x, y, z), (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0)),
        angle_kind=AngleKind.AZIMUTH,
        elevation=np.array([elevation]),
        elevation_variance=np.array([deviation**2]),
    )
