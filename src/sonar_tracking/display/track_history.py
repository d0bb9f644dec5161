"""Tracks as lines over time, and a table of what became of each of them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sonar_tracking.passive.records import BearingTracks, TrackStatus

if TYPE_CHECKING:
    from rich.table import Table

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class TrackHistory:
    """One track over time.

    Attributes
    ----------
    id : int
        Identifier.
    stamps : ndarray of int, shape (n,)
        ns, ascending.
    angles : ndarray, shape (n,)
        Arrival angles, rad.
    status : ndarray of uint8, shape (n,)
        :class:`TrackStatus` values.
    deviations : ndarray, shape (n,)
        Standard deviation of the angle, rad; NaN = not reported.
    """

    id: int
    stamps: NDArray[np.int64]
    angles: FloatArray
    status: NDArray[np.uint8]
    deviations: FloatArray

    @property
    def confirmed(self) -> bool:
        """Whether the track ever was more than tentative."""
        return bool(np.any(self.status != TrackStatus.TENTATIVE))

    def angles_with_gaps(self) -> FloatArray:
        """Return the angles with NaN where a line would jump over the end of the half circle."""
        angles = self.angles.copy()
        jumps = np.flatnonzero(np.abs(np.diff(angles)) > np.pi / 2)
        angles[jumps] = np.nan
        return angles


def track_histories(lists: Iterable[BearingTracks]) -> tuple[TrackHistory, ...]:
    """Return the tracks of successive track lists, by identifier.

    Parameters
    ----------
    lists : iterable of BearingTracks
        In order of their stamps.
    """
    rows: dict[int, list[tuple[int, float, int, float]]] = {}
    for tracks in lists:
        deviations = np.sqrt(np.maximum(tracks.covariance[:, 0, 0], 0.0))
        for column, identifier in enumerate(tracks.id):
            rows.setdefault(int(identifier), []).append(
                (
                    tracks.stamp,
                    float(tracks.arrival_angle[column]),
                    int(tracks.status[column]),
                    float(deviations[column]),
                )
            )
    histories = []
    for identifier, entries in sorted(rows.items()):
        stamps, angles, status, spreads = zip(*entries, strict=True)
        histories.append(
            TrackHistory(
                id=identifier,
                stamps=np.array(stamps, np.int64),
                angles=np.array(angles),
                status=np.array(status, np.uint8),
                deviations=np.array(spreads),
            )
        )
    return tuple(histories)


def track_summary(histories: Iterable[TrackHistory], start: int) -> Table:
    """Return a table with one row a track.

    Parameters
    ----------
    histories : iterable of TrackHistory
        Tracks to list.
    start : int
        Stamp that counts as time zero, ns.
    """
    from rich import box
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("track")
    for heading in ("first s", "last s", "from deg", "to deg", "deviation deg", "coasted %"):
        table.add_column(heading, justify="right")
    for history in histories:
        coasted = 100.0 * np.mean(history.status == TrackStatus.COASTED)
        known = history.deviations[np.isfinite(history.deviations)]
        table.add_row(
            str(history.id),
            f"{(history.stamps[0] - start) * 1e-9:.1f}",
            f"{(history.stamps[-1] - start) * 1e-9:.1f}",
            f"{np.degrees(history.angles[0]):+.1f}",
            f"{np.degrees(history.angles[-1]):+.1f}",
            f"{np.degrees(np.median(known)):.2f}" if known.size else "-",
            f"{coasted:.0f}",
        )
    return table
