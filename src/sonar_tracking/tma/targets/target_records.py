"""What a sensor observed of one target, what is concluded from it, and what is refused."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.errors import InputError, shown
from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.tma.estimators.sensor_frame import TmaMeasurement

MAXIMUM_LINES = 16
"""Lines followed at a time; the strongest tonals of a vessel are fewer."""


@dataclass(frozen=True)
class TargetObservation:
    """What one sensor measured of the target at one instant.

    Attributes
    ----------
    stamp : int
        ns.
    sensor_id : str
        Who measured.
    position, velocity : tuple of float
        Of the sensor in ``map``, m and m/s.
    azimuths : tuple of float
        rad: one, or left and right of a line array; empty = none now.
    azimuth_variance : float
        rad^2.
    line_ids : tuple of int
        Identifiers of the lines heard, each once.
    frequencies, frequency_deviations : tuple of float
        Of each line, Hz.
    elevation, elevation_variance, height, height_deviation, sensor_z : float
        As in :class:`TmaMeasurement`; NaN = none.
    sound_speed, propagation_speed : float
        m/s, as in :class:`TmaMeasurement`.
    """

    stamp: int
    sensor_id: str
    position: tuple[float, float]
    velocity: tuple[float, float]
    azimuths: tuple[float, ...]
    azimuth_variance: float
    line_ids: tuple[int, ...] = ()
    frequencies: tuple[float, ...] = ()
    frequency_deviations: tuple[float, ...] = ()
    elevation: float = np.nan
    elevation_variance: float = np.nan
    height: float = 0.0
    height_deviation: float = 0.0
    sensor_z: float = 0.0
    sound_speed: float = 1500.0
    propagation_speed: float = np.inf


@dataclass(frozen=True)
class TargetSolution:
    """One hypothesis of where the target is.

    Attributes
    ----------
    stamp : int
        ns.
    side : str
        ``single``, ``left`` or ``right``.
    probability : float
        Of the side.
    mean : ndarray, shape (4,)
        x, y, vx, vy, m and m/s.
    covariance : ndarray, shape (4, 4)
        Of the mean, m^2, m^2/s, m^2/s^2.
    observability : float
        0 to 1.
    observable : bool
        Whether the data say more than the prior in every direction.
    line_ids : tuple of (str, int)
        Sensor and identifier of the lines in the solution.
    source_frequency, source_frequency_deviation : ndarray, shape (n_lines,)
        Hz.
    manoeuvre : bool
        The target began to manoeuvre, says the detector, at this stamp.
    spatial : KalmanState or None
        x, y, vx, vy, z, vz, m and m/s, where the height is estimated.
    """

    stamp: int
    side: str
    probability: float
    mean: FloatArray
    covariance: FloatArray
    observability: float
    observable: bool
    line_ids: tuple[tuple[str, int], ...]
    source_frequency: FloatArray
    source_frequency_deviation: FloatArray
    manoeuvre: bool
    spatial: KalmanState | None = None

    def range_from(self, position: tuple[float, float]) -> tuple[float, float]:
        """Return the range of the target from a place and its standard deviation, m.

        Parameters
        ----------
        position : tuple of float
            x and y in ``map``, m.
        """
        offset = self.mean[:2] - position
        distance = float(np.hypot(*offset))
        sight = offset / distance
        return distance, float(np.sqrt(sight @ self.covariance[:2, :2] @ sight))


def check_observation(observation: TargetObservation) -> None:
    """Refuse an observation that contradicts itself.

    Parameters
    ----------
    observation : TargetObservation
        As it came.

    Raises
    ------
    InputError
        In a sentence that names the sensor and what is wrong.
    """
    name = f"observation of {shown(observation.sensor_id)}"
    if not np.all(np.isfinite([*observation.position, *observation.velocity])):
        raise InputError(f"{name} does not know where the sensor is; send its odometry.")
    if not np.all(np.isfinite(observation.azimuths)) or len(observation.azimuths) > 2:
        raise InputError(f"{name} must have no, one or two finite azimuths.")
    if observation.azimuths and not _positive(observation.azimuth_variance):
        raise InputError(f"{name} has an azimuth without a positive variance.")
    lengths = {len(observation.line_ids), len(observation.frequencies)}
    if lengths != {len(observation.frequency_deviations)}:
        raise InputError(f"{name} has line columns of unequal length.")
    if len(set(observation.line_ids)) != len(observation.line_ids):
        raise InputError(f"{name} has a line twice.")
    if len(observation.line_ids) > MAXIMUM_LINES:
        raise InputError(f"{name} has more than {MAXIMUM_LINES} lines; keep the strongest.")
    lines = (*observation.frequencies, *observation.frequency_deviations)
    if not all(_positive(value) for value in lines):
        raise InputError(f"{name} has a line whose frequency or deviation is not positive.")
    if np.isfinite(observation.elevation) and not _positive(observation.elevation_variance):
        raise InputError(f"{name} has an elevation without a positive variance.")
    if not _positive(observation.sound_speed):
        raise InputError(f"{name} has a sound speed that is not positive.")


def measurement_of(
    observation: TargetObservation, column_of: tuple[int, ...], count: int
) -> TmaMeasurement:
    """Return what a filter takes of an observation.

    Parameters
    ----------
    observation : TargetObservation
        That has been checked.
    column_of : tuple of int
        Column of each of its lines.
    count : int
        Columns of lines there are; those not heard are NaN.
    """
    frequency, deviation = np.full(count, np.nan), np.full(count, np.nan)
    frequency[list(column_of)] = observation.frequencies
    deviation[list(column_of)] = observation.frequency_deviations
    return TmaMeasurement(
        stamp=observation.stamp,
        position=np.array(observation.position),
        velocity=np.array(observation.velocity),
        azimuth=np.array(observation.azimuths or (np.nan,)),
        azimuth_variance=np.array(observation.azimuth_variance),
        frequency=frequency,
        frequency_deviation=deviation,
        elevation=np.array(observation.elevation),
        elevation_variance=np.array(observation.elevation_variance),
        height=observation.height,
        height_deviation=observation.height_deviation,
        sensor_z=observation.sensor_z,
        sound_speed=observation.sound_speed,
        propagation_speed=observation.propagation_speed,
    )


def _positive(value: float) -> bool:
    return bool(np.isfinite(value) and value > 0.0)
