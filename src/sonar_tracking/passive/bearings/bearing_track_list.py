"""The list of tracks as it is published: folded angles, status, tentative rows last."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.geometry import is_line
from sonar_tracking.passive.bearings.bearing_measurement import BearingMeasurement
from sonar_tracking.passive.bearings.track_existence import STARTED
from sonar_tracking.passive.track_start.tentative_track import StartedTrack, TentativeTrack
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import BearingTracks, SubspaceEstimates, TrackStatus


@dataclass(frozen=True)
class BearingTrackRows:
    """Rows of a track list, angles not folded yet.

    Attributes
    ----------
    ids : tuple of int
        Identifiers.
    status : tuple of TrackStatus
        One a row.
    filters : KalmanState
        Angle and rate, shapes (..., n_rows, 2) and (..., n_rows, 2, 2), rad and rad/s.
    measurement, innovation, variance : ndarray, shape (..., n_rows)
        Measured angle, its difference from the prediction, its variance, rad and rad^2; NaN =
        none.
    signal_to_noise_ratio : ndarray, shape (..., n_rows)
        Linear; NaN = not known.
    existence_probability : ndarray, shape (..., n_rows)
        Probabilities; NaN = not known.
    """

    ids: tuple[int, ...]
    status: tuple[TrackStatus, ...]
    filters: KalmanState
    measurement: FloatArray
    innovation: FloatArray
    variance: FloatArray
    signal_to_noise_ratio: FloatArray
    existence_probability: FloatArray

    def append(self, other: BearingTrackRows) -> BearingTrackRows:
        """Return the rows of both, in order."""
        if not other.ids:
            return self
        return BearingTrackRows(
            self.ids + other.ids,
            self.status + other.status,
            KalmanState(
                np.concatenate([self.filters.mean, other.filters.mean], axis=-2),
                np.concatenate([self.filters.covariance, other.filters.covariance], axis=-3),
            ),
            np.concatenate([self.measurement, other.measurement], axis=-1),
            np.concatenate([self.innovation, other.innovation], axis=-1),
            np.concatenate([self.variance, other.variance], axis=-1),
            np.concatenate([self.signal_to_noise_ratio, other.signal_to_noise_ratio], axis=-1),
            np.concatenate([self.existence_probability, other.existence_probability], axis=-1),
        )

    def without(self, ids: tuple[int, ...]) -> BearingTrackRows:
        """Return the rows of a single run but for those with some identifiers."""
        if not set(ids) & set(self.ids):
            return self
        left = [row for row, name in enumerate(self.ids) if name not in ids]
        return BearingTrackRows(
            tuple(self.ids[row] for row in left),
            tuple(self.status[row] for row in left),
            KalmanState(self.filters.mean[left], self.filters.covariance[left]),
            self.measurement[left],
            self.innovation[left],
            self.variance[left],
            self.signal_to_noise_ratio[left],
            self.existence_probability[left],
        )

    def widened(self, deviations: Mapping[int, float]) -> BearingTrackRows:
        """Return the rows of a single run with angles that are less certain.

        Parameters
        ----------
        deviations : mapping of int to float
            By how much, by identifier, rad.
        """
        if not deviations:
            return self
        covariance = self.filters.covariance.copy()
        more = np.array([deviations.get(name, 0.0) for name in self.ids])
        covariance[:, 0, 0] += more**2
        return replace(self, filters=KalmanState(self.filters.mean, covariance))


def running_rows(
    ids: tuple[int, ...],
    filters: KalmanState,
    measurement: BearingMeasurement | None,
    signal_to_noise_ratio: FloatArray,
    status: tuple[TrackStatus, ...],
    existence_probability: FloatArray | None,
) -> BearingTrackRows:
    """Return the rows of the running tracks and of those that end.

    Parameters
    ----------
    ids : tuple of int
        Identifiers.
    filters : KalmanState
        Angle and rate of each, shapes (..., n_tracks, 2) and (..., n_tracks, 2, 2), rad, rad/s.
    measurement : BearingMeasurement or None
        What the estimate told of each; None = nothing.
    signal_to_noise_ratio : ndarray, shape (..., n_tracks)
        Linear; NaN = not known.
    status : tuple of TrackStatus
        One a track.
    existence_probability : ndarray, shape (n_tracks,), or None
        Probabilities; None = not estimated.
    """
    unknown = np.full(filters.mean.shape[:-1], np.nan)
    measured = unknown
    if measurement is not None:
        # All angles of the list are those of its stamp; the data are a little older.
        measured = measurement.angle + measurement.age * filters.mean[..., 1]
    return BearingTrackRows(
        ids,
        status,
        filters,
        measured,
        unknown if measurement is None else measurement.innovation,
        unknown if measurement is None else measurement.variance,
        signal_to_noise_ratio,
        unknown if existence_probability is None else existence_probability,
    )


def started_rows(started: tuple[StartedTrack, ...]) -> BearingTrackRows:
    """Return the rows of tracks at their first instant."""
    return _rows(started, TrackStatus.CONFIRMED, np.full(len(started), STARTED))


def tentative_rows(tentative: tuple[TentativeTrack, ...], stamp: int) -> BearingTrackRows:
    """Return the rows of tentative tracks; rates are NaN until two bearings are joined."""
    if not tentative:
        return _NO_ROWS
    seen = []
    for track in tentative:
        if len(track.stamps) > 1:
            seen.append(StartedTrack(track.id, *track.line(stamp)))
            continue
        covariance = np.full((2, 2), np.nan)
        covariance[0, 0] = track.variances[0]
        seen.append(StartedTrack(track.id, np.array([track.angles[0], np.nan]), covariance))
    existence = np.array([track.existence_probability for track in tentative])
    return _rows(tuple(seen), TrackStatus.TENTATIVE, existence)


def _rows(
    tracks: tuple[StartedTrack, ...], status: TrackStatus, existence_probability: FloatArray
) -> BearingTrackRows:
    count = len(tracks)
    unknown = np.full(count, np.nan)
    return BearingTrackRows(
        tuple(track.id for track in tracks),
        (status,) * count,
        KalmanState(
            np.array([track.mean for track in tracks]).reshape(count, 2),
            np.array([track.covariance for track in tracks]).reshape(count, 2, 2),
        ),
        unknown,
        unknown,
        unknown,
        unknown,
        existence_probability,
    )


_NO_ROWS = _rows((), TrackStatus.TENTATIVE, np.empty(0))


def folded_angles(angles: FloatArray, positions: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the angles as an array can tell them, and the sign of their rates.

    Parameters
    ----------
    angles : ndarray, shape (...)
        rad, unbounded.
    positions : ndarray, shape (n_elements, 3)
        m. A line array cannot distinguish theta from pi - theta: its angles are folded into
        -pi/2 ... pi/2; those of other arrays are wrapped into -pi ... pi.

    Returns
    -------
    angles : ndarray, shape (...)
        Folded, rad.
    signs : ndarray, shape (...)
        Pure numbers: -1 where the fold reverses the sense of rotation, else 1.
    """
    line = is_line(positions)
    signs = np.ones_like(angles)
    inside = ~(np.abs(angles) > (0.5 * np.pi if line else np.pi))
    if inside.all():
        return angles, signs
    wrapped = np.where(inside, angles, np.remainder(angles + np.pi, 2.0 * np.pi) - np.pi)
    if not line:
        return wrapped, signs
    behind = np.abs(wrapped) > 0.5 * np.pi
    folded = np.where(behind, np.copysign(np.pi, wrapped) - wrapped, wrapped)
    return folded, np.where(behind, -1.0, 1.0)


def bearing_tracks(estimates: SubspaceEstimates, rows: BearingTrackRows) -> BearingTracks:
    """Return the published list of tracks.

    Parameters
    ----------
    estimates : SubspaceEstimates
        What the tracks were updated with.
    rows : BearingTrackRows
        All tracks.
    """
    positions = estimates.element_positions
    mean = rows.filters.mean
    angles, signs = folded_angles(mean[..., 0], positions)
    return BearingTracks(
        stamp=estimates.stamp,
        id=np.array(rows.ids, dtype=np.uint64),
        status=np.array(rows.status, dtype=np.uint8),
        arrival_angle=angles,
        arrival_angle_rate=signs * mean[..., 1],
        covariance=rows.filters.covariance,
        measurement=folded_angles(rows.measurement, positions)[0],
        measurement_variance=rows.variance,
        innovation=signs * rows.innovation,
        signal_to_noise_ratio=rows.signal_to_noise_ratio,
        existence_probability=rows.existence_probability,
        ambiguous=np.full(mean.shape[-2], is_line(positions)),
        next_stamp=estimates.next_stamp,
        sensor=estimates.sensor,
    )
