"""Which row is which ship's: one row a ship, as near as can be, and whether it stays the same.

Ships that meet may be nearer to each other than their rows are to them: that the nearest row of
both is one and the same, or changes to and fro, says nothing. So at each ping rows and ships are
paired with the least sum of squared distances, and a name is a ship's as long as its row has not
gone farther away than :data:`NEAR` (Bernardin, Stiefelhagen 2008).

References
----------
Bernardin, Stiefelhagen (2008), section 2.1 (correspondences that are kept).
"""

from __future__ import annotations

from collections import defaultdict

import numpy as np

from sonar_tracking.evaluation.metrics.ospa_gospa import assign
from sonar_tracking.records.arrays import FloatArray, IndexArray
from sonar_tracking.records.bearings import established
from sonar_tracking.records.positions import PositionTracks, TruthTracks

NEAR = 300.0
"""A row within this distance of a ship may be the ship's, m."""

DOUBLE_AFTER = 60.0
"""So long after the later of two confirmed rows of one ship began they should be one, s."""


class HeldRows:
    """The rows of the ships, ping by ping.

    Attributes
    ----------
    names : dict of int to set of int
        Identifiers that each ship had so far, by its number.
    doubled : bool
        Whether a ship had two confirmed rows for too long.
    """

    def __init__(self) -> None:
        self.names: dict[int, set[int]] = defaultdict(set)
        self.doubled = False
        self._begun: dict[int, float] = {}
        self._held: dict[int, int] = {}

    def take(
        self, tracks: PositionTracks, truth: TruthTracks, time: float, counts: bool
    ) -> list[tuple[int, int]]:
        """Take in a list.

        Parameters
        ----------
        tracks : PositionTracks
            The fused list.
        truth : TruthTracks
            At its stamp.
        time : float
            Of the run, s.
        counts : bool
            Whether names count by now.

        Returns
        -------
        list of tuple of two int
            Number of each ship and row that is its; a second row of a ship comes after the first.
        """
        rows = np.flatnonzero(established(tracks.status))
        for row in rows:
            self._begun.setdefault(int(tracks.id[row]), time)
        apart = truth.position[:, None] - tracks.state[None, rows, :2]
        distance = np.hypot(apart[..., 0], apart[..., 1])
        best = assign(distance, NEAR, 2.0)
        pairs = {
            int(rows[row]): int(ship) for ship, row in zip(best.truths, best.estimates, strict=True)
        }
        extra = self._extra(tracks, rows, distance, pairs, time)
        if counts:
            self._keep_names(tracks, truth, rows, distance)
        return [(int(truth.id[ship]), row) for row, ship in [*pairs.items(), *extra]]

    def _extra(
        self,
        tracks: PositionTracks,
        rows: IndexArray,
        distance: FloatArray,
        pairs: dict[int, int],
        time: float,
    ) -> list[tuple[int, int]]:
        """Return rows beyond one a ship, each with the ship it is near."""
        extra = []
        own = {ship: row for row, ship in pairs.items()}
        for place, row in enumerate(rows.tolist()):
            ship = int(np.argmin(distance[:, place]))
            if row in pairs or distance[ship, place] >= NEAR:
                continue
            extra.append((row, ship))
            later = max(self._begun[int(tracks.id[one])] for one in (row, own.get(ship, row)))
            if ship in own and time - later > DOUBLE_AFTER:
                self.doubled = True
        return extra

    def _keep_names(
        self, tracks: PositionTracks, truth: TruthTracks, rows: IndexArray, distance: FloatArray
    ) -> None:
        place = {int(tracks.id[row]): column for column, row in enumerate(rows)}
        ships = {int(number): line for line, number in enumerate(truth.id)}
        kept = {
            ship: name
            for ship, name in self._held.items()
            if ship in ships and name in place and distance[ships[ship], place[name]] < NEAR
        }
        left = distance.copy()
        for ship, name in kept.items():
            left[ships[ship]] = left[:, place[name]] = NEAR
        found = assign(left, NEAR, 2.0)
        numbers = list(place)
        for line, column in zip(found.truths, found.estimates, strict=True):
            kept[int(truth.id[line])] = numbers[column]
        self._held = kept
        for ship, name in kept.items():
            self.names[ship].add(name)
