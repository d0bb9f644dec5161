"""Two rows of one bearing: which side counts, and under which identity.

A line array hears left and right alike, so that a tracker may give two rows for one target, one on
each side, until own ship's motion tells them apart. Scored are not two tracks but one: **the more
probable side counts** (of two equal ones the row that comes first), because that is what a person
who must choose would take. The pair has one identity, the smaller of both identifiers; whichever
row remains when the other one is dropped keeps it, so that a choice that changes is an error of
position but no swap of identities.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.records.arrays import BoolArray, FloatArray, IdArray, IndexArray
from sonar_tracking.records.positions import PositionTracks, TrackHypothesis


@dataclass(frozen=True)
class SidedTracks:
    """One row a track, whatever the number of its sides.

    Attributes
    ----------
    rows : ndarray of int, shape (n,)
        Row of each track in the picture.
    id : ndarray of uint64, shape (n,)
        Identity of each track.
    other : ndarray of int, shape (n,)
        Row of the other side; -1 = there is none.
    """

    rows: IndexArray
    id: IdArray
    other: IndexArray


class SideChoice:
    """Chooses the side of two-sided tracks, picture after picture."""

    def __init__(self) -> None:
        self._identity: dict[int, int] = {}

    def choose(self, tracks: PositionTracks, rows: IndexArray) -> SidedTracks:
        """Return the rows that count.

        Parameters
        ----------
        tracks : PositionTracks
            The picture.
        rows : ndarray of int, shape (n_candidates,)
            Rows that are candidates, ascending.
        """
        if not self._identity and not tracks.hypothesis.any():
            return SidedTracks(rows, tracks.id[rows], np.full(len(rows), -1, np.intp))
        other = {}
        for first, second in _pairs(tracks, rows):
            self._join(int(tracks.id[first]), int(tracks.id[second]))
            better, worse = (first, second) if _stands(tracks, first, second) else (second, first)
            other[better], other[worse] = worse, -2
        kept = [row for row in rows.tolist() if other.get(row, -1) != -2]
        return SidedTracks(
            rows=np.array(kept, np.intp),
            id=np.array([self._identity_of(int(tracks.id[row])) for row in kept], np.uint64),
            other=np.array([other.get(row, -1) for row in kept], np.intp),
        )

    def _join(self, one: int, another: int) -> None:
        identity = min(self._identity_of(one), self._identity_of(another))
        self._identity[one] = self._identity[another] = identity

    def _identity_of(self, identifier: int) -> int:
        return self._identity.get(identifier, identifier)


def wrong_sides(tracks: PositionTracks, sided: SidedTracks, true_position: FloatArray) -> BoolArray:
    """Return which two-sided tracks stand on the side farther from the nearest truth.

    Parameters
    ----------
    tracks : PositionTracks
        The picture.
    sided : SidedTracks
        The choice made of it.
    true_position : ndarray, shape (n_targets, 2)
        m.

    Returns
    -------
    ndarray of bool, shape (n_two_sided,)
        Empty where there is no truth.
    """
    two_sided = sided.other >= 0
    if not len(true_position) or not two_sided.any():
        return np.empty(0, np.bool_)
    chosen = _nearest(tracks.state[sided.rows[two_sided], :2], true_position)
    rejected = _nearest(tracks.state[sided.other[two_sided], :2], true_position)
    return rejected < chosen


def _pairs(tracks: PositionTracks, rows: IndexArray) -> list[tuple[int, int]]:
    """Return the rows that are left and right of one bearing track, heard by the same sensors."""
    sides: dict[tuple[object, ...], list[int]] = {}
    for row in rows.tolist():
        bearing_track = int(tracks.bearing_track_id[row])
        if bearing_track and tracks.hypothesis[row] != TrackHypothesis.SINGLE:
            key = (int(tracks.source[row]), bearing_track, _contributors(tracks, row))
            sides.setdefault(key, []).append(row)
    both = {TrackHypothesis.LEFT, TrackHypothesis.RIGHT}
    return [
        (group[0], group[1])
        for group in sides.values()
        if len(group) == 2 and {int(tracks.hypothesis[row]) for row in group} == both
    ]


def _contributors(tracks: PositionTracks, row: int) -> frozenset[tuple[str, int]]:
    """Return who a row was made from: stations number their bearing tracks independently."""
    return frozenset(
        (tracks.contributor_sensor[entry], int(tracks.contributor_id[entry]))
        for entry in np.flatnonzero(tracks.contributor_track == row)
    )


def _stands(tracks: PositionTracks, first: int, second: int) -> bool:
    """Tell whether the first row is at least as probable; an unknown probability is the least."""
    probability = np.nan_to_num(tracks.hypothesis_probability[[first, second]], nan=-1.0)
    return bool(probability[0] >= probability[1])


def _nearest(positions: FloatArray, true_position: FloatArray) -> FloatArray:
    apart = np.linalg.norm(positions[:, None, :] - true_position, axis=-1)
    return np.min(apart, axis=-1)
