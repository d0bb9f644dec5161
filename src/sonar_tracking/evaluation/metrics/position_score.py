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

from sonar_tracking.evaluation.metrics.cutoff import CUTOFF_M
from sonar_tracking.evaluation.metrics.identity_score import (
    IdentityScore,
    ScoredPeriod,
    score_identities,
    scored_period,
)
from sonar_tracking.evaluation.metrics.ospa_gospa import assign, gospa, ospa
from sonar_tracking.evaluation.metrics.position_truth import PositionTruth, TruePositions
from sonar_tracking.evaluation.metrics.score_statistics import (
    flat_mapping,
    joined,
    mean,
    median,
    median_period,
    nees_band,
    normalised_square_error,
)
from sonar_tracking.evaluation.metrics.track_sides import SideChoice, wrong_sides
from sonar_tracking.records.arrays import BoolArray, FloatArray, IndexArray
from sonar_tracking.records.positions import PositionTracks

ORDER = 2.0
STATES = 4
"""Dimension of a state: x, y, vx, vy."""


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
    median_nearest_m : float
        Median distance from a target to the nearest track, whatever the cut-off, over all periods
        of all targets in which there is a track; it tells how far off tracks are that were not
        assigned, m.
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
    median_nearest_m: float
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


@dataclass(frozen=True)
class _Period:
    """What one track list contributes."""

    scored: ScoredPeriod
    ospa: float
    gospa: float
    distance: FloatArray
    speed_error: FloatArray
    nearest: FloatArray
    nees: FloatArray
    two_sided: BoolArray
    wrong_side: BoolArray


def score_position_tracks(
    truth: Sequence[PositionTracks],
    tracks: Sequence[PositionTracks],
    cutoff_m: float = CUTOFF_M,
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

    Returns
    -------
    PositionScore
        Definitions: :mod:`sonar_tracking.evaluation.metrics.ospa_gospa` and
        :mod:`sonar_tracking.evaluation.metrics.identity_score`.
    """
    true_positions = PositionTruth(truth)
    choice = SideChoice()
    tracks = sorted(tracks, key=lambda entry: entry.stamp)
    parts: list[_Period] = []
    for entry in tracks:
        reference = true_positions.at(entry.stamp)
        if reference is not None:
            parts.append(_scored(entry, reference, choice, cutoff_m))
    period = median_period(tracks)
    scored = [part.scored for part in parts]
    nees = joined([part.nees for part in parts]) / STATES
    return PositionScore(
        periods=len(parts),
        unscored_periods=len(tracks) - len(parts),
        targets=len({target for entry in scored for target in entry.truth_ids}),
        period=period,
        cutoff_m=float(cutoff_m),
        rmse_m=mean(joined([part.distance for part in parts]) ** 2) ** 0.5,
        median_error_m=median(joined([part.distance for part in parts])),
        velocity_rmse_m_per_s=mean(joined([part.speed_error for part in parts]) ** 2) ** 0.5,
        median_nearest_m=median(joined([part.nearest for part in parts])),
        ospa_m=mean([part.ospa for part in parts]),
        gospa_m=mean([part.gospa for part in parts]),
        nees_per_dimension=mean(nees),
        nees_median_per_dimension=median(nees),
        nees_band=nees_band(STATES),
        two_sided_share=mean(joined([part.two_sided.astype(float) for part in parts])),
        wrong_side_share=mean(joined([part.wrong_side.astype(float) for part in parts])),
        identities=score_identities(scored, period, true_positions.first_seen()),
    )


def _scored(
    entry: PositionTracks, reference: TruePositions, choice: SideChoice, cutoff_m: float
) -> _Period:
    sided = choice.choose(entry, _established(entry))
    error = entry.state[sided.rows] - reference.state[:, None, :]
    apart = np.linalg.norm(error[..., :2], axis=-1)
    assignment = assign(apart, cutoff_m, ORDER)
    pairs = assignment.truths, assignment.estimates
    speed_error = np.linalg.norm(error[pairs][:, 2:], axis=-1)
    return _Period(
        scored=scored_period(entry.stamp, reference.id, sided.id, assignment, apart < cutoff_m),
        ospa=ospa(assignment, cutoff_m, ORDER),
        gospa=gospa(assignment, cutoff_m, ORDER),
        distance=apart[pairs],
        speed_error=speed_error[np.isfinite(speed_error)],
        nearest=np.min(apart, axis=1) if apart.shape[1] else np.empty(0),
        nees=normalised_square_error(
            error[pairs], entry.covariance[sided.rows[assignment.estimates]]
        ),
        two_sided=sided.other >= 0,
        wrong_side=wrong_sides(entry, sided, reference.state[:, :2]),
    )


def _established(entry: PositionTracks) -> IndexArray:
    """Return the rows that claim a target, at a position that is known."""
    known = np.all(np.isfinite(entry.state[:, :2]), axis=-1)
    return np.flatnonzero(entry.established & known)
