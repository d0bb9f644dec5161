"""One target of the fused picture: the tracks it is made of, what it is called."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field

import numpy as np

from sonar_tracking.alignment.bearing_errors import BearingKey
from sonar_tracking.fusion.fusion_records import ListKey
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import PositionTracks, TrackSource

LONGEST_DOUBT = 60.0
"""So long bearings may decide whether a target with echoes has been known before, s."""


@dataclass(eq=False)
class Contributor:
    """A track that a target is made of.

    Attributes
    ----------
    status : TrackStatus
        What its list says.
    existence : float
        A probability; NaN = not estimated.
    updated : float
        Stamp time of its last measurement, s.
    """

    status: TrackStatus
    existence: float
    updated: float


@dataclass(eq=False)
class FusedTarget:
    """One target.

    Attributes
    ----------
    id : int
        Of its row.
    initiated : float
        Stamp time of the first track it is made of, s.
    echoes : dict of ListKey to Contributor
        Tracks of what returns echoes.
    heard : dict of BearingKey to Contributor
        Bearing tracks of it.
    orphaned : float
        Stamp time at which the last of them ended, s; NaN = there are some.
    updated : float
        Stamp time of the last measurement of any of them, s.
    rival : FusedTarget or None
        A target that this one may be, its echoes having been lost; None = it is none known before.
    doubted : float
        Since when, stamp time, s.
    silent : bool
        Whether nothing has been measured of it for long: its sources have fallen silent.
    hidden_until : float
        Until when it may be another target that is known better, stamp time, s.
    hidden : bool
        Whether it may be that now.
    """

    id: int
    initiated: float
    echoes: dict[ListKey, Contributor] = field(default_factory=dict)
    heard: dict[BearingKey, Contributor] = field(default_factory=dict)
    orphaned: float = np.nan
    updated: float = np.nan
    rival: FusedTarget | None = None
    doubted: float = np.nan
    silent: bool = False
    hidden_until: float = -np.inf
    hidden: bool = False

    def note(self, key: ListKey, tracks: PositionTracks, row: int) -> None:
        """Let a row of a list of echoes be one of the tracks it is made of."""
        status, updated = TrackStatus(tracks.status[row]), float(tracks.updated[row])
        self.echoes[key] = Contributor(status, float(tracks.existence_probability[row]), updated)
        self.updated = float(np.fmax(self.updated, updated))

    def begin_doubt(self, rival: FusedTarget, now: float) -> None:
        """Let it be open, from now (stamp time, s) on, whether this is a target known before."""
        self.rival, self.doubted = rival, now

    def settle_doubt(self, known: Collection[FusedTarget], now: float) -> None:
        """Let it be another target than its rival if nothing can show any more that it is not.

        Parameters
        ----------
        known : collection of FusedTarget
            All that there are.
        now : float
            Stamp time, s.
        """
        rival = self.rival
        if rival is None:
            return
        found = rival.echoes or not rival.heard or rival not in known
        if found or now - self.doubted > LONGEST_DOUBT:
            self.rival = None

    @property
    def contributors(self) -> list[Contributor]:
        """All tracks it is made of."""
        return [*self.echoes.values(), *self.heard.values()]

    @property
    def is_confirmed(self) -> bool:
        """Whether one of its tracks is confirmed."""
        return any(one.status == TrackStatus.CONFIRMED for one in self.contributors)

    @property
    def status(self) -> TrackStatus:
        """Confirmed as long as one of its tracks is, unless it may be known already."""
        if self.rival is not None or self.hidden:
            return TrackStatus.TENTATIVE
        if self.silent:
            return TrackStatus.COASTED
        return TrackStatus.CONFIRMED if self.is_confirmed else TrackStatus.COASTED

    @property
    def existence(self) -> float:
        """Probability that not all its tracks are false."""
        known = [one.existence for one in self.contributors if not np.isnan(one.existence)]
        return 1.0 - float(np.prod([1.0 - one for one in known])) if known else np.nan


def moves(tracks: PositionTracks, row: int) -> bool:
    """Return whether a row of a list is a target that moves, and has been confirmed."""
    fixed = tracks.source[row] == TrackSource.STATIC
    return bool(not fixed and tracks.established[row])
