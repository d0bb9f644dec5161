"""Score of bearing tracks against the true bearings of a run.

Only confirmed and coasted tracks count. In each period they are assigned to the truths by the
least sum of squared distances, cut off at 5 degrees; everything else follows from that.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from sonar_tracking.evaluation.bearing_truth import BearingTruth, TrueBearings
from sonar_tracking.evaluation.identity_score import (
    IdentityScore,
    ScoredPeriod,
    score_identities,
)
from sonar_tracking.evaluation.set_distances import Assignment, assign, gospa, ospa
from sonar_tracking.motion import wrap_angle
from sonar_tracking.passive.records import BearingTracks, TrackStatus

FloatArray = NDArray[np.float64]

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
        values = dataclasses.asdict(self)
        values.update(values.pop("identities"))
        values["nees_band"] = list(self.nees_band)
        return {name: _json_value(value) for name, value in values.items()}


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
        scored.append(_scored_period(entry, rows, reference, assignment, apart))
        ospas.append(ospa(assignment, CUTOFF_DEG, ORDER))
        gospas.append(gospa(assignment, CUTOFF_DEG, ORDER))
        errors.append(apart[pairs])
        nees.append(_nees(entry, rows[pairs[1]], error[pairs], reference.rate[pairs[0]]))

    period = _period(tracks)
    return BearingScore(
        periods=len(scored),
        unscored_periods=len(tracks) - len(scored),
        targets=len({target for entry in scored for target in entry.truth_ids}),
        period=period,
        rmse_deg=_mean(_joined(errors) ** 2) ** 0.5,
        median_error_deg=_median(_joined(errors)),
        ospa_deg=_mean(np.array(ospas)),
        gospa_deg=_mean(np.array(gospas)),
        nees_per_dimension=_mean(_joined(nees)) / 2.0,
        nees_median_per_dimension=_median(_joined(nees)) / 2.0,
        nees_band=(float(chi2.ppf(0.025, 2)) / 2.0, float(chi2.ppf(0.975, 2)) / 2.0),
        identities=score_identities(scored, period, true_bearings.first_seen()),
    )


def _established(entry: BearingTracks) -> NDArray[np.intp]:
    status = np.isin(entry.status, (TrackStatus.CONFIRMED, TrackStatus.COASTED))
    return np.flatnonzero(status & np.isfinite(entry.arrival_angle))


def _scored_period(
    entry: BearingTracks,
    rows: NDArray[np.intp],
    reference: TrueBearings,
    assignment: Assignment,
    apart: FloatArray,
) -> ScoredPeriod:
    track_ids = tuple(int(identifier) for identifier in entry.id[rows])
    truth_ids = tuple(int(identifier) for identifier in reference.id)
    near = np.flatnonzero((apart < CUTOFF_DEG).any(axis=0))
    return ScoredPeriod(
        stamp=entry.stamp,
        truth_ids=truth_ids,
        track_ids=track_ids,
        held={
            truth_ids[row]: track_ids[column]
            for row, column in zip(assignment.truths, assignment.estimates, strict=True)
        },
        near=frozenset(track_ids[column] for column in near),
    )


def _nees(
    entry: BearingTracks, rows: NDArray[np.intp], angle_error: FloatArray, true_rate: FloatArray
) -> FloatArray:
    """Return e^T P^-1 e of angle and rate for the pairs whose covariance is proper."""
    error = np.stack([angle_error, entry.arrival_angle_rate[rows] - true_rate], axis=-1)
    covariance = entry.covariance[rows]
    determinant = (
        covariance[:, 0, 0] * covariance[:, 1, 1] - covariance[:, 0, 1] * covariance[:, 1, 0]
    )
    proper = (determinant > 0.0) & (covariance[:, 0, 0] > 0.0) & np.isfinite(error).all(axis=-1)
    error, covariance = error[proper], covariance[proper]
    return np.sum(error * np.linalg.solve(covariance, error[..., None])[..., 0], axis=-1)


def _period(tracks: Sequence[BearingTracks]) -> float:
    if len(tracks) < 2:
        return 0.0
    return float(np.median(np.diff([entry.stamp for entry in tracks]))) * 1e-9


def _joined(parts: Sequence[FloatArray]) -> FloatArray:
    return np.concatenate(parts) if parts else np.empty(0)


def _mean(values: FloatArray) -> float:
    return float(np.mean(values)) if values.size else math.nan


def _median(values: FloatArray) -> float:
    return float(np.median(values)) if values.size else math.nan


def _json_value(value: object) -> object:
    return None if isinstance(value, float) and math.isnan(value) else value
