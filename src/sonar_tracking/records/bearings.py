"""What flows between the stages of the passive chain: plain arrays, immutable.

Stamps are integer nanoseconds. Angles are arrival angles: radians from array broadside,
positive towards increasing element x. ``...`` stands for optional leading batch dimensions (the
Monte Carlo runs of a study); a node has none.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np

from sonar_tracking.records.arrays import BoolArray, CodeArray, ComplexArray, FloatArray, IdArray
from sonar_tracking.records.time import UNKNOWN_STAMP


class AngleKind(IntEnum):
    """What the angles of bearing tracks are, as in the messages."""

    CONE = 0
    """From array broadside, positive towards increasing element x."""
    AZIMUTH = 1
    """Anticlockwise from +x of the frame of the sensor."""


class TrackStatus(IntEnum):
    """Status of a track, as in the messages."""

    TENTATIVE = 0
    CONFIRMED = 1
    COASTED = 2
    TERMINATED = 3


def established(status: CodeArray) -> BoolArray:
    """Return which tracks are confirmed, seen at the last instant or coasted.

    Parameters
    ----------
    status : ndarray of uint8, shape (n_tracks,)
        :class:`TrackStatus` values.

    Returns
    -------
    ndarray of bool, shape (n_tracks,)
        True for confirmed and coasted tracks.
    """
    return (status == int(TrackStatus.CONFIRMED)) | (status == int(TrackStatus.COASTED))


@dataclass(frozen=True)
class Sensor:
    """The sensor that made the data.

    Attributes
    ----------
    sensor_id : str
        Name, constant during a run.
    frame_id : str
        Frame of the element positions.
    position : tuple of float
        x, y, z of the sensor frame in ``map``, m; NaN = unknown.
    orientation : tuple of float
        Quaternion x, y, z, w of the sensor frame in ``map``; NaN = unknown.
    velocity : tuple of float
        In ``map``, m/s; NaN = unknown.
    """

    sensor_id: str = "array"
    frame_id: str = "own_ship/array"
    position: tuple[float, float, float] = (np.nan,) * 3
    orientation: tuple[float, float, float, float] = (np.nan,) * 4
    velocity: tuple[float, float, float] = (np.nan,) * 3


@dataclass(frozen=True)
class ArraySnapshots:
    """A contiguous block of narrowband snapshots.

    Attributes
    ----------
    stamp : int
        Instant of the first snapshot, ns.
    data : ndarray, shape (..., n_snapshots, n_elements), complex
        Complex baseband samples, linear amplitude.
    element_positions : ndarray, shape (n_elements, 3)
        In the sensor frame, m; order = data columns.
    sample_period : float
        Between snapshots, s.
    center_frequency, bandwidth : float
        Hz.
    sound_speed : float
        m/s.
    noise_covariance : ndarray, shape (n_elements, n_elements), complex, or None
        Spatial noise covariance with trace n_elements, pure numbers; None = white.
    next_stamp : int
        Watermark, ns.
    sensor : Sensor
        The sensor that made the data.
    """

    stamp: int
    data: ComplexArray
    element_positions: FloatArray
    sample_period: float
    center_frequency: float
    bandwidth: float
    sound_speed: float
    noise_covariance: ComplexArray | None = None
    next_stamp: int = UNKNOWN_STAMP
    sensor: Sensor = field(default_factory=Sensor)


@dataclass(frozen=True)
class SubspaceEstimates:
    """Signal subspaces around one sample time.

    Attributes
    ----------
    stamp : int
        The sample time, ns.
    method : str
        How they were followed, a name of ``SUBSPACE_METHODS``.
    basis : ndarray, shape (..., n_subspaces, n_elements, n_columns), complex
        One basis a subspace, pure numbers; columns need not be orthonormal. n_subspaces 0 =
        none available.
    time_offsets : ndarray, shape (n_subspaces,)
        Time of each subspace relative to the stamp, s, ascending.
    element_positions : ndarray, shape (n_elements, 3)
        In the sensor frame, m; order = rows of the bases.
    sample_period, center_frequency, bandwidth, sound_speed
        As in :class:`ArraySnapshots`.
    effective_snapshots : float
        Independent snapshots one subspace stands for, (1 + beta) / (1 - beta).
    rank, source_count : int
        MDL on the raw and on the smoothed covariance; -1 = not estimated.
    covariance : ndarray, shape (..., n_elements, n_elements), complex, or None
        Sample covariance of ``covariance_snapshots`` snapshots, with the floor of steering
        errors, linear power.
    covariance_snapshots : int
        Snapshots in it; 0 = none.
    covariance_time_offset : float
        Middle of those snapshots relative to the stamp, s; NaN = none.
    eigenvalues : ndarray, shape (..., n_elements), or empty
        Of ``covariance``, linear power, descending.
    eigenvectors : ndarray, shape (..., n_elements, n_elements), complex, or None
        In their order, in columns, pure numbers; None = not known, as in messages.
    noise_power : ndarray, shape (...)
        Linear power per element; NaN = not estimated.
    noise_covariance : ndarray, shape (n_elements, n_elements), complex, or None
        Spatial noise covariance with trace n_elements, pure numbers; None = white.
    next_stamp, sensor
        As in :class:`ArraySnapshots`.
    """

    stamp: int
    method: str
    basis: ComplexArray
    time_offsets: FloatArray
    element_positions: FloatArray
    sample_period: float
    center_frequency: float
    bandwidth: float
    sound_speed: float
    effective_snapshots: float
    rank: int = -1
    source_count: int = -1
    covariance: ComplexArray | None = None
    covariance_snapshots: int = 0
    covariance_time_offset: float = np.nan
    eigenvalues: FloatArray = field(default_factory=lambda: np.empty(0))
    eigenvectors: ComplexArray | None = None
    noise_power: FloatArray = field(default_factory=lambda: np.array(np.nan))
    noise_covariance: ComplexArray | None = None
    next_stamp: int = UNKNOWN_STAMP
    sensor: Sensor = field(default_factory=Sensor)

    @property
    def newest_offset(self) -> float:
        """Time of the newest snapshot used relative to the stamp, s; NaN = none used."""
        half = 0.5 * (self.covariance_snapshots - 1) * self.sample_period
        ends = [*self.time_offsets[-1:], self.covariance_time_offset + half]
        return float(np.fmax.reduce(ends))


@dataclass(frozen=True)
class BearingTracks:
    """All bearing tracks at one instant; column n belongs to track n.

    Attributes
    ----------
    stamp : int
        Instant the angles refer to, ns.
    id : ndarray of uint64, shape (n_tracks,)
        Identifiers, never reused within a run.
    status : ndarray of uint8, shape (n_tracks,)
        :class:`TrackStatus` values.
    arrival_angle, arrival_angle_rate : ndarray, shape (..., n_tracks)
        Filtered, rad and rad/s.
    covariance : ndarray, shape (..., n_tracks, 2, 2)
        Of angle and rate, rad^2, rad^2/s, rad^2/s^2.
    measurement, measurement_variance, innovation : ndarray, shape (..., n_tracks)
        The (fused) measurement, its variance and its innovation; NaN = none. rad, rad^2, rad.
    signal_to_noise_ratio : ndarray, shape (..., n_tracks)
        Linear, per element; NaN = not estimated.
    existence_probability : ndarray, shape (..., n_tracks)
        Probabilities; NaN = not estimated.
    ambiguous : ndarray of bool, shape (n_tracks,)
        True where the sides of a line array cannot be told apart.
    next_stamp, sensor
        As in :class:`ArraySnapshots`.
    angle_kind : AngleKind
        What the angles are.
    elevation, elevation_variance : ndarray, shape (n_tracks,), or empty
        Above the horizontal, rad and rad^2; empty = none.
    """

    stamp: int
    id: IdArray
    status: CodeArray
    arrival_angle: FloatArray
    arrival_angle_rate: FloatArray
    covariance: FloatArray
    measurement: FloatArray
    measurement_variance: FloatArray
    innovation: FloatArray
    signal_to_noise_ratio: FloatArray
    existence_probability: FloatArray
    ambiguous: BoolArray
    next_stamp: int = UNKNOWN_STAMP
    sensor: Sensor = field(default_factory=Sensor)
    angle_kind: AngleKind = AngleKind.CONE
    elevation: FloatArray = field(default_factory=lambda: np.empty(0))
    elevation_variance: FloatArray = field(default_factory=lambda: np.empty(0))

    @property
    def established(self) -> BoolArray:
        """Which tracks are confirmed, seen now or coasted; shape (n_tracks,)."""
        return established(self.status)
