"""Score of position tracks against the true positions of a run.

Only confirmed and coasted tracks whose position is known count. In each period they are assigned
to the truths by the least sum of squared distances, cut off at 200 m unless told otherwise;
everything else follows from that. Truth is taken at the stamp of the tracks, the instant their
states refer to (a tracker that must reckon with travel time does so before it publishes), and
interpolated between its samples. The two sides of one ambiguous bearing count as one track:
:mod:`sonar_tracking.evaluation.metrics.track_sides`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.evaluation.metrics.cutoff import CUTOFF_M, FAR_LIMIT_M
from sonar_tracking.evaluation.metrics.identity_score import (
    IdentityScore,
    IdentityTally,
    scored_period,
)
from sonar_tracking.evaluation.metrics.online_score import OnlineScore
from sonar_tracking.evaluation.metrics.ospa_gospa import assign, gospa, ospa
from sonar_tracking.evaluation.metrics.position_truth import PositionTruth, TruePositions
from sonar_tracking.evaluation.metrics.score_statistics import (
    Column,
    flat_mapping,
    mean,
    median,
    nees_band,
    normalised_square_error,
)
from sonar_tracking.evaluation.metrics.track_sides import SideChoice, wrong_sides
from sonar_tracking.records.arrays import FloatArray, IndexArray
from sonar_tracking.records.positions import PositionTracks

ORDER = 2.0
STATES = 4
"""Dimension of a state: x, y, vx, vy."""

NORMALISED_AT_ONCE = 100
"""Lists whose errors are brought into units of their covariances together."""


@dataclass(frozen=True)
class PositionScore:
    """Score of one run.

    Attributes
    ----------
    periods, unscored_periods : int
        Track lists that were scored, and those that lie outside the truth.
    targets : int
        Number of different targets.
    period : float
        Between track lists (median), s.
    cutoff_m : float
        Distance from which on a track is none of a target, m.
    rmse_m, median_error_m : float
        Distance of all assigned pairs, m.
    velocity_rmse_m_per_s : float
        Of the velocity vectors of all assigned pairs, m/s.
    height_rmse_m, height_nees : float
        Error of the height of all assigned pairs, m, and its mean square in units of the variance
        (1 is consistent); NaN where no track estimates one that is known.
    median_nearest_m : float
        Median distance from a target to the nearest track, whatever the cut-off, over all periods
        of all targets in which there is a track; it tells how far off tracks are that were not
        assigned, m.
    far_limit_m : float
        Distance from the nearest target beyond which a row is far off, m.
    far_share : float
        Share of the rows of all periods that are far off, whatever the cut-off; rows of a period
        without targets are.
    ospa_m, gospa_m : float
        Mean over the periods, order 2.
    nees_per_dimension, nees_median_per_dimension, nees_band : float, float, tuple of float
        Normalised estimation error squared of the state of the assigned pairs, per dimension: mean
        (1 is consistent), median (0.84 is) and the chi-square 95 % band of a single independent
        pair; NaN where the tracks report no covariance.
    two_sided_share : float
        Share of the tracks of all periods whose side of the array was open.
    wrong_side_share : float
        Of these the share whose less probable side was closer to the nearest target.
    identities : IdentityScore
        Swaps, losses, false tracks, continuity, delay.
    """

    periods: int
    unscored_periods: int
    targets: int
    period: float
    cutoff_m: float
    rmse_m: float
    median_error_m: float
    velocity_rmse_m_per_s: float
    height_rmse_m: float
    height_nees: float
    median_nearest_m: float
    far_limit_m: float
    far_share: float
    ospa_m: float
    gospa_m: float
    nees_per_dimension: float
    nees_median_per_dimension: float
    nees_band: tuple[float, float]
    two_sided_share: float
    wrong_side_share: float
    identities: IdentityScore

    def to_mapping(self) -> dict[str, object]:
        """Return the score as one flat mapping for JSON; unknown is None."""
        return flat_mapping(self)


def score_position_tracks(
    truth: Sequence[PositionTracks],
    tracks: Sequence[PositionTracks],
    cutoff_m: float = CUTOFF_M,
    far_limit_m: float = FAR_LIMIT_M,
) -> PositionScore:
    """Score the tracks of a run.

    Parameters
    ----------
    truth : sequence of PositionTracks
        True states, at any stamps; they are interpolated.
    tracks : sequence of PositionTracks
        The tracker's lists, one a period.
    cutoff_m : float
        Distance from which on a track is none of a target, m, positive.
    far_limit_m : float
        Distance from the nearest target beyond which a row is far off, m, positive.

    Returns
    -------
    PositionScore
        Definitions: :mod:`sonar_tracking.evaluation.metrics.ospa_gospa` and
        :mod:`sonar_tracking.evaluation.metrics.identity_score`.
    """
    online = OnlinePositionScore(cutoff_m, PositionTruth(truth), far_limit_m)
    online.add_all(tracks)
    return online.score()


class OnlinePositionScore(OnlineScore[PositionTracks]):
    """Scores the tracks of a run while it goes on; see :func:`score_position_tracks`."""

    def __init__(
        self,
        cutoff_m: float = CUTOFF_M,
        truth: PositionTruth | None = None,
        far_limit_m: float = FAR_LIMIT_M,
    ) -> None:
        self._truth = truth or PositionTruth()
        super().__init__(self._truth)
        self._cutoff_m, self._far_limit_m = cutoff_m, far_limit_m
        self._choice = SideChoice()
        self._identities = IdentityTally()
        self._ospa, self._gospa, self._nees = Column(), Column(), Column()
        self._distance, self._speed_error, self._nearest = Column(), Column(), Column()
        self._far = Column()
        self._height, self._height_nees = Column(), Column()
        self._two_sided, self._wrong_side = Column(), Column()
        self._errors: list[tuple[FloatArray, FloatArray]] = []

    def count(self, tracks: PositionTracks, truth: TruePositions) -> None:
        """Count one list, against what is true at its stamp."""
        cutoff = self._cutoff_m
        sided = self._choice.choose(tracks, _established(tracks))
        error = tracks.state[sided.rows] - truth.state[:, None, :]
        apart = np.sqrt(error[..., 0] ** 2 + error[..., 1] ** 2)
        assignment = assign(apart, cutoff, ORDER)
        pairs = assignment.truths, assignment.estimates
        self._identities.add(
            scored_period(tracks.stamp, truth.id, sided.id, assignment, apart < cutoff)
        )
        self._ospa.add([ospa(assignment, cutoff, ORDER)])
        self._gospa.add([gospa(assignment, cutoff, ORDER)])
        self._distance.add(apart[pairs])
        self._count_heights(tracks, truth, sided.rows[assignment.estimates], assignment.truths)
        self._nearest.add(np.min(apart, axis=1) if apart.shape[1] else ())
        self._far.add(np.min(apart, axis=0, initial=np.inf) > self._far_limit_m)
        covariance = tracks.covariance[sided.rows[assignment.estimates]]
        self._errors.append((error[pairs], covariance))
        if len(self._errors) == NORMALISED_AT_ONCE:
            self._normalise()
        self._two_sided.add(sided.other >= 0)
        self._wrong_side.add(wrong_sides(tracks, sided, truth.state[:, :2]))

    def _count_heights(
        self, tracks: PositionTracks, truth: TruePositions, rows: IndexArray, of: IndexArray
    ) -> None:
        """Count the heights that are estimated, of rows assigned to targets."""
        error, deviation = tracks.z[rows] - truth.z[of], tracks.z_standard_deviation[rows]
        known = np.isfinite(error) & np.isfinite(deviation)
        self._height.add(error[known])
        self._height_nees.add((error[known] / deviation[known]) ** 2)

    def score(self) -> PositionScore:
        """Return the score of all lists; what waits for truth is counted with what is known."""
        self.finish()
        self._normalise()
        period, nees = self.periods.median(), self._nees.values / STATES
        return PositionScore(
            periods=self._identities.periods,
            unscored_periods=len(self.periods) - self._identities.periods,
            targets=self._identities.targets,
            period=period,
            cutoff_m=float(self._cutoff_m),
            rmse_m=mean(self._distance.values**2) ** 0.5,
            median_error_m=median(self._distance.values),
            velocity_rmse_m_per_s=mean(self._speed_error.values**2) ** 0.5,
            height_rmse_m=mean(self._height.values**2) ** 0.5,
            height_nees=mean(self._height_nees.values),
            median_nearest_m=median(self._nearest.values),
            far_limit_m=float(self._far_limit_m),
            far_share=mean(self._far.values),
            ospa_m=mean(self._ospa.values),
            gospa_m=mean(self._gospa.values),
            nees_per_dimension=mean(nees),
            nees_median_per_dimension=median(nees),
            nees_band=nees_band(STATES),
            two_sided_share=mean(self._two_sided.values),
            wrong_side_share=mean(self._wrong_side.values),
            identities=self._identities.score(period, self._truth.first_seen()),
        )

    def _normalise(self) -> None:
        """Count the errors of the last lists in units of their covariances."""
        if self._errors:
            error, covariance = map(np.concatenate, zip(*self._errors, strict=True))
            self._nees.add(normalised_square_error(error, covariance))
            speed_error = np.linalg.norm(error[:, 2:], axis=-1)
            self._speed_error.add(speed_error[np.isfinite(speed_error)])
            self._errors.clear()


def _established(entry: PositionTracks) -> IndexArray:
    """Return the rows that claim a target, at a position that is known."""
    known = np.all(np.isfinite(entry.state[:, :2]), axis=-1)
    return np.flatnonzero(entry.established & known)
