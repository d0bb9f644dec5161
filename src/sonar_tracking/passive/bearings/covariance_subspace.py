"""The signal subspace of the block covariance that an estimate carries.

Its rank is that of the source covariance, which is less than the number of targets when some are
coherent: as many eigenvectors as the rank, as many angles as targets. Eigenvectors of the noise
taken for signal would pull the angles anywhere.
"""

from __future__ import annotations

from sonar_tracking.errors import InputError, Notice, Severity
from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    BearingTrackerConfiguration,
)
from sonar_tracking.passive.directions.signal_subspace import SignalSubspace, signal_subspace_of
from sonar_tracking.records.bearings import SubspaceEstimates


def covariance_subspace(
    configuration: BearingTrackerConfiguration,
    estimates: SubspaceEstimates,
    largest_rank: int | None = None,
) -> tuple[SignalSubspace | None, tuple[Notice, ...]]:
    """Return the signal subspace of a block, or None and why there is none.

    Parameters
    ----------
    configuration : BearingTrackerConfiguration
        Parameters of the tracker.
    estimates : SubspaceEstimates
        With or without a covariance.
    largest_rank : int or None
        An estimated rank above it is lowered to it; None = to what leaves an eigenvector of noise.

    Raises
    ------
    InputError
        If the given rank does not fit the array, or the noise covariance is none.
    """
    covariance, n_elements = estimates.covariance, len(estimates.element_positions)
    if configuration.source_rank >= n_elements:
        raise InputError(
            f"source_rank is {configuration.source_rank} but the array has only {n_elements} "
            f"elements; give at most {n_elements - 1}."
        )
    if covariance is None:
        text = "No covariance at this sample time; the tracks are predicted only."
        return None, (Notice(Severity.WARN, "covariance", text),)
    rank = configuration.source_rank or _estimated_rank(estimates)
    if largest_rank is not None and not configuration.source_rank:
        rank = min(rank, largest_rank)
    rank = min(rank, n_elements - 1, estimates.covariance_snapshots - 1)
    if rank < 1 or not covariance.any():
        text = "No source is seen in this covariance; the tracks are predicted only."
        return None, (Notice(Severity.WARN, "rank", text),)
    return signal_subspace_of(estimates, rank), ()


def _estimated_rank(estimates: SubspaceEstimates) -> int:
    """Return the rank found in the covariance, else the number of sources that is assumed."""
    return estimates.rank if estimates.rank >= 0 else estimates.basis.shape[-1]
