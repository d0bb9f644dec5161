"""Bearing tracks as lines over time: one history a track."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from sonar_tracking.motion import compass_from_azimuth
from sonar_tracking.records.arrays import CodeArray, FloatArray, IntArray
from sonar_tracking.records.bearings import AngleKind, BearingTracks, TrackStatus


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
    kind : AngleKind
        Of the angles.
    """

    id: int
    stamps: IntArray
    angles: FloatArray
    status: CodeArray
    deviations: FloatArray
    kind: AngleKind = AngleKind.CONE

    @property
    def confirmed(self) -> bool:
        """Whether the track ever was more than tentative."""
        return bool(np.any(self.status != TrackStatus.TENTATIVE))

    @property
    def degrees(self) -> FloatArray:
        """Angles as people read them: from broadside, or compass bearings, shape (n_rows,), deg."""
        if self.kind == AngleKind.AZIMUTH:
            return compass_from_azimuth(self.angles)
        return np.degrees(self.angles)

    def degrees_with_gaps(self) -> FloatArray:
        """Return the angles, shape (n_rows,), deg; NaN where a line would jump across the axis."""
        degrees = self.degrees
        widest = 180.0 if self.kind == AngleKind.AZIMUTH else 90.0
        jumps = np.flatnonzero(np.abs(np.diff(degrees)) > widest)
        degrees[jumps] = np.nan
        return degrees


def track_histories(lists: Iterable[BearingTracks]) -> tuple[TrackHistory, ...]:
    """Return the tracks of successive track lists, by identifier.

    Parameters
    ----------
    lists : iterable of BearingTracks
        In order of their stamps, all with the same kind of angle.
    """
    rows: dict[int, list[tuple[int, float, int, float]]] = {}
    kind = AngleKind.CONE
    for tracks in lists:
        kind = tracks.angle_kind
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
                kind=kind,
            )
        )
    return tuple(histories)
