"""Finds out whether two targets that met have exchanged their tracks of one source.

Where targets meet, a bearing tracker or a tracker of echoes may go on with the other one's. Nothing
is lost then, and each target is dragged to and fro between two of them. So while two are near each
other, copies of both are followed that take each other's measurements of that source, and the
evidence is

    log p(measurements | copies) - log p(measurements | targets),

summed over all measurements of both. Copies that fall behind begin again as long as the two are
near: an exchange may come at any time. Where only one of them has a track of the source, it goes to
the other.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from sonar_tracking.alignment.aligned_targets import (
    AlignedTargets,
    MotionStrengths,
    joined,
    predicted,
    replaced,
    with_array,
)
from sonar_tracking.fusion.fused_target import FusedTarget
from sonar_tracking.records.arrays import FloatArray, IndexArray

ECHOES = None
"""In place of a station: what is exchanged are tracks of echoes."""

Taking = Callable[[AlignedTargets, IndexArray], tuple[AlignedTargets, FloatArray]]
"""Gives targets measurements, by their places, and returns how likely each was; a log."""


@dataclass(eq=False)
class Exchange:
    """Two targets that may have exchanged their tracks.

    Attributes
    ----------
    pair : tuple of two FusedTarget
        Which.
    source : str or None
        Station whose bearing tracks are exchanged; :data:`ECHOES`.
    evidence : float
        That they have; a log of odds.
    made_of : tuple
        Tracks of both at the beginning.
    """

    pair: tuple[FusedTarget, FusedTarget]
    source: str | None
    evidence: float = 0.0
    made_of: tuple[frozenset[object], ...] = field(default=())

    def __post_init__(self) -> None:
        """Remember the tracks."""
        self.made_of = tracks_of(self.pair)

    @property
    def stands(self) -> bool:
        """Whether the tracks of both are what they were."""
        return self.made_of == tracks_of(self.pair)


class Exchanges:
    """All exchanges that are considered.

    Parameters
    ----------
    targets : AlignedTargets
        None yet: tells the number of modes and arrays.
    """

    def __init__(self, targets: AlignedTargets) -> None:
        self.considered: list[Exchange] = []
        self._copies = targets

    def predict(self, interval: float, strengths: MotionStrengths) -> None:
        """Go on by an interval, s."""
        self._copies = predicted(self._copies, interval, strengths)

    def add_array(self, variance: float) -> None:
        """Let there be one array more, of prior variance (rad^2)."""
        self._copies = with_array(self._copies, variance)

    def begin(self, pairs: Sequence[Exchange], copies: AlignedTargets) -> None:
        """Consider exchanges, from copies of their targets: two rows each."""
        self.considered += pairs
        self._copies = joined(self._copies, copies)

    def is_considered(self, pair: tuple[FusedTarget, FusedTarget], source: str | None) -> bool:
        """Return whether an exchange is considered already."""
        return any(one.pair == pair and one.source == source for one in self.considered)

    def end(self, targets: set[FusedTarget]) -> None:
        """Consider the exchanges of some targets no more."""
        self._keep([not targets & set(one.pair) for one in self.considered])

    def give_up(self, odds: float) -> None:
        """End those that have fallen behind, or whose targets are made of other tracks by now."""
        least = -np.log(odds)
        self._keep([one.stands and one.evidence > least for one in self.considered])

    def best(self, needed: float) -> tuple[Exchange, AlignedTargets] | None:
        """Return the surest exchange, if its evidence is what is needed, and both copies."""
        if not self.considered:
            return None
        place = int(np.argmax([one.evidence for one in self.considered]))
        if self.considered[place].evidence < needed:
            return None
        return self.considered[place], self._copies.rows(np.array([2 * place, 2 * place + 1]))

    def take(
        self,
        targets: Sequence[FusedTarget],
        source: str | None,
        likelihood: FloatArray,
        taking: Taking,
    ) -> None:
        """Take in measurements that targets have taken in.

        Parameters
        ----------
        targets : sequence of FusedTarget
            Each once.
        source : str or None
            Station that measured; :data:`ECHOES`.
        likelihood : ndarray, shape (n,)
            By the targets themselves; logs of densities, 1/rad or 1/m^2.
        taking : callable
            Gives copies their measurements, by the places of these.
        """
        place = {target: number for number, target in enumerate(targets)}
        rows, own, exchange = [], [], []
        for number, one in enumerate(self.considered):
            crossed = int(one.source == source)
            for side, target in enumerate(one.pair):
                if target in place:
                    rows.append(2 * number + (side ^ crossed))
                    own.append(place[target])
                    exchange.append(number)
        if not rows:
            return
        chosen, owner = np.array(rows, np.intp), np.array(own, np.intp)
        updated, gained = taking(self._copies.rows(chosen), owner)
        self._copies = replaced(self._copies, chosen, updated)
        for number, gain in zip(exchange, gained - likelihood[owner], strict=True):
            self.considered[number].evidence += float(gain)

    def _keep(self, kept: Sequence[bool]) -> None:
        if all(kept):
            return
        rows = np.flatnonzero(kept)
        self.considered = [self.considered[row] for row in rows]
        self._copies = self._copies.rows((2 * rows[:, None] + np.arange(2)).reshape(-1))


def tracks_of(targets: Sequence[FusedTarget]) -> tuple[frozenset[object], ...]:
    """Return the tracks that each target is made of."""
    return tuple(frozenset([*one.echoes, *one.heard]) for one in targets)
