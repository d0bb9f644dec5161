"""The fused track list: one row a target."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from sonar_tracking.errors import Notice
from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.fusion.fused_target import FusedTarget
from sonar_tracking.fusion.rotation import rotated
from sonar_tracking.motion import KinematicState
from sonar_tracking.records.alignments import ArrayAlignments
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import PositionTracks, TrackHypothesis, TrackSource

Contribution = tuple[TrackSource, str, int]
"""Who made a track that a row is made of, its sensor or list, and its identifier there."""


@dataclass(frozen=True)
class FusedRow:
    """One row.

    Attributes
    ----------
    id : int
        Of the row.
    status : TrackStatus
        Its status.
    source : TrackSource
        FUSED, or STATIC of what is fixed.
    state, covariance : ndarray, shapes (4,) and (4, 4)
        m and m/s; m^2, m^2/s, m^2/s^2.
    existence, initiated, updated, observability, hypothesis_probability : float
        As in :class:`PositionTracks`.
    hypothesis : TrackHypothesis
        Side of a line array.
    bearing_track_id : int
        A bearing track it is made of; 0 = none.
    contributors : tuple of Contribution
        What it is made of.
    z, z_standard_deviation : float
        Of what one list alone tells, m; NaN = unknown.
    """

    id: int
    status: TrackStatus
    source: TrackSource
    state: FloatArray
    covariance: FloatArray
    existence: float
    initiated: float
    updated: float
    observability: float = np.nan
    hypothesis: TrackHypothesis = TrackHypothesis.SINGLE
    hypothesis_probability: float = np.nan
    bearing_track_id: int = 0
    contributors: tuple[Contribution, ...] = ()
    z: float = np.nan
    z_standard_deviation: float = np.nan


@dataclass(frozen=True)
class OwnPicture:
    """What own sensors tell at one instant, before anybody else is asked.

    Attributes
    ----------
    rows : tuple of FusedRow
        One a target.
    tracks : PositionTracks
        The same as a list.
    alignments : ArrayAlignments
        Of all arrays that have been heard of.
    notices : tuple of Notice
        What the user should know of the frame.
    """

    rows: tuple[FusedRow, ...]
    tracks: PositionTracks
    alignments: ArrayAlignments
    notices: tuple[Notice, ...]


def row_of_target(target: FusedTarget, state: FloatArray, covariance: FloatArray) -> FusedRow:
    """Return the row of a target of known motion.

    Parameters
    ----------
    target : FusedTarget
        The target.
    state, covariance : ndarray, shapes (4,) and (4, 4)
        At the stamp of the list, m and m/s; m^2, m^2/s, m^2/s^2.
    """
    echoes = [(TrackSource.ACTIVE, *key) for key in target.echoes]
    heard = [(TrackSource.TMA, *key) for key in target.heard]
    return FusedRow(
        id=target.id,
        status=target.status,
        source=TrackSource.FUSED,
        state=state,
        covariance=covariance,
        existence=target.existence,
        initiated=target.initiated,
        updated=target.updated,
        bearing_track_id=next((key[1] for key in target.heard), 0),
        contributors=(*echoes, *heard),
    )


def turned_by_heading(row: FusedRow, own_ship: KinematicState | None, variance: float) -> FusedRow:
    """Return a row whose covariance has room for an error of own ship's heading.

    Parameters
    ----------
    row : FusedRow
        As the sensors tell.
    own_ship : KinematicState or None
        At the stamp of the list; None = nothing is aboard.
    variance : float
        rad^2.
    """
    if own_ship is None or variance <= 0.0 or not np.all(np.isfinite(row.covariance)):
        return row
    turned = rotated(KalmanState(row.state, row.covariance), own_ship.position, 0.0, variance)
    return replace(row, covariance=turned.covariance)


def fused_list(rows: Sequence[FusedRow], stamp: int, next_stamp: int) -> PositionTracks:
    """Return the complete picture.

    Parameters
    ----------
    rows : sequence of FusedRow
        In the order of the list.
    stamp, next_stamp : int
        Of the list, ns.
    """
    contributors = [(index, *one) for index, row in enumerate(rows) for one in row.contributors]

    def column(name: str, dtype: str = "float64") -> Any:
        return np.array([getattr(row, name) for row in rows], dtype)

    return PositionTracks(
        stamp=stamp,
        id=column("id", "uint64"),
        status=column("status", "uint8"),
        source=column("source", "uint8"),
        state=column("state").reshape(-1, 4),
        covariance=column("covariance").reshape(-1, 4, 4),
        z=column("z"),
        z_standard_deviation=column("z_standard_deviation"),
        existence_probability=column("existence"),
        initiated=column("initiated"),
        updated=column("updated"),
        observability=column("observability"),
        hypothesis=column("hypothesis", "uint8"),
        hypothesis_probability=column("hypothesis_probability"),
        bearing_track_id=column("bearing_track_id", "uint64"),
        contributor_track=np.array([one[0] for one in contributors], np.uint32),
        contributor_source=np.array([one[1] for one in contributors], np.uint8),
        contributor_sensor=tuple(one[2] for one in contributors),
        contributor_id=np.array([one[3] for one in contributors], np.uint64),
        next_stamp=next_stamp,
    )


class ShownRows:
    """The rows of the last list: what is no more appears once in the next one, as terminated."""

    def __init__(self) -> None:
        self._rows: dict[int, FusedRow] = {}
        self._confirmed: dict[int, int] = {}

    def confirmed_since(self, number: int) -> float:
        """Return since when a row has been confirmed, ns; infinite = it is not."""
        return self._confirmed.get(number, math.inf)

    def has(self, number: int) -> bool:
        """Return whether a row was in the last list and goes on."""
        return number in self._rows

    def identifiers(self) -> list[int]:
        """Return the rows of the last list that go on."""
        return sorted(self._rows)

    def listed(self, rows: Sequence[FusedRow], stamp: int, next_stamp: int) -> PositionTracks:
        """Return the complete picture, rows that have ended included; stamps in ns."""
        going_on = {row.id: row for row in rows}
        ended = [row for number, row in self._rows.items() if number not in going_on]
        self._rows = going_on
        established = (TrackStatus.CONFIRMED, TrackStatus.COASTED)
        sure = [row.id for row in rows if row.status in established]
        self._confirmed = {number: self._confirmed.get(number, stamp) for number in sure}
        gone = [replace(row, status=TrackStatus.TERMINATED) for row in ended]
        return fused_list([*rows, *gone], stamp, next_stamp)
