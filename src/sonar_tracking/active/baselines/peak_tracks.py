"""Identities for the peaks of a density, which by itself has none.

Each peak takes the identity of the nearest peak of the ping before in its gate; all together are
assigned so that the sum of their squared distances is least. A peak that is not found is predicted
and listed as tentative for a few pings, which a missed detection does not outlast, and is then
reported to have ended. The existence probability of a track is the weight of its peak, at most 1.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from sonar_tracking.active.baselines.state_extraction import Peaks
from sonar_tracking.active.detection.detection_threshold import GATE_SIZE
from sonar_tracking.active.tracks.contact_gating import determinant, inverse
from sonar_tracking.active.tracks.contact_track_list import ContactTrackRows
from sonar_tracking.active.tracks.motion_modes import turn_matrices, white_acceleration_noise
from sonar_tracking.active.tracks.particle_cloud import ParticleCloud
from sonar_tracking.filtering.assignment import least_cost_pairs
from sonar_tracking.records.arrays import FloatArray, IndexArray, IntArray
from sonar_tracking.records.bearings import TrackStatus

LONGEST_ABSENCE = 3
"""Pings; a track whose peak is missing longer ends."""

STRANGER = 1e6
"""Squared distance of a pair outside the gate: more than all pairs in gates together."""


@dataclass(frozen=True)
class PeakTracks:
    """Peaks with identities.

    Attributes
    ----------
    id : ndarray of int, shape (n,)
        Ascending.
    state, covariance : ndarray, shape (n, 4) and (n, 4, 4)
        x, y, vx, vy in ``map``, m and m/s; m^2, m^2/s, m^2/s^2.
    existence : ndarray, shape (n,)
        Weight of the peak, a probability, at most 1.
    absent : ndarray of int, shape (n,)
        Pings since the peak was found last.
    initiated, updated : ndarray of int, shape (n,)
        Stamps of the first and the last ping with the peak, ns.
    """

    id: IntArray
    state: FloatArray
    covariance: FloatArray
    existence: FloatArray
    absent: IntArray
    initiated: IntArray
    updated: IntArray

    def __len__(self) -> int:
        return len(self.id)

    def rows(self) -> ContactTrackRows:
        """Return what is shown: found, missing, and ended tracks."""
        status = np.full(len(self), int(TrackStatus.CONFIRMED), dtype=np.int64)
        status[self.absent > 0] = TrackStatus.TENTATIVE
        status[self.absent > LONGEST_ABSENCE] = TrackStatus.TERMINATED
        return ContactTrackRows(
            id=self.id,
            status=status,
            existence=self.existence,
            state=self.state,
            covariance=self.covariance,
            initiated=self.initiated,
            updated=self.updated,
        )


def no_peak_tracks() -> PeakTracks:
    """Return what there is before the first ping."""
    nothing = np.zeros(0, dtype=np.int64)
    return PeakTracks(
        nothing, np.zeros((0, 4)), np.zeros((0, 4, 4)), np.zeros(0), nothing, nothing, nothing
    )


def predict_peaks(tracks: PeakTracks, interval: float, acceleration_deviation: float) -> PeakTracks:
    """Return the tracks that have not ended, after an interval.

    Parameters
    ----------
    tracks : PeakTracks
        At the ping before.
    interval : float
        s.
    acceleration_deviation : float
        Of the white noise, m/s^2; turns are to be covered.
    """
    alive = tracks.absent <= LONGEST_ABSENCE
    motion = turn_matrices(np.zeros(()), interval)
    noise = white_acceleration_noise(acceleration_deviation, interval)
    return PeakTracks(
        id=tracks.id[alive],
        state=tracks.state[alive] @ motion.T,
        covariance=motion @ tracks.covariance[alive] @ motion.T + noise,
        existence=tracks.existence[alive],
        absent=tracks.absent[alive],
        initiated=tracks.initiated[alive],
        updated=tracks.updated[alive],
    )


def follow_peaks(
    tracks: PeakTracks, peaks: Peaks, cloud: ParticleCloud, stamp: int, first_id: int
) -> PeakTracks:
    """Return the tracks with the peaks of a ping; those without an older one are new.

    Parameters
    ----------
    tracks : PeakTracks
        Predicted to the ping.
    peaks : Peaks
        Of the ping.
    cloud : ParticleCloud
        They were found in: what is left of it near a missing peak is that one's existence.
    stamp : int
        Of the ping, ns.
    first_id : int
        Identifier of the first new track.
    """
    old, found = nearest_peaks(tracks, peaks)
    missing = np.ones(len(tracks), dtype=bool)
    missing[old] = False
    state, covariance = tracks.state.copy(), tracks.covariance.copy()
    existence, updated = tracks.existence.copy(), tracks.updated.copy()
    state[old], covariance[old] = peaks.state[found], peaks.covariance[found]
    existence[old] = np.minimum(peaks.mass[found], 1.0)
    existence[missing] = _mass_near(tracks, np.flatnonzero(missing), cloud)
    updated[old] = stamp
    followed = PeakTracks(
        id=tracks.id,
        state=state,
        covariance=covariance,
        existence=existence,
        absent=np.where(missing, tracks.absent + 1, 0),
        initiated=tracks.initiated,
        updated=updated,
    )
    is_new = np.ones(len(peaks.mass), dtype=bool)
    is_new[found] = False
    new = np.flatnonzero(is_new)
    return _join(followed, _start(peaks, new, stamp, first_id)) if len(new) else followed


def nearest_peaks(tracks: PeakTracks, peaks: Peaks) -> tuple[IndexArray, IndexArray]:
    """Return rows of tracks and of the peaks that go on with them.

    Parameters
    ----------
    tracks : PeakTracks
        Predicted.
    peaks : Peaks
        Of the ping.

    Returns
    -------
    tracks, peaks : ndarray of int, shape (n_pairs,)
        Rows of both.
    """
    difference = peaks.state[None, :, :2] - tracks.state[:, None, :2]
    spread = tracks.covariance[:, None, :2, :2] + peaks.covariance[None, :, :2, :2]
    # A cluster of copies of one particle has no extent.
    spread = spread + np.eye(2)
    scaled = np.matmul(inverse(spread, determinant(spread)), difference[..., None])[..., 0]
    square = (difference * scaled).sum(axis=-1)
    inside = square < GATE_SIZE**2
    rows, columns = least_cost_pairs(np.where(inside, square, STRANGER))
    kept = inside[rows, columns]
    return rows[kept], columns[kept]


def _mass_near(tracks: PeakTracks, rows: IndexArray, cloud: ParticleCloud) -> FloatArray:
    """Return the weight of the cloud in the gates of some tracks, at most 1."""
    mass = np.zeros(len(rows))
    spread = tracks.covariance[rows, :2, :2] + np.eye(2)
    scales = inverse(spread, determinant(spread))
    for index, row in enumerate(rows):
        (xx, xy), (_, yy) = scales[index]
        x, y = (cloud.state[:, axis] - tracks.state[row, axis] for axis in (0, 1))
        square = xx * x**2 + 2.0 * xy * x * y + yy * y**2
        mass[index] = min(1.0, float(np.sum(cloud.weight[square < GATE_SIZE**2])))
    return mass


def _start(peaks: Peaks, rows: IndexArray, stamp: int, first_id: int) -> PeakTracks:
    stamps = np.full(len(rows), stamp, dtype=np.int64)
    return PeakTracks(
        id=first_id + np.arange(len(rows), dtype=np.int64),
        state=peaks.state[rows],
        covariance=peaks.covariance[rows],
        existence=np.minimum(peaks.mass[rows], 1.0),
        absent=np.zeros(len(rows), dtype=np.int64),
        initiated=stamps,
        updated=stamps,
    )


def _join(first: PeakTracks, second: PeakTracks) -> PeakTracks:
    names = [field.name for field in fields(PeakTracks)]
    return PeakTracks(*[np.concatenate((getattr(first, n), getattr(second, n))) for n in names])
