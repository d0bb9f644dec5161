"""The rows of a recorded list over time: where each is, and what it was made of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.records.arrays import CodeArray
from sonar_tracking.records.bearings import established
from sonar_tracking.records.positions import PositionTracks
from sonar_tracking.records.time import seconds
from sonar_tracking.tma.batch.track_smoother import TrackPath
from sonar_tracking.tma.targets.observation_log import TrackKey


@dataclass(frozen=True)
class RecordedRows:
    """One row of a list over time.

    Attributes
    ----------
    places : list of tuple of int
        In which picture it is, and in which of its rows.
    path : TrackPath
        As the list tells it.
    stamps : list of int
        Of these pictures, ns.
    members : list of frozenset
        Bearing tracks it was made of, picture by picture.
    status : ndarray, shape (n,)
        As the list tells it.
    """

    places: list[tuple[int, int]]
    path: TrackPath
    stamps: list[int]
    members: list[frozenset[TrackKey]]
    status: CodeArray

    @property
    def confirmed(self) -> bool:
        """Whether it ever was."""
        return bool(np.any(established(self.status)))


def recorded_rows(pictures: Sequence[PositionTracks]) -> dict[int, RecordedRows]:
    """Return every row by its identifier.

    Parameters
    ----------
    pictures : sequence of PositionTracks
        All of a recording, of one tracker, in order.
    """
    places: dict[int, list[tuple[int, int]]] = {}
    members: dict[tuple[int, int], set[TrackKey]] = {}
    for index, picture in enumerate(pictures):
        for row, identifier in enumerate(picture.id.tolist()):
            places.setdefault(identifier, []).append((index, row))
        columns = zip(
            picture.contributor_track.tolist(),
            picture.contributor_sensor,
            picture.contributor_id.tolist(),
            strict=True,
        )
        for row, sensor, number in columns:
            members.setdefault((index, row), set()).add((sensor, number))
    recorded = {}
    for identifier, own in places.items():
        stamps = [pictures[index].stamp for index, _ in own]
        path = TrackPath(
            np.array([seconds(stamp - stamps[0]) for stamp in stamps]),
            np.array([pictures[index].state[row] for index, row in own]),
            np.array([pictures[index].covariance[row] for index, row in own]),
        )
        heard = [frozenset(members.get(place, ())) for place in own]
        status = np.array([pictures[index].status[row] for index, row in own])
        recorded[identifier] = RecordedRows(own, path, stamps, heard, status)
    return recorded


def joined_later(recorded: dict[int, RecordedRows]) -> set[tuple[int, int]]:
    """Return where rows are of a target that another row was found to be, later.

    Parameters
    ----------
    recorded : dict of int to RecordedRows
        By identifier.

    Returns
    -------
    set of tuple of int
        Pictures and their rows: of those that never were confirmed, made of bearing tracks that a
        confirmed row, which was there already, has had since a later picture.
    """
    sure = {number: one for number, one in recorded.items() if one.confirmed}
    had: dict[TrackKey, list[tuple[int, int, int]]] = {}
    for number, one in sure.items():
        joined: dict[TrackKey, int] = {}
        for stamp, members in zip(one.stamps, one.members, strict=True):
            joined = dict.fromkeys(members, stamp) | joined
        for key, stamp in joined.items():
            had.setdefault(key, []).append((number, one.stamps[0], stamp))
    found = set()
    for number, one in recorded.items():
        if number in sure:
            continue
        for place, stamp, members in zip(one.places, one.stamps, one.members, strict=True):
            owners = [
                {
                    other
                    for other, first, joined_at in had.get(key, ())
                    if first <= stamp < joined_at
                }
                for key in members
            ]
            if owners and set.intersection(*owners):
                found.add(place)
    return found
