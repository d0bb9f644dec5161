"""The interface of the filters behind the bearing tracker: frozen state in, frozen state out.

What the stage sees are targets with angle and rate each, ``KalmanState`` of shapes (..., n, 2) and
(..., n, 2, 2), in rad and rad/s; how the filters of all targets are kept together is a matter of
their own.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, TypeVar

from sonar_tracking.errors import Notice
from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.passive.bearings.bearing_measurement import BearingMeasurement
from sonar_tracking.passive.directions.signal_subspace import SignalSubspace
from sonar_tracking.records.arrays import BoolArray, ComplexArray, FloatArray, IndexArray
from sonar_tracking.records.bearings import SubspaceEstimates

FilterState = TypeVar("FilterState", bound=KalmanState)


@dataclass(frozen=True)
class FilterUpdate:
    """What one estimate made of the filters.

    Attributes
    ----------
    filters : KalmanState
        After the estimate; as before if there was no measurement.
    measurement : BearingMeasurement or None
        What the estimate says of each target; None = nothing.
    notices : tuple of Notice
        Why there was no measurement.
    subspace : SignalSubspace or None
        Of the covariance, where it was measured in that.
    """

    filters: KalmanState
    measurement: BearingMeasurement | None
    notices: tuple[Notice, ...] = ()
    subspace: SignalSubspace | None = None


class BearingFilters(Protocol[FilterState]):
    """The filters of all targets, whose state may be more than angles and rates."""

    def start(self, targets: KalmanState) -> FilterState:
        """Return the filters of uncorrelated targets, shapes (..., n, 2) and (..., n, 2, 2)."""
        ...

    def extend(self, filters: FilterState, targets: KalmanState) -> FilterState:
        """Return the filters with more targets, uncorrelated with those there are."""
        ...

    def keep(self, filters: FilterState, rows: IndexArray) -> FilterState:
        """Return the filters of some of the targets, by their rows, shape (n_kept,)."""
        ...

    def predict(self, filters: FilterState, interval: float) -> FilterState:
        """Return the filters after an interval in s."""
        ...

    def update(
        self,
        filters: FilterState,
        estimates: SubspaceEstimates,
        sources: ComplexArray | None,
        excess: FloatArray | None = None,
    ) -> FilterUpdate:
        """Measure every target, of one at least, and return the filters after it.

        Parameters
        ----------
        filters : KalmanState
            Predicted to the stamp of the estimate.
        estimates : SubspaceEstimates
            What was measured.
        sources : ndarray, shape (..., n_targets, n_targets), complex, or None
            Covariance of the sources at the predictions, linear power; None = not known.
        excess : ndarray, shape (..., n_targets), optional
            Power of each faint source in its beam, over that of the noise, pure numbers; NaN = not
            faint. Given if there is one, and only to methods that hold them.
        """
        ...

    def coasted(self, filters: FilterState, predicted: FilterState, rows: BoolArray) -> FilterState:
        """Return the filters with some targets, by a mask, shape (..., n), as predicted."""
        ...

    def targets(self, filters: FilterState) -> KalmanState:
        """Return angle and rate of each target, shapes (..., n, 2) and (..., n, 2, 2)."""
        ...
