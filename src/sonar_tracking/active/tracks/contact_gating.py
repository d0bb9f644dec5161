"""Gates of tracks, and the sparse list of pairs of a track and a contact in its gate.

A contact reflected a delay delta after the stamp is a measurement of position + delta velocity at
the stamp, so that all contacts of a ping update the state at its transmit time.

References
----------
Kim, Song (2007), equations 13-14: the gate is the local one, never the field of view.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.active.contacts.contact_positions import position_covariance
from sonar_tracking.active.detection.detection_threshold import GATE_SIZE
from sonar_tracking.active.tracks.scene_rows import SceneRows
from sonar_tracking.active.tracks.track_bank import TrackBank
from sonar_tracking.records.arrays import BoolArray, FloatArray, IndexArray
from sonar_tracking.records.contacts import Contacts

SMALLEST_DEVIATION = 1e-6
SMALLEST_SHARE = 1e-13
"""Of a determinant in the product of the diagonal."""


@dataclass(frozen=True)
class SensorGeometry:
    """What a gate needs to know of the sensor.

    Attributes
    ----------
    position : ndarray, shape (2,)
        In ``map``, m.
    range_standard_deviation, azimuth_standard_deviation : float
        The largest of the contacts, m and rad.
    sound_speed : float
        m/s; 0 = the ping takes no time.
    """

    position: FloatArray
    range_standard_deviation: float
    azimuth_standard_deviation: float
    sound_speed: float


@dataclass(frozen=True)
class SensorsOfTracks:
    """The same for the tracks of several scenes.

    Attributes
    ----------
    position : ndarray, shape (n, 2)
        In ``map``, m.
    range_standard_deviation, azimuth_standard_deviation : ndarray, shape (n,)
        m and rad.
    sound_speed : float
        m/s; the same for all.
    """

    position: FloatArray
    range_standard_deviation: FloatArray
    azimuth_standard_deviation: FloatArray
    sound_speed: float


def sensors_of_tracks(
    sensors: Sequence[SensorGeometry], tracks: SceneRows
) -> SensorGeometry | SensorsOfTracks:
    """Return the sensor of each track, of one sensor a scene, all in the same water."""
    if tracks.single:
        return sensors[0]
    return SensorsOfTracks(
        tracks.spread([sensor.position for sensor in sensors]),
        tracks.spread([sensor.range_standard_deviation for sensor in sensors]),
        tracks.spread([sensor.azimuth_standard_deviation for sensor in sensors]),
        sensors[0].sound_speed,
    )


def sensor_geometry(contacts: Contacts, sound_speed: float) -> SensorGeometry:
    """Return the geometry of a ping; gates are made for the least precise contact."""
    return SensorGeometry(
        np.array(contacts.sensor_position),
        _largest(contacts.range_standard_deviation),
        _largest(contacts.azimuth_standard_deviation),
        sound_speed,
    )


def _largest(deviation: float | FloatArray) -> float:
    if isinstance(deviation, float):
        return deviation
    # Without contacts there are no deviations, and the gates are not used.
    return float(np.max(deviation)) if np.size(deviation) else SMALLEST_DEVIATION


@dataclass(frozen=True)
class TrackGates:
    """Gates of all tracks.

    Attributes
    ----------
    centre : ndarray, shape (n, 2)
        Predicted position at the reflection time, m.
    covariance : ndarray, shape (n, 2, 2)
        Of the innovation, m^2.
    volume : ndarray, shape (n,)
        pi g^2 sqrt(det S), m^2.
    distance : ndarray, shape (n,)
        From the sensor, m.
    """

    centre: FloatArray
    covariance: FloatArray
    volume: FloatArray
    distance: FloatArray

    def select(self, rows: IndexArray | slice) -> TrackGates:
        """Return some of the gates, by their rows, shape (n_kept,)."""
        return TrackGates(
            self.centre[rows], self.covariance[rows], self.volume[rows], self.distance[rows]
        )


@dataclass(frozen=True)
class GatePairs:
    """Contacts in gates, in the order of the tracks.

    Attributes
    ----------
    track, contact : ndarray of int, shape (n_pairs,)
        Rows of both.
    """

    track: IndexArray
    contact: IndexArray

    def keep(self, rows: BoolArray | IndexArray | slice) -> GatePairs:
        """Return some of the pairs, by a mask, shape (n_pairs,), or by rows, shape (n_kept,)."""
        return GatePairs(self.track[rows], self.contact[rows])

    def first_of_each_track(self) -> IndexArray:
        """Return the rows of the pairs at which another track begins, shape (n_tracks,)."""
        begins = np.ones(len(self.track), dtype=bool)
        np.not_equal(self.track[1:], self.track[:-1], out=begins[1:])
        return np.flatnonzero(begins)


def pairs_of_scenes(
    found: Sequence[GatePairs], tracks: SceneRows, contacts: SceneRows
) -> GatePairs:
    """Return the pairs of all scenes, their rows those of all tracks and of all contacts.

    Parameters
    ----------
    found : sequence of GatePairs
        Rows are those of the scene.
    tracks, contacts : SceneRows
        Whose they are.
    """
    if tracks.single:
        return found[0]
    return GatePairs(
        np.concatenate([p.track + first for p, first in zip(found, tracks.starts, strict=True)]),
        np.concatenate(
            [p.contact + first for p, first in zip(found, contacts.starts, strict=True)]
        ),
    )


def predict_gates(bank: TrackBank, sensor: SensorGeometry | SensorsOfTracks) -> TrackGates:
    """Return the gates of predicted tracks.

    Parameters
    ----------
    bank : TrackBank
        Predicted to the stamp of the ping.
    sensor : SensorGeometry or SensorsOfTracks
        Where the ping comes from.
    """
    takes_time = sensor.sound_speed > 0.0
    mean, spread = bank.moments() if takes_time else bank.position_moments()
    separation = mean[:, :2] - sensor.position
    distance = np.maximum(np.hypot(separation[:, 0], separation[:, 1]), 1e-3)
    delay = distance / sensor.sound_speed if takes_time else np.zeros(len(bank))
    noise = position_covariance(
        separation / distance[:, None],
        distance,
        sensor.range_standard_deviation,
        sensor.azimuth_standard_deviation,
    )
    covariance = delayed_position_covariance(spread, delay) + noise
    volume = np.pi * GATE_SIZE**2 * np.sqrt(determinant(covariance))
    centre = mean[:, :2] + delay[:, None] * mean[:, 2:]
    return TrackGates(centre, covariance, volume, distance)


def delayed_position_covariance(covariance: FloatArray, delay: FloatArray) -> FloatArray:
    """Return the covariance of position + delay * velocity.

    Parameters
    ----------
    covariance : ndarray, shape (..., 4, 4) or (..., 2, 2)
        Of x, y, vx, vy, m^2, m^2/s, m^2/s^2; where there is no delay that of x, y will do.
    delay : ndarray, shape (...)
        s.

    Returns
    -------
    ndarray, shape (..., 2, 2)
        m^2.
    """
    if not delay.any():
        return covariance[..., :2, :2]
    step = delay[..., None, None]
    crossed = covariance[..., :2, 2:]
    velocity = covariance[..., 2:, 2:]
    both = crossed + crossed.swapaxes(-1, -2)
    return np.asarray(covariance[..., :2, :2] + step * both + step**2 * velocity)


def determinant(matrix: FloatArray) -> FloatArray:
    """Return the determinants of covariances in closed form.

    Of an ellipse thinner than rounding it is what rounding leaves, so that it stays positive.

    Parameters
    ----------
    matrix : ndarray, shape (..., 2, 2)
        m^2.

    Returns
    -------
    ndarray, shape (...)
        m^4.
    """
    product = matrix[..., 0, 0] * matrix[..., 1, 1]
    return np.asarray(np.maximum(product - matrix[..., 0, 1] ** 2, SMALLEST_SHARE * product))


def inverse(matrix: FloatArray, area: FloatArray) -> FloatArray:
    """Return the inverses of symmetric matrices.

    Parameters
    ----------
    matrix : ndarray, shape (..., 2, 2)
        m^2.
    area : ndarray, shape (...)
        Their determinants, m^4.

    Returns
    -------
    ndarray, shape (..., 2, 2)
        1/m^2.
    """
    result = -matrix
    result[..., 0, 0] = matrix[..., 1, 1]
    result[..., 1, 1] = matrix[..., 0, 0]
    result[..., 1, 0] = result[..., 0, 1]
    result /= area[..., None, None]
    return result
