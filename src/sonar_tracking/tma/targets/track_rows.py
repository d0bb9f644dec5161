"""The track list of target motion analysis: one row a target, two while its side is open."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import PositionTracks, TrackHypothesis, TrackSource
from sonar_tracking.records.time import NANOSECONDS
from sonar_tracking.tma.targets.followed_target import FollowedTarget, predicted
from sonar_tracking.tma.targets.target_records import TargetSolution
from sonar_tracking.tma.targets.target_solver import LEFT, RIGHT, SINGLE

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
        At the stamp of the list.
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
    state, covariance = predicted(solution, stamp, acceleration)
    return TrackRow(
        id=target.row_of[solution.side],
        status=status,
        state=state,
        covariance=covariance,
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
    contributors = [(index, *one) for index, row in enumerate(rows) for one in row.members]
    targets = [row.target for row in rows]
    solutions = [row.solution for row in rows]
    return PositionTracks(
        stamp=stamp,
        id=np.array([row.id for row in rows], np.uint64),
        status=np.array([row.status for row in rows], np.uint8),
        source=np.full(len(rows), TrackSource.TMA, np.uint8),
        state=np.array([row.state for row in rows]).reshape(-1, 4),
        covariance=np.array([row.covariance for row in rows]).reshape(-1, 4, 4),
        existence_probability=np.array([one.existence_probability for one in targets]),
        initiated=np.array([one.initiated / NANOSECONDS for one in targets]),
        updated=np.array([one.updated / NANOSECONDS for one in targets]),
        observability=np.array([one.observability for one in solutions]),
        hypothesis=np.array([HYPOTHESES[one.side] for one in solutions], np.uint8),
        hypothesis_probability=np.array([one.probability for one in solutions]),
        bearing_track_id=np.array([one.bearing_track_id for one in targets], np.uint64),
        line_track=np.array([line[0] for line in lines], np.uint32),
        line_id=np.array([line[1] for line in lines], np.uint64),
        line_frequency=np.array([line[2] for line in lines]),
        line_frequency_standard_deviation=np.array([line[3] for line in lines]),
        contributor_track=np.array([one[0] for one in contributors], np.uint32),
        contributor_source=np.full(len(contributors), TrackSource.TMA, np.uint8),
        contributor_id=np.array([one[2] for one in contributors], np.uint64),
        contributor_sensor=tuple(one[1] for one in contributors),
        next_stamp=next_stamp,
    )
