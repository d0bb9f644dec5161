"""Automatic start of bearing tracks: MUSIC on successive covariances, joined to lines.

Each sample covariance gives the bearings that MUSIC resolves. Bearings of successive covariances
are joined by a least-cost assignment, first at the fastest rate that is looked for, then around
the line through those joined already. Four joined bearings start a track: a least-squares line
gives its angle and rate (tracks started with rate zero are lost), and the covariance of the line
plus the process noise of its duration is its first covariance. Only covariances that share no
snapshots are used.

How many tracks there may be is either the number of columns of the subspace, or, where the tracker
measures in the block covariance, the number of sources counted in each one and in the means of the
last ones, where weak sources show. MUSIC then uses the smoothed covariance where the count exceeds
the rank, so that coherent sources are found too.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from scipy.optimize import linear_sum_assignment

from sonar_tracking.filtering.constant_velocity import process_noise_matrix
from sonar_tracking.passive.bearings.new_bearings import new_bearings
from sonar_tracking.passive.sources.weak_source_counting import RecentCovariances
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import SubspaceEstimates
from sonar_tracking.records.time import nanoseconds, seconds

POINTS_TO_START = 4
"""Joined bearings that start a track."""

_GATE = 16.0
_MISSES_ALLOWED = 1

_FIRST_ODDS = 0.25
_ODDS_OF_BEARING = 5.0
_ODDS_OF_MISS = 0.5
"""Odds of existence of a tentative track at its first bearing, and their factors for each bearing
joined and each miss: four bearings in a row make a probability of 0.97."""


@dataclass(frozen=True)
class TentativeTrack:
    """Bearings joined so far, of what may become a track.

    Attributes
    ----------
    id : int
        Identifier, kept when the track starts.
    stamps : tuple of int
        Middle of the covariance of each bearing, ns.
    angles, variances : tuple of float
        rad, rad^2.
    misses : int
        Covariances without a bearing since the last one.
    """

    id: int
    stamps: tuple[int, ...]
    angles: tuple[float, ...]
    variances: tuple[float, ...]
    misses: int = 0

    @property
    def existence_probability(self) -> float:
        """Probability that a source made these bearings."""
        joined = _ODDS_OF_BEARING ** (len(self.stamps) - 1)
        odds = _FIRST_ODDS * joined * _ODDS_OF_MISS**self.misses
        return odds / (1.0 + odds)

    def line(self, stamp: int) -> tuple[FloatArray, FloatArray]:
        """Return mean (2,) and covariance (2, 2) of angle and rate at an instant, least squares."""
        times = seconds(np.array(self.stamps, dtype=np.int64) - stamp)
        design = np.stack([np.ones_like(times), times], axis=-1)
        weights = 1.0 / np.array(self.variances)
        covariance = np.asarray(np.linalg.inv(design.T @ (weights[:, None] * design)), np.float64)
        return covariance @ (design.T @ (weights * np.array(self.angles))), covariance


@dataclass(frozen=True)
class StartedTrack:
    """A track at its first instant.

    Attributes
    ----------
    id : int
        Identifier.
    mean : ndarray, shape (2,)
        Angle and rate, rad and rad/s.
    covariance : ndarray, shape (2, 2)
        Of angle and rate.
    """

    id: int
    mean: FloatArray
    covariance: FloatArray


@dataclass(frozen=True)
class BearingStart:
    """The automatic start between two estimates.

    Attributes
    ----------
    process_noise : float
        Spectral density of the bearing acceleration, rad^2/s^3.
    maximum_rate : float
        rad/s.
    next_id : int
        Identifier of the next tentative track.
    tentative : tuple of TentativeTrack
        Not started yet.
    last_covariance : int or None
        Middle of the last covariance used, ns.
    follows_count : bool
        Whether the sources counted in each covariance, and not the columns of the subspace, limit
        the number of tracks.
    recent : RecentCovariances
        Where weak sources are counted.
    """

    process_noise: float
    maximum_rate: float
    next_id: int
    tentative: tuple[TentativeTrack, ...] = ()
    last_covariance: int | None = None
    follows_count: bool = False
    recent: RecentCovariances = field(default_factory=RecentCovariances)

    def update(
        self, estimates: SubspaceEstimates, tracked_angles: FloatArray, n_seen: int | None = None
    ) -> tuple[BearingStart, tuple[StartedTrack, ...]]:
        """Return the start after one more estimate and the tracks started by it.

        Parameters
        ----------
        estimates : SubspaceEstimates
            Of a single run; without a covariance nothing happens.
        tracked_angles : ndarray, shape (n_tracks,)
            Arrival angles of the tracks that run already, rad.
        n_seen : int, optional
            How many of them have a source in this covariance; all if not given.
        """
        if estimates.covariance is None:
            return self, ()
        n_running = len(tracked_angles)
        n_seen = n_running if n_seen is None else n_seen
        if not self.follows_count and estimates.basis.shape[-1] <= n_seen:
            return replace(self, tentative=()), ()
        middle = estimates.stamp + nanoseconds(estimates.covariance_time_offset)
        duration = estimates.covariance_snapshots * estimates.sample_period
        last = self.last_covariance
        if last is not None and seconds(middle - last) < 0.999 * duration:
            # Shared snapshots would make the bearings look more certain than they are.
            return self, ()
        recent = self.recent
        if self.follows_count:
            recent = recent.with_newest(middle, estimates.covariance)
        n_sources = self._n_sources(estimates, recent)
        wanted = min(n_sources - n_seen, len(estimates.element_positions) - 1 - n_running)
        angles, variances = np.empty(0), np.empty(0)
        if wanted > 0:
            smooth = self.follows_count and 0 <= estimates.rank < n_sources
            angles, variances = new_bearings(
                estimates, estimates.covariance, n_sources, tracked_angles, smooth
            )
        joined = self._joined(middle, angles, variances)
        ready = [track for track in joined if len(track.stamps) >= POINTS_TO_START]
        ready = ready[: max(wanted, 0)]
        started = tuple(self._started(track, estimates.stamp) for track in ready)
        tentative = tuple(track for track in joined if track not in ready)
        next_id = max([self.next_id, *(track.id + 1 for track in joined)])
        left = replace(
            self, tentative=tentative, next_id=next_id, last_covariance=middle, recent=recent
        )
        return left, started

    def _n_sources(self, estimates: SubspaceEstimates, recent: RecentCovariances) -> int:
        """Return how many sources MUSIC is to look for."""
        if not self.follows_count:
            return estimates.basis.shape[-1]
        count = estimates.source_count if estimates.source_count >= 0 else estimates.rank
        count = max(count, recent.n_sources(estimates, self.maximum_rate))
        return min(count, len(estimates.element_positions) - 1)

    def _joined(
        self, middle: int, angles: FloatArray, variances: FloatArray
    ) -> list[TentativeTrack]:
        """Join bearings to tentative tracks; those left over begin new ones."""
        costs = np.array(
            [
                [self._cost(track, middle, a, v) for a, v in zip(angles, variances, strict=True)]
                for track in self.tentative
            ]
        ).reshape(len(self.tentative), len(angles))
        rows, columns = linear_sum_assignment(np.minimum(costs, 10.0 * _GATE))
        matches = {r: c for r, c in zip(rows, columns, strict=True) if costs[r, c] <= _GATE}
        joined = []
        for row, track in enumerate(self.tentative):
            if row in matches:
                column = matches[row]
                joined.append(_extended(track, middle, angles[column], variances[column]))
            elif track.misses < _MISSES_ALLOWED:
                joined.append(replace(track, misses=track.misses + 1))
        fresh = [column for column in range(len(angles)) if column not in matches.values()]
        for number, column in enumerate(fresh, start=self.next_id):
            point = (middle,), (float(angles[column]),), (float(variances[column]),)
            joined.append(TentativeTrack(number, *point))
        return joined

    def _cost(self, track: TentativeTrack, middle: int, angle: float, variance: float) -> float:
        """Return the normalised squared distance of a bearing from a tentative track."""
        interval = seconds(middle - track.stamps[-1])
        if len(track.stamps) == 1:
            reach = (self.maximum_rate * interval) ** 2 / _GATE
            spread = reach + variance + track.variances[0]
            return float((angle - track.angles[0]) ** 2 / spread)
        mean, covariance = track.line(middle)
        # The line ignores the acceleration since its first bearing.
        motion = process_noise_matrix(self.process_noise, seconds(middle - track.stamps[0]))
        spread = covariance[0, 0] + motion[0, 0] + variance
        return float((angle - mean[0]) ** 2 / spread)

    def _started(self, track: TentativeTrack, stamp: int) -> StartedTrack:
        mean, covariance = track.line(stamp)
        duration = seconds(stamp - track.stamps[0])
        motion = process_noise_matrix(self.process_noise, duration)
        return StartedTrack(track.id, mean, covariance + motion)


def _extended(track: TentativeTrack, middle: int, angle: float, variance: float) -> TentativeTrack:
    return replace(
        track,
        stamps=(*track.stamps, middle),
        angles=(*track.angles, float(angle)),
        variances=(*track.variances, float(variance)),
        misses=0,
    )
