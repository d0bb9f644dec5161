"""Position tracks over time: one history a track."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from sonar_tracking.records.arrays import BoolArray, FloatArray, IntArray
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import COLUMNS, PositionTracks
from sonar_tracking.records.time import seconds

GAP = 3.0
"""Intervals between rows that are longer than the usual one by this factor are gaps."""


@dataclass(frozen=True)
class PositionHistory:
    """One track over time.

    Attributes
    ----------
    tracks : PositionTracks
        A row an instant instead of a row a track: the columns mean what they mean there.
    stamps : ndarray of int, shape (n,)
        Instant of each row, ns, ascending.
    """

    tracks: PositionTracks
    stamps: IntArray

    @property
    def id(self) -> int:
        """Identifier of the track."""
        return int(self.tracks.id[0])

    @property
    def positions(self) -> FloatArray:
        """Positions, shape (n, 2), m."""
        return self.tracks.state[:, :2]

    def positions_with_gaps(self) -> FloatArray:
        """Return the positions, shape (n, 2), m; NaN where a line would bridge a time without."""
        positions = self.positions.copy()
        intervals = np.diff(self.stamps)
        if len(intervals):
            positions[:-1][intervals > GAP * np.median(intervals)] = np.nan
        return positions

    def seconds(self, start: int) -> FloatArray:
        """Return the time of each row since a stamp (ns), shape (n_rows,), s."""
        return np.asarray(seconds(self.stamps - start), np.float64)


def position_histories(lists: Iterable[PositionTracks]) -> tuple[PositionHistory, ...]:
    """Return the tracks of successive pictures, by identifier, while they claim a target.

    Parameters
    ----------
    lists : iterable of PositionTracks
        In order of their stamps; of each the tracks count that are confirmed or coast, at a
        position that is known.
    """
    return _histories(_placed(picture, picture.established) for picture in lists)


def open_histories(lists: Iterable[PositionTracks]) -> tuple[PositionHistory, ...]:
    """Return the positions of bearing tracks that do not claim a target yet.

    Such are the two sides of a line array and solutions whose range is open; a tracker of contacts
    has thousands of tentative tracks, which are of no interest here.

    Parameters
    ----------
    lists : iterable of PositionTracks
        In order of their stamps.
    """
    return _histories(
        _placed(
            picture, (picture.status == TrackStatus.TENTATIVE) & (picture.bearing_track_id != 0)
        )
        for picture in lists
    )


def _histories(lists: Iterable[PositionTracks]) -> tuple[PositionHistory, ...]:
    pictures = [picture for picture in lists if len(picture)]
    if not pictures:
        return ()
    columns: dict[str, Any] = {
        name: np.concatenate([getattr(picture, name) for picture in pictures])
        for name, column in COLUMNS.items()
        if column.key == "id"
    }
    stamps = np.repeat([picture.stamp for picture in pictures], [len(p) for p in pictures])
    order = np.argsort(columns["id"], kind="stable")
    ends = np.flatnonzero(np.diff(columns["id"][order])) + 1
    return tuple(
        PositionHistory(
            PositionTracks(
                stamp=int(stamps[rows[-1]]),
                **{name: values[rows] for name, values in columns.items()},
            ),
            stamps[rows],
        )
        for rows in np.split(order, ends)
    )


def _placed(picture: PositionTracks, keep: BoolArray) -> PositionTracks:
    return picture.selected(keep & np.all(np.isfinite(picture.state[:, :2]), axis=-1))
