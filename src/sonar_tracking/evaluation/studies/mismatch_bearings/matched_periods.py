"""The established tracks of a run and the targets, matched period by period.

All figures of a run are read from this. The lists of all periods are put together first: single
periods hold a few numbers only.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.evaluation.metrics.bearing_score import CUTOFF_DEG, ORDER
from sonar_tracking.evaluation.metrics.bearing_truth import BearingTruth, TrueBearings
from sonar_tracking.evaluation.metrics.ospa_gospa import assign
from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import BoolArray, FloatArray, IntArray
from sonar_tracking.records.bearings import BearingTracks, TrackStatus, established

Pairs = tuple[tuple[int, int], ...]
"""Targets and tracks that belong together, by their places in the lists of a period."""


@dataclass(frozen=True)
class MatchedPeriod:
    """Who is there at one instant, and who is near whom.

    Attributes
    ----------
    stamp : int
        ns.
    targets, tracks : tuple of int
        Identifiers of the targets and of the established tracks.
    first : int
        Place of the first of these tracks among those of all periods.
    apart : tuple of tuple of float
        Of each track, its distance from each target, deg.
    pairs : Pairs
        The assignment of least cost of all that are nearer than the cut-off.
    """

    stamp: int
    targets: tuple[int, ...]
    tracks: tuple[int, ...]
    first: int
    apart: tuple[tuple[float, ...], ...]
    pairs: Pairs

    @property
    def near(self) -> frozenset[int]:
        """Identifiers of the tracks that are nearer to any target than the cut-off."""
        return frozenset(
            track
            for track, apart in zip(self.tracks, self.apart, strict=True)
            if any(each < CUTOFF_DEG for each in apart)
        )


@dataclass(frozen=True)
class MatchedRun:
    """The periods of a run of which the truth is known.

    Attributes
    ----------
    periods : tuple of MatchedPeriod
        In order of time.
    error : ndarray, shape (n_tracks, most_targets, 2)
        Of angle and rate of the established tracks of all periods, rad and rad/s, against each
        target; NaN where there are fewer targets.
    covariance : ndarray, shape (n_tracks, 2, 2)
        What the tracks say of it, rad^2, rad^2/s and rad^2/s^2.
    count_right : ndarray of bool, shape (n_periods,)
        Whether there are as many confirmed tracks as targets.
    """

    periods: tuple[MatchedPeriod, ...]
    error: FloatArray
    covariance: FloatArray
    count_right: BoolArray


def matched_run(truth: BearingTruth, tracks: Sequence[BearingTracks]) -> MatchedRun:
    """Return the established tracks of a run beside the targets.

    Parameters
    ----------
    truth : BearingTruth
        True bearings.
    tracks : sequence of BearingTracks
        The lists of a tracker, in order of time.
    """
    known = [(entry, true) for entry in tracks if (true := truth.at(entry.stamp)) is not None]
    if not known:
        return MatchedRun((), np.empty((0, 0, 2)), np.empty((0, 2, 2)), np.empty(0, dtype=bool))
    lists = [entry for entry, _ in known]
    status = np.concatenate([entry.status for entry in lists])
    angle = np.concatenate([entry.arrival_angle for entry in lists])
    period = np.repeat(np.arange(len(known)), [len(entry.id) for entry in lists])
    confirmed = np.bincount(period[status == TrackStatus.CONFIRMED], minlength=len(known))
    rows = np.flatnonzero(established(status) & np.isfinite(angle))
    rates = np.concatenate([entry.arrival_angle_rate for entry in lists])
    there = period[rows]
    true_angle, true_rate = _columns([true for _, true in known])
    angle_error = wrap_angle(angle[rows, None] - true_angle[there])
    names = np.concatenate([entry.id for entry in lists])[rows].tolist()
    ends = np.searchsorted(there, np.arange(len(known) + 1))
    return MatchedRun(
        periods=_periods(known, ends, names, angle_error),
        error=np.stack([angle_error, rates[rows, None] - true_rate[there]], axis=-1),
        covariance=np.concatenate([entry.covariance for entry in lists])[rows],
        count_right=confirmed == [len(true.id) for _, true in known],
    )


def _columns(truth: Sequence[TrueBearings]) -> tuple[FloatArray, FloatArray]:
    """Return angles and rates of the targets, shape (n_periods, most_targets), NaN = none."""
    most = max(len(each.id) for each in truth)
    columns = np.full((2, len(truth), most), np.nan)
    for row, each in enumerate(truth):
        columns[0, row, : len(each.id)] = each.angle
        columns[1, row, : len(each.id)] = each.rate
    return columns[0], columns[1]


def _periods(
    known: Sequence[tuple[BearingTracks, TrueBearings]],
    ends: IntArray,
    names: Sequence[int],
    error: FloatArray,
) -> tuple[MatchedPeriod, ...]:
    """Return the periods, by where their tracks begin and end among those of all."""
    distances = np.degrees(np.abs(error)).tolist()
    places = ends.tolist()
    periods = []
    for (entry, true), first, end in zip(known, places[:-1], places[1:], strict=True):
        targets = tuple(true.id.tolist())
        apart = tuple(tuple(each[: len(targets)]) for each in distances[first:end])
        periods.append(
            MatchedPeriod(
                entry.stamp, targets, tuple(names[first:end]), first, apart, assigned(apart)
            )
        )
    return tuple(periods)


def assigned(apart: Sequence[Sequence[float]]) -> Pairs:
    """Return targets and tracks that belong together.

    Parameters
    ----------
    apart : sequence of sequence of float
        Of each track, its distance from each target, deg.
    """
    near = [
        (target, track)
        for track, distances in enumerate(apart)
        for target, distance in enumerate(distances)
        if distance < CUTOFF_DEG
    ]
    if len({target for target, _ in near}) == len(near) == len({track for _, track in near}):
        # Nobody is near two others: those near each other are the pairs.
        return tuple(sorted(near))
    pairs = assign(np.array(apart).T, CUTOFF_DEG, ORDER)
    return tuple(zip(pairs.truths.tolist(), pairs.estimates.tolist(), strict=True))
