"""What the bearing tracker remembers between estimates, and what it gives at each of them."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

from sonar_tracking.errors import Notice
from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.passive.bearings.bearing_filters import BearingFilters
from sonar_tracking.passive.bearings.bearing_track_list import BearingTrackRows
from sonar_tracking.passive.bearings.steering_uncertainty import SteeringUncertainty
from sonar_tracking.passive.track_start.bearing_start import BearingStart
from sonar_tracking.passive.track_start.faint_start import FaintStart
from sonar_tracking.records.arrays import FloatArray, IndexArray
from sonar_tracking.records.bearings import BearingTracks


@dataclass(frozen=True)
class TrackerUpdate:
    """What one subspace estimate gave.

    Attributes
    ----------
    tracks : BearingTracks
        The complete picture at the stamp of the estimate.
    notices : tuple of Notice
        What a user should know about the estimate.
    """

    tracks: BearingTracks
    notices: tuple[Notice, ...]


@dataclass(frozen=True)
class TrackerState:
    """Everything the tracker remembers between estimates.

    Attributes
    ----------
    stamp : int
        Of the last estimate, ns.
    ids : tuple of int
        Identifiers of the running tracks.
    filters : KalmanState
        Of all running tracks together.
    start : BearingStart
        Tracks that have not started yet.
    existence : ndarray, shape (n_tracks,)
        Probabilities of existence; NaN = not estimated.
    excess : ndarray, shape (n_tracks,)
        Power of each faint source in its beam, over that of the noise, pure numbers; NaN = not
        faint.
    faint : FaintStart
        Faint sources that have no track yet.
    steering : SteeringUncertainty
        What the array differs from its description.
    ended : tuple of BearingTrackRows
        Tracks that an operator has ended, which are to be reported once more.
    """

    stamp: int
    ids: tuple[int, ...]
    filters: KalmanState
    start: BearingStart
    existence: FloatArray
    excess: FloatArray
    faint: FaintStart = field(default_factory=FaintStart)
    steering: SteeringUncertainty = field(default_factory=SteeringUncertainty)
    ended: tuple[BearingTrackRows, ...] = ()

    def keep(self, filters: BearingFilters[Any], rows: IndexArray) -> TrackerState:
        """Return the state with some of the tracks only.

        Parameters
        ----------
        filters : BearingFilters
            That the state is of.
        rows : ndarray of int, shape (n_kept,)
            Tracks to keep.
        """
        ids = tuple(self.ids[row] for row in rows)
        kept = filters.keep(self.filters, rows)
        return replace(
            self,
            ids=ids,
            filters=kept,
            existence=self.existence[rows],
            excess=self.excess[rows],
        )
