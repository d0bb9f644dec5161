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

from sonar_tracking.filtering.assignment import least_cost_pairs
from sonar_tracking.filtering.constant_velocity import process_noise_matrix
from sonar_tracking.passive.sources.weak_source_counting import WeakSourceCounter
from sonar_tracking.passive.track_start.hidden_pairs import (
    HiddenPair,
    PairFit,
    hidden_pair,
    new_pair,
)
from sonar_tracking.passive.track_start.new_bearings import new_bearings
from sonar_tracking.passive.track_start.tentative_track import StartedTrack, TentativeTrack
from sonar_tracking.records.arrays import ComplexArray, FloatArray
from sonar_tracking.records.bearings import SubspaceEstimates
from sonar_tracking.records.time import nanoseconds, seconds

POINTS_TO_START = 4
"""Joined bearings that start a track."""

_GATE = 16.0
_MISSES_ALLOWED = 1


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
    counter : WeakSourceCounter
        Counts weak sources in the means of the last covariances.
    pairs : tuple of HiddenPair
        Tracks that may be two that the array does not resolve.
    """

    process_noise: float
    maximum_rate: float
    next_id: int
    tentative: tuple[TentativeTrack, ...] = ()
    last_covariance: int | None = None
    follows_count: bool = False
    counter: WeakSourceCounter = field(default_factory=WeakSourceCounter)
    pairs: tuple[HiddenPair, ...] = ()

    def counting(self, estimates: SubspaceEstimates) -> WeakSourceCounter | None:
        """Return the counter with the covariance of an estimate, None if it is not counted on.

        Parameters
        ----------
        estimates : SubspaceEstimates
            Of a single run.
        """
        covariance = estimates.covariance
        if covariance is None or not self.follows_count or self._shares_snapshots(estimates):
            return None
        return self.counter.add(covariance_middle(estimates), covariance)

    def update(
        self,
        estimates: SubspaceEstimates,
        tracked_angles: FloatArray,
        n_seen: int | None = None,
        n_weak: int = 0,
        tracked_ids: tuple[int, ...] = (),
        tracked_rates: FloatArray | None = None,
        n_faint: int = 0,
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
        n_weak : int
            Sources that the counter (:meth:`counting`) sees at least.
        tracked_ids : tuple of int
            Their identifiers, if any of them may turn out to be two: a track with the identifier
            of one that runs then starts in its place.
        tracked_rates : ndarray, shape (n_tracks,), optional
            Rates of the tracks, rad/s; zero if not given.
        n_faint : int
            Tracks besides ``n_seen`` that may have a source in this covariance.
        """
        if (covariance := estimates.covariance) is None:
            return self, ()
        n_running = len(tracked_angles)
        n_seen = n_running if n_seen is None else n_seen
        if not self.follows_count and estimates.basis.shape[-1] <= n_seen:
            return replace(self, tentative=()), ()
        if self._shares_snapshots(estimates):
            return self, ()
        middle = covariance_middle(estimates)
        n_sources = self._count_sources(estimates, n_weak)
        wanted = min(n_sources - n_seen, len(estimates.element_positions) - 1 - n_running)
        angles, variances = self._new_bearings(estimates, n_sources, tracked_angles, wanted)
        joined = self._join(middle, angles, variances)
        ready = [track for track in joined if len(track.stamps) >= POINTS_TO_START]
        ready = ready[: max(wanted, 0)]
        started = tuple(self._start_track(track, estimates.stamp) for track in ready)
        left = replace(
            self,
            tentative=tuple(track for track in joined if track not in ready),
            next_id=max([self.next_id, *(track.id + 1 for track in joined)]),
            last_covariance=middle,
            counter=self.counting(estimates) or self.counter,
        )
        if not self.follows_count or not tracked_ids:
            return left, started
        fit = None
        if max(n_sources, estimates.rank) - n_seen - n_faint > len(angles):
            fit = _pair(estimates, covariance, n_sources, tracked_angles, tracked_rates)
        left, both = left._follow_pairs(middle, estimates.stamp, fit, tracked_ids)
        return left, (*started, *both)

    def _new_bearings(
        self,
        estimates: SubspaceEstimates,
        n_sources: int,
        tracked_angles: FloatArray,
        wanted: int,
    ) -> tuple[FloatArray, FloatArray]:
        """Return bearings that belong to no track, and their variances, if there may be any."""
        if wanted <= 0 or estimates.covariance is None:
            return np.empty(0), np.empty(0)
        smooth = self.follows_count and 0 <= estimates.rank < n_sources
        return new_bearings(estimates, estimates.covariance, n_sources, tracked_angles, smooth)

    def _follow_pairs(
        self,
        middle: int,
        stamp: int,
        fit: PairFit | None,
        tracked_ids: tuple[int, ...],
    ) -> tuple[BearingStart, tuple[StartedTrack, ...]]:
        """Return the start with the pair that a track was taken for, and the tracks of a pair."""
        pairs, next_id = [], self.next_id
        name = None if fit is None else tracked_ids[fit.row]
        for each in self.pairs:
            if fit is not None and name == each.track_id:
                pairs.append(each.add(middle, fit))
                name = None
            elif each.track_id in tracked_ids and (missed := each.missed()) is not None:
                pairs.append(missed)
        if fit is not None and name is not None:
            pairs.append(new_pair(name, next_id, middle, fit))
            next_id += 1
        ready = [each for each in pairs if each.misses == 0 and each.resolved(middle)]
        both = tuple(self._start_track(side, stamp) for each in ready for side in each.sides)
        waiting = tuple(each for each in pairs if each not in ready)
        return replace(self, pairs=waiting, next_id=next_id), both

    def _shares_snapshots(self, estimates: SubspaceEstimates) -> bool:
        """Return whether the last covariance used has snapshots of this one.

        They would make the bearings look more certain than they are.
        """
        if self.last_covariance is None:
            return False
        duration = estimates.covariance_snapshots * estimates.sample_period
        return seconds(covariance_middle(estimates) - self.last_covariance) < 0.999 * duration

    def _count_sources(self, estimates: SubspaceEstimates, n_weak: int) -> int:
        """Return how many sources MUSIC is to look for."""
        if not self.follows_count:
            return estimates.basis.shape[-1]
        count = estimates.source_count if estimates.source_count >= 0 else estimates.rank
        count = max(count, n_weak)
        return min(count, len(estimates.element_positions) - 1)

    def _join(self, middle: int, angles: FloatArray, variances: FloatArray) -> list[TentativeTrack]:
        """Join bearings to tentative tracks; those left over begin new ones."""
        if not self.tentative and not len(angles):
            return []
        bearings = list(zip(angles.tolist(), variances.tolist(), strict=True))
        costs = np.array(
            [[self._cost(track, middle, *each) for each in bearings] for track in self.tentative]
        ).reshape(len(self.tentative), len(bearings))
        rows, columns = least_cost_pairs(np.minimum(costs, 10.0 * _GATE))
        matches = {r: c for r, c in zip(rows, columns, strict=True) if costs[r, c] <= _GATE}
        joined = []
        for row, track in enumerate(self.tentative):
            if row in matches:
                joined.append(track.add(middle, *bearings[matches[row]]))
            elif track.misses < _MISSES_ALLOWED:
                joined.append(replace(track, misses=track.misses + 1))
        fresh = [each for column, each in enumerate(bearings) if column not in matches.values()]
        for number, (angle, variance) in enumerate(fresh, start=self.next_id):
            joined.append(TentativeTrack(number, (middle,), (angle,), (variance,)))
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

    def _start_track(self, track: TentativeTrack, stamp: int) -> StartedTrack:
        mean, covariance = track.line(stamp)
        duration = seconds(stamp - track.stamps[0])
        motion = process_noise_matrix(self.process_noise, duration)
        return StartedTrack(track.id, mean, covariance + motion)


def _pair(
    estimates: SubspaceEstimates,
    covariance: ComplexArray,
    n_sources: int,
    angles: FloatArray,
    rates: FloatArray | None,
) -> PairFit | None:
    """Return the pair that a track may be: one in the smoothed covariance, two in the whole one."""
    count = max(n_sources, estimates.rank)
    still = np.zeros_like(angles) if rates is None else rates
    return hidden_pair(estimates, covariance, count, angles, still)


def covariance_middle(estimates: SubspaceEstimates) -> int:
    """Return the middle of the snapshots of a covariance, ns."""
    return estimates.stamp + nanoseconds(estimates.covariance_time_offset)
