"""Score of bearing tracks against the true bearings of a run.

Only confirmed and coasted tracks count. In each period they are assigned to the truths by the
least sum of squared distances, cut off at 5 degrees; everything else follows from that.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.evaluation.metrics.bearing_truth import BearingTruth, TrueBearings
from sonar_tracking.evaluation.metrics.identity_score import (
    IdentityScore,
    IdentityTally,
    scored_period,
)
from sonar_tracking.evaluation.metrics.online_score import OnlineScore
from sonar_tracking.evaluation.metrics.ospa_gospa import assign, gospa, ospa
from sonar_tracking.evaluation.metrics.score_statistics import (
    Column,
    NormalisedErrors,
    flat_mapping,
    mean,
    median,
    nees_band,
)
from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import IndexArray
from sonar_tracking.records.bearings import BearingTracks

CUTOFF_DEG = 5.0
ORDER = 2.0


@dataclass(frozen=True)
class BearingScore:
    """Score of one run.

    Attributes
    ----------
    periods, unscored_periods : int
        Track lists that were scored, and those that lie outside the truth.
    targets : int
        Number of different targets.
    period : float
        Between track lists (median), s.
    rmse_deg, median_error_deg : float
        Of all assigned pairs, deg.
    ospa_deg, gospa_deg : float
        Mean over the periods; cut-off 5 deg, order 2.
    nees_per_dimension, nees_band : float, tuple of float
        Mean normalised estimation error squared of angle and rate, per dimension (1 is
        consistent), and the chi-square 95 % band of a single independent pair; NaN where the
        tracks report no covariance.
    nees_median_per_dimension : float
        Median of the same; 0.69 is consistent.
    identities : IdentityScore
        Swaps, losses, false tracks, continuity, delay.
    """

    periods: int
    unscored_periods: int
    targets: int
    period: float
    rmse_deg: float
    median_error_deg: float
    ospa_deg: float
    gospa_deg: float
    nees_per_dimension: float
    nees_median_per_dimension: float
    nees_band: tuple[float, float]
    identities: IdentityScore

    def to_mapping(self) -> dict[str, object]:
        """Return the score as one flat mapping for JSON; unknown is None."""
        return flat_mapping(self)


def score_bearing_tracks(
    truth: Sequence[BearingTracks], tracks: Sequence[BearingTracks]
) -> BearingScore:
    """Score the tracks of a run.

    Parameters
    ----------
    truth : sequence of BearingTracks
        True bearings, at any stamps; they are interpolated.
    tracks : sequence of BearingTracks
        The tracker's lists, one a period.
    """
    online = OnlineBearingScore(BearingTruth(truth))
    online.add_all(tracks)
    return online.score()


class OnlineBearingScore(OnlineScore[BearingTracks]):
    """Scores the tracks of a run while it goes on; see :func:`score_bearing_tracks`."""

    def __init__(self, truth: BearingTruth | None = None) -> None:
        self._truth = truth or BearingTruth()
        super().__init__(self._truth)
        self._identities = IdentityTally()
        self._ospa, self._gospa, self._error = (Column() for _ in range(3))
        self._nees = NormalisedErrors()

    def count(self, tracks: BearingTracks, truth: TrueBearings) -> None:
        """Count one list, against what is true at its stamp."""
        rows = _established(tracks)
        error = wrap_angle(tracks.arrival_angle[rows] - truth.angle[:, None])
        apart = np.degrees(np.abs(error))
        assignment = assign(apart, CUTOFF_DEG, ORDER)
        pairs = assignment.truths, assignment.estimates
        self._identities.add(
            scored_period(tracks.stamp, truth.id, tracks.id[rows], assignment, apart < CUTOFF_DEG)
        )
        self._ospa.add([ospa(assignment, CUTOFF_DEG, ORDER)])
        self._gospa.add([gospa(assignment, CUTOFF_DEG, ORDER)])
        self._error.add(apart[pairs])
        held = rows[pairs[1]]
        rate_error = tracks.arrival_angle_rate[held] - truth.rate[pairs[0]]
        both = np.stack([error[pairs], rate_error], axis=-1)
        self._nees.add(both, tracks.covariance[held])

    def score(self) -> BearingScore:
        """Return the score of all lists; what waits for truth is counted with what is known."""
        self.finish()
        error, nees, period = self._error.values, self._nees.values, self.periods.median()
        return BearingScore(
            periods=self._identities.periods,
            unscored_periods=len(self.periods) - self._identities.periods,
            targets=self._identities.targets,
            period=period,
            rmse_deg=mean(error**2) ** 0.5,
            median_error_deg=median(error),
            ospa_deg=mean(self._ospa.values),
            gospa_deg=mean(self._gospa.values),
            nees_per_dimension=mean(nees) / 2.0,
            nees_median_per_dimension=median(nees) / 2.0,
            nees_band=nees_band(2),
            identities=self._identities.score(period, self._truth.first_seen()),
        )


def _established(entry: BearingTracks) -> IndexArray:
    return np.flatnonzero(entry.established & np.isfinite(entry.arrival_angle))
