"""Bearing tracks that were found to be of a target, and whether they still are.

A bearing tracker may take another source for the same track, where bearings cross. The evidence
that decided for the target goes on, up to a limit, so that it can decide against it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.alignment.bearing_errors import BearingKey
from sonar_tracking.fusion.fused_target import FusedTarget
from sonar_tracking.fusion.fusion_records import HeardBearing
from sonar_tracking.fusion.lone_bearings import (
    LoneBearings,
    joined_bearings,
    predicted_bearings,
    unheard,
)
from sonar_tracking.records.arrays import FloatArray, IndexArray

HIGHEST_EVIDENCE = float(np.log(1e4))
"""What the past can say for a target at most; log."""


@dataclass(eq=False)
class Link:
    """A bearing track that is of a target.

    Attributes
    ----------
    target : FusedTarget
        Which.
    evidence : float
        That it is; log.
    row : int
        Of the bearing track among those followed alone.
    """

    target: FusedTarget
    evidence: float
    row: int


class BearingLinks:
    """The targets of bearing tracks."""

    def __init__(self) -> None:
        self._links: dict[BearingKey, Link] = {}
        self._lone = unheard(0)

    def target_of(self, key: BearingKey) -> FusedTarget | None:
        """Return the target of a bearing track; None = not known."""
        link = self._links.get(key)
        return None if link is None else link.target

    def of_station(self, sensor_id: str) -> list[BearingKey]:
        """Return the bearing tracks of a station that have targets."""
        return [key for key in self._links if key[0] == sensor_id]

    def predict(self, interval: float) -> None:
        """Go on by an interval, s."""
        self._lone = predicted_bearings(self._lone, interval)

    def add(self, key: BearingKey, target: FusedTarget, evidence: float) -> None:
        """Let a bearing track be of a target, with the evidence for it."""
        self._links[key] = Link(target, min(evidence, HIGHEST_EVIDENCE), len(self._lone))
        self._lone = joined_bearings(self._lone, unheard(1))

    def remove(self, key: BearingKey) -> None:
        """Let a bearing track be of no target."""
        gone = self._links.pop(key).row
        self._lone = self._lone.rows(np.delete(np.arange(len(self._lone)), gone))
        for link in self._links.values():
            if link.row > gone:
                link.row -= 1

    def exchange(
        self, sensor_id: str, pair: tuple[FusedTarget, FusedTarget], evidence: float
    ) -> None:
        """Let two targets have each other's bearing tracks of a station, with the evidence."""
        ends = {key: (pair[0], pair[1]) for key in pair[0].heard if key[0] == sensor_id}
        ends |= {key: (pair[1], pair[0]) for key in pair[1].heard if key[0] == sensor_id}
        for key, (before, after) in ends.items():
            after.heard[key] = before.heard.pop(key)
            self.remove(key)
            self.add(key, after, evidence)

    def alone(self, found: Sequence[HeardBearing]) -> LoneBearings:
        """Return the bearing tracks of some bearings, that have targets, as followed alone."""
        return self._lone.rows(self._rows(found))

    def weigh(self, found: Sequence[HeardBearing], alone: LoneBearings, gained: FloatArray) -> None:
        """Go on with the evidence of some links.

        Parameters
        ----------
        found : sequence of HeardBearing
            What was measured, of bearing tracks that have targets.
        alone : LoneBearings
            These bearing tracks, after they have taken the bearings in.
        gained : ndarray, shape (n,)
            How much likelier each bearing was by the filter of its target than by the track alone;
            log of a pure number.
        """
        rows = self._rows(found)
        mean, covariance = self._lone.mean.copy(), self._lone.covariance.copy()
        mean[rows], covariance[rows] = alone.mean, alone.covariance
        self._lone = LoneBearings(mean, covariance)
        for one, gain in zip(found, gained.tolist(), strict=True):
            link = self._links[one.key]
            link.evidence = min(link.evidence + gain, HIGHEST_EVIDENCE)

    def _rows(self, found: Sequence[HeardBearing]) -> IndexArray:
        return np.array([self._links[one.key].row for one in found], np.intp)

    def weigh_positions(self, targets: Sequence[FusedTarget], gain: FloatArray) -> None:
        """Go on with the evidence of the links of some targets.

        Parameters
        ----------
        targets : sequence of FusedTarget
            Whose echoes were measured.
        gain : ndarray, shape (n,)
            How much likelier with the bearings of each than without; log of a pure number.
        """
        gained = dict(zip(targets, gain.tolist(), strict=True))
        for link in self._links.values():
            evidence = link.evidence + gained.get(link.target, 0.0)
            link.evidence = min(evidence, HIGHEST_EVIDENCE)

    def broken(self, odds: float) -> list[BearingKey]:
        """Return the bearing tracks that are of something else, by odds to one."""
        return [key for key, link in self._links.items() if link.evidence < -np.log(odds)]
