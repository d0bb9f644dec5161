"""Automatic start of the tracks of faint sources: track before detect beside the tracks there are.

One Bernoulli filter looks for one source more
(:mod:`sonar_tracking.passive.track_start.track_before_detect`). It takes what the tracks leave of
the mean of the covariances of some seconds that share no snapshots. It starts nothing where MDL
sees more sources than there are tracks in one of them: those are for the ordinary start. When a
track starts, by whatever start, the filter begins anew.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from sonar_tracking.filtering.constant_velocity import transition_matrix
from sonar_tracking.geometry import wavenumber
from sonar_tracking.passive.directions.beam_excess import BeamGrid, beam_excess, beam_grid
from sonar_tracking.passive.track_start.bearing_start import covariance_middle
from sonar_tracking.passive.track_start.tentative_track import StartedTrack
from sonar_tracking.passive.track_start.track_before_detect import FaintSource, TrackBeforeDetect
from sonar_tracking.records.arrays import ComplexArray, FloatArray
from sonar_tracking.records.bearings import SubspaceEstimates
from sonar_tracking.records.time import seconds

UPDATED_EVERY = 2.0
"""Least time between updates of the filter, s: a faint source shows no sooner."""

_LEAST_TURN = 0.2
"""To either side of a bearing, over the width of a beam, that is projected out with it: where it is
is known no better."""


@dataclass(frozen=True)
class FaintStart:
    """The search for faint sources between two estimates.

    Attributes
    ----------
    detector : TrackBeforeDetect
        What is known of one source more.
    last_update : int or None
        Middle of the covariances that it has seen last, ns.
    total : ndarray, shape (n_elements, n_elements), complex, or None
        Sum of the covariances since, linear power.
    middles : tuple of int
        Middle of each of them, ns.
    newest : int or None
        Middle of the last covariance used, ns.
    crowded : bool
        Whether MDL sees more sources than tracks in one of them.
    """

    detector: TrackBeforeDetect = field(default_factory=TrackBeforeDetect)
    last_update: int | None = None
    total: ComplexArray | None = None
    middles: tuple[int, ...] = ()
    newest: int | None = None
    crowded: bool = False

    def anew(self) -> FaintStart:
        """Return it with nothing known of another source."""
        return replace(self, detector=TrackBeforeDetect())

    def update(
        self,
        estimates: SubspaceEstimates,
        tracked: FloatArray,
        next_id: int,
        steering_error: float,
    ) -> tuple[FaintStart, tuple[StartedTrack, ...]]:
        """Return it after one more estimate, and the track started by it if there is one.

        Parameters
        ----------
        estimates : SubspaceEstimates
            Of a single run; without a covariance nothing happens.
        tracked : ndarray, shape (n_tracks, 2)
            Angles and rates of all tracks at the stamp, rad and rad/s.
        next_id : int
            Identifier of the track.
        steering_error : float
            Relative rms error of the elements that is known, pure number.
        """
        positions, covariance = estimates.element_positions, estimates.covariance
        number = wavenumber(estimates.center_frequency, estimates.sound_speed)
        grid = beam_grid(positions, number)
        if covariance is None or grid is None:
            return self, ()
        duration = estimates.covariance_snapshots * estimates.sample_period
        middle = covariance_middle(estimates)
        if self.newest is not None and seconds(middle - self.newest) < 0.999 * duration:
            return self, ()
        more = self._with(covariance, middle, estimates, len(tracked))
        if seconds(middle - more.middles[0]) + duration < 0.999 * UPDATED_EVERY:
            return more, ()
        return more._look(estimates, grid, tracked, next_id, steering_error)

    def _with(
        self, covariance: ComplexArray, middle: int, estimates: SubspaceEstimates, n_tracks: int
    ) -> FaintStart:
        """Return it with one more covariance."""
        crowded = max(estimates.rank, estimates.source_count) > n_tracks
        if self.total is None or self.total.shape != covariance.shape:
            first = replace(self, total=covariance, middles=(middle,), newest=middle)
            return replace(first, crowded=crowded)
        return replace(
            self,
            total=self.total + covariance,
            middles=(*self.middles, middle),
            newest=middle,
            crowded=self.crowded or crowded,
        )

    def _look(
        self,
        estimates: SubspaceEstimates,
        grid: BeamGrid,
        tracked: FloatArray,
        next_id: int,
        steering_error: float,
    ) -> tuple[FaintStart, tuple[StartedTrack, ...]]:
        """Return it after an update of the filter, and the track started by it."""
        middle = (self.middles[0] + self.middles[-1]) // 2
        count = len(self.middles)
        fresh = FaintStart(last_update=middle, newest=self.newest)
        if self.total is None:
            return fresh, ()
        beams = beam_excess(
            estimates,
            self.total / count,
            count * estimates.covariance_snapshots,
            self._angles_of(tracked, estimates, grid),
        )
        if beams is None:
            return fresh, ()
        detector = self.detector
        if self.last_update is not None:
            detector = detector.predict(seconds(middle - self.last_update))
        detector = detector.update(beams, grid, steering_error)
        found = None if self.crowded else detector.believed(grid.width)
        if found is None:
            return replace(fresh, detector=detector), ()
        return fresh, (_started(found, next_id, seconds(estimates.stamp - middle)),)

    def _angles_of(
        self, tracked: FloatArray, estimates: SubspaceEstimates, grid: BeamGrid
    ) -> FloatArray:
        """Return where the tracks are during the covariances: three angles each, rad."""
        ages = [seconds(each - estimates.stamp) for each in (self.middles[0], self.middles[-1])]
        first, last = (tracked[:, 0] + age * tracked[:, 1] for age in ages)
        middle, half = 0.5 * (first + last), 0.5 * np.abs(last - first)
        least = _LEAST_TURN * grid.width / np.maximum(np.cos(middle), _LEAST_TURN)
        aside = np.maximum(half, least)
        return np.concatenate([middle, middle - aside, middle + aside])


def _started(found: FaintSource, name: int, age: float) -> StartedTrack:
    """Return the track of a source at the stamp of an estimate, so long after its middle."""
    move = transition_matrix(age)
    covariance = np.asarray(move @ found.covariance @ move.T, dtype=np.float64)
    return StartedTrack(name, move @ found.mean, covariance, found.excess)
