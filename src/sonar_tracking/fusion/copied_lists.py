"""Track lists whose rows are shown as they are where no target with echoes stands for them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Set

import numpy as np

from sonar_tracking.alignment.bearing_errors import BearingKey
from sonar_tracking.filtering.consistency import normalised_squared
from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.fusion.copied_rows import bearing_keys, copied_row
from sonar_tracking.fusion.fused_rows import FusedRow
from sonar_tracking.fusion.fusion_records import ListKey
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import PositionTracks
from sonar_tracking.records.time import seconds

ONE_TARGET = 4.0
"""Squared distance per dimension within which two states may be of one target."""

LONGEST_SILENCE = 600.0
"""What has not been told of for so long is no more, whatever its lists last told, s."""


class CopiedLists:
    """The last list of each topic, and the names of its rows in the fused list.

    Parameters
    ----------
    next_id : callable
        Returns a new identifier.
    """

    def __init__(self, next_id: Callable[[], int]) -> None:
        self._next_id = next_id
        self._lists: dict[str, PositionTracks] = {}
        self._heard: dict[str, list[tuple[BearingKey, ...]]] = {}
        self._names: dict[ListKey, int] = {}

    def take(self, topic: str, tracks: PositionTracks) -> None:
        """Let a list be the last one of its topic."""
        self._lists[topic], self._heard[topic] = tracks, bearing_keys(tracks)
        alive = set(tracks.id[tracks.status != TrackStatus.TERMINATED].tolist())
        self._names = {
            key: name for key, name in self._names.items() if key[0] != topic or key[1] in alive
        }

    def name(self, key: ListKey) -> int:
        """Return the identifier of a row, which is new if the row has not been shown."""
        if key not in self._names:
            self._names[key] = self._next_id()
        return self._names[key]

    def keys_named(self, number: int) -> tuple[ListKey, ...]:
        """Return the rows of lists that have an identifier in the fused list: one, or none."""
        return tuple(key for key, name in self._names.items() if name == number)

    def heard_of(self, keys: Iterable[ListKey]) -> tuple[BearingKey, ...]:
        """Return the bearing tracks that rows of the last lists are made of."""
        found: list[BearingKey] = []
        for topic, number in keys:
            for row in np.flatnonzero(self._lists[topic].id == number).tolist():
                found += self._heard[topic][row]
        return tuple(found)

    def confirmed_names(self, heard: BearingKey, state: KalmanState) -> Iterator[int]:
        """Yield names of confirmed rows of a bearing track and of a target.

        A bearing track that has changed its source may have given its name to another target: only
        a row that is where the target is counts.
        """
        for topic, tracks in self._lists.items():
            for row in np.flatnonzero(tracks.status == TrackStatus.CONFIRMED).tolist():
                name = self._names.get((topic, int(tracks.id[row])))
                if name is None or heard not in self._heard[topic][row]:
                    continue
                spread = state.covariance + tracks.covariance[row]
                apart = state.mean - tracks.state[row]
                if normalised_squared(apart, spread) <= ONE_TARGET:
                    yield name

    def rows(
        self,
        stamp: int,
        is_known: Callable[[ListKey, tuple[BearingKey, ...]], bool],
        stations: Mapping[str, FloatArray],
        alignments: Mapping[str, tuple[float, float]],
        taken: Set[int],
    ) -> list[FusedRow]:
        """Return the rows that nothing else stands for.

        Parameters
        ----------
        stamp : int
            Of the fused list, ns.
        is_known : callable
            Tells whether a target stands for a row, by its key and its bearing tracks.
        stations : mapping of str to ndarray, shape (2,)
            Where each array is, m.
        alignments : mapping of str to tuple of two float
            Measured misalignments, rad, and their variances, rad^2.
        taken : set of int
            Identifiers that are those of targets by now.
        """
        rows = []
        for topic, tracks in self._lists.items():
            if seconds(stamp - tracks.stamp) > LONGEST_SILENCE:
                continue
            told = zip(tracks.id.tolist(), tracks.status.tolist(), self._heard[topic], strict=True)
            for row, (number, status, heard) in enumerate(told):
                if status == TrackStatus.TERMINATED:
                    continue
                key = topic, number
                if self._names.get(key) in taken:
                    del self._names[key]
                if not is_known(key, heard):
                    shown = stamp, stations, alignments
                    rows.append(copied_row(tracks, row, heard, key, self.name(key), *shown))
        return rows
