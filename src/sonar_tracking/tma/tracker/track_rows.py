"""The track list of target motion analysis: one row a target, two while its side is open."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sonar_tracking.filtering.constant_velocity import (
    in_plane,
    process_noise_matrix,
    transition_matrix,
)
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import PositionTracks, TrackHypothesis, TrackSource
from sonar_tracking.records.time import NANOSECONDS
from sonar_tracking.tma.estimators.sensor_frame import VERTICAL
from sonar_tracking.tma.estimators.vertical_prediction import predict_vertical
from sonar_tracking.tma.targets.array_sides import LEFT, RIGHT, SINGLE
from sonar_tracking.tma.targets.followed_target import FollowedTarget
from sonar_tracking.tma.targets.target_records import TargetSolution

HYPOTHESES = {
    SINGLE: TrackHypothesis.SINGLE,
    LEFT: TrackHypothesis.LEFT,
    RIGHT: TrackHypothesis.RIGHT,
}


@dataclass(frozen=True)
class TrackRow:
    """One row.

    Attributes
    ----------
    id : int
        Identifier of the row.
    status : TrackStatus
        Its status.
    state, covariance : ndarray, shapes (4,) and (4, 4)
        At the stamp of the list, m and m/s; m^2, m^2/s, m^2/s^2.
    z, z_standard_deviation : float
        Then, m; NaN = unknown, and not estimated.
    solution : TargetSolution
        What it shows.
    target : FollowedTarget
        Whose.
    members : tuple of (str, int)
        Stations and their bearing tracks.
    """

    id: int
    status: TrackStatus
    state: FloatArray
    covariance: FloatArray
    z: float
    z_standard_deviation: float
    solution: TargetSolution
    target: FollowedTarget
    members: tuple[tuple[str, int], ...]


def track_row(
    target: FollowedTarget,
    solution: TargetSolution,
    status: TrackStatus,
    stamp: int,
    acceleration: float,
) -> TrackRow:
    """Return the row of a solution at the stamp of the list."""
    state, covariance = _predict(solution, stamp, acceleration)
    if status == TrackStatus.COASTED and (target.members or target.forsaken):
        covariance = covariance + stopped(state, (stamp - target.updated) / NANOSECONDS)
    z, deviation = _height(target, solution, stamp)
    return TrackRow(
        id=target.row_of[solution.side],
        status=status,
        state=state,
        covariance=covariance,
        z=z,
        z_standard_deviation=deviation,
        solution=solution,
        target=target,
        members=tuple(target.members.items()),
    )


def track_list(rows: Sequence[TrackRow], stamp: int, next_stamp: int) -> PositionTracks:
    """Return the complete picture.

    Parameters
    ----------
    rows : sequence of TrackRow
        In the order of the list.
    stamp, next_stamp : int
        Of the list, ns.
    """
    return PositionTracks(
        stamp=stamp,
        id=np.array([row.id for row in rows], np.uint64),
        status=np.array([row.status for row in rows], np.uint8),
        source=np.full(len(rows), TrackSource.TMA, np.uint8),
        state=np.array([row.state for row in rows]).reshape(-1, 4),
        covariance=np.array([row.covariance for row in rows]).reshape(-1, 4, 4),
        z=np.array([row.z for row in rows]),
        z_standard_deviation=np.array([row.z_standard_deviation for row in rows]),
        next_stamp=next_stamp,
        **_target_columns([row.target for row in rows]),
        **_solution_columns([row.solution for row in rows]),
        **_line_columns(rows),
        **_contributor_columns(rows),
    )


def _target_columns(targets: Sequence[FollowedTarget]) -> dict[str, Any]:
    return {
        "existence_probability": np.array([one.existence_probability for one in targets]),
        "initiated": np.array([one.initiated / NANOSECONDS for one in targets]),
        "updated": np.array([one.updated / NANOSECONDS for one in targets]),
        "bearing_track_id": np.array([one.bearing_track_id for one in targets], np.uint64),
    }


def _solution_columns(solutions: Sequence[TargetSolution]) -> dict[str, Any]:
    return {
        "observability": np.array([one.observability for one in solutions]),
        "hypothesis": np.array([HYPOTHESES[one.side] for one in solutions], np.uint8),
        "hypothesis_probability": np.array([one.probability for one in solutions]),
    }


def _line_columns(rows: Sequence[TrackRow]) -> dict[str, Any]:
    """Return the lines that were ever heard, of all rows."""
    lines = [
        (index, number, frequency, deviation)
        for index, row in enumerate(rows)
        for (_, number), frequency, deviation in zip(
            row.solution.line_ids,
            row.solution.source_frequency,
            row.solution.source_frequency_deviation,
            strict=True,
        )
        if frequency > 0.0
    ]
    return {
        "line_track": np.array([line[0] for line in lines], np.uint32),
        "line_id": np.array([line[1] for line in lines], np.uint64),
        "line_frequency": np.array([line[2] for line in lines]),
        "line_frequency_standard_deviation": np.array([line[3] for line in lines]),
    }


def _contributor_columns(rows: Sequence[TrackRow]) -> dict[str, Any]:
    contributors = [(index, *one) for index, row in enumerate(rows) for one in row.members]
    return {
        "contributor_track": np.array([one[0] for one in contributors], np.uint32),
        "contributor_source": np.full(len(contributors), TrackSource.TMA, np.uint8),
        "contributor_id": np.array([one[2] for one in contributors], np.uint64),
        "contributor_sensor": tuple(one[1] for one in contributors),
    }


def _height(target: FollowedTarget, solution: TargetSolution, stamp: int) -> tuple[float, float]:
    """Return the height at a stamp and its standard deviation; what is assumed has none."""
    if solution.spatial is None:
        return target.assumed_z, np.nan
    elapsed = np.array((stamp - solution.stamp) / NANOSECONDS)
    mean, covariance = predict_vertical(solution.spatial.mean, solution.spatial.covariance, elapsed)
    return float(mean[-VERTICAL]), float(np.sqrt(covariance[-VERTICAL, -VERTICAL]))


def stopped(state: FloatArray, silent: float) -> FloatArray:
    """Return the covariance of what a target that is silent for so long may have done.

    What is not heard any more may have stopped its engines: its velocity differs from what it was
    by as much as that, in whatever direction.

    Parameters
    ----------
    state : ndarray, shape (4,)
        x, y, vx, vy, m and m/s.
    silent : float
        s.

    Returns
    -------
    ndarray, shape (4, 4)
        In units of the state squared.
    """
    change = float(state[2:] @ state[2:]) / 2.0
    along = np.array([[silent**2, silent], [silent, 1.0]])
    return np.asarray(change * np.kron(along, np.eye(2)))


def _predict(
    solution: TargetSolution, stamp: int, acceleration: float
) -> tuple[FloatArray, FloatArray]:
    """Return mean and covariance of a solution at a stamp not before its own."""
    interval = (stamp - solution.stamp) / NANOSECONDS
    if interval <= 0.0:
        return solution.mean, solution.covariance
    transition = in_plane(transition_matrix(interval))
    noise = in_plane(process_noise_matrix(acceleration**2, interval))
    covariance = transition @ solution.covariance @ transition.T + noise
    return transition @ solution.mean, covariance
