"""Score of bearing tracks against the true bearings of a run.

Only confirmed and coasted tracks count. In each period they are assigned to the truths by the
least sum of squared distances, cut off at 5 degrees; everything else follows from that.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.evaluation.metrics.bearing_truth import BearingTruth
from sonar_tracking.evaluation.metrics.identity_score import (
    IdentityScore,
    ScoredPeriod,
    score_identities,
    scored_period,
)
from sonar_tracking.evaluation.metrics.ospa_gospa import assign, gospa, ospa
from sonar_tracking.evaluation.metrics.score_statistics import (
    flat_mapping,
    joined,
    mean,
    median,
    median_period,
    nees_band,
    normalised_square_error,
)
from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import FloatArray, IndexArray
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
    true_bearings = BearingTruth(truth)
    tracks = sorted(tracks, key=lambda entry: entry.stamp)
    scored: list[ScoredPeriod] = []
    ospas: list[float] = []
    gospas: list[float] = []
    errors: list[FloatArray] = []
    nees: list[FloatArray] = []
    for entry in tracks:
        reference = true_bearings.at(entry.stamp)
        if reference is None:
            continue
        rows = _established(entry)
        error = wrap_angle(entry.arrival_angle[rows] - reference.angle[:, None])
        apart = np.degrees(np.abs(error))
        assignment = assign(apart, CUTOFF_DEG, ORDER)
        pairs = assignment.truths, assignment.estimates
        scored.append(
            scored_period(entry.stamp, reference.id, entry.id[rows], assignment, apart < CUTOFF_DEG)
        )
        ospas.append(ospa(assignment, CUTOFF_DEG, ORDER))
        gospas.append(gospa(assignment, CUTOFF_DEG, ORDER))
        errors.append(apart[pairs])
        held = rows[pairs[1]]
        rate_error = entry.arrival_angle_rate[held] - reference.rate[pairs[0]]
        both = np.stack([error[pairs], rate_error], axis=-1)
        nees.append(normalised_square_error(both, entry.covariance[held]))

    period = median_period(tracks)
    return BearingScore(
        periods=len(scored),
        unscored_periods=len(tracks) - len(scored),
        targets=len({target for entry in scored for target in entry.truth_ids}),
        period=period,
        rmse_deg=mean(joined(errors) ** 2) ** 0.5,
        median_error_deg=median(joined(errors)),
        ospa_deg=mean(np.array(ospas)),
        gospa_deg=mean(np.array(gospas)),
        nees_per_dimension=mean(joined(nees)) / 2.0,
        nees_median_per_dimension=median(joined(nees)) / 2.0,
        nees_band=nees_band(2),
        identities=score_identities(scored, period, true_bearings.first_seen()),
    )


def _established(entry: BearingTracks) -> IndexArray:
    return np.flatnonzero(entry.established & np.isfinite(entry.arrival_angle))
