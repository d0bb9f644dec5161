"""Finds out whether targets of different stations are one: by trying it.

For each pair of targets that no station tells apart, a trial solver is fed with the observations
of both. The evidence that they are one is

    log p(observations of both | one target) - log p(of one | alone) - log p(of the other | alone),

summed innovation by innovation; the first bearing of a target alone comes from anywhere. What is
taken to be one is the most likely assignment, once it beats every other one by the stated odds.
Bearings that cross where no target is (ghosts) fall behind as the stations or the targets move.

A trial that has fallen behind may have been wrong about the motion, or about the range: it is tried
again later, from what is known of the older target then, after ever longer pauses.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.time import nanoseconds
from sonar_tracking.tma.targets.followed_target import FollowedTarget
from sonar_tracking.tma.targets.station_association import CHANCE_DENSITY, FREE, associate
from sonar_tracking.tma.targets.target_records import TargetObservation
from sonar_tracking.tma.targets.target_solver import TargetSolver

FIRST_PAUSE, LATER_PAUSES = 60.0, 2.0
"""Of a trial that failed, s, and how much longer each further one is."""

Sighting = tuple[FollowedTarget, TargetObservation]
"""A target, and what a station observed of it."""


@dataclass(eq=False)
class Trial:
    """Two targets taken to be one.

    Attributes
    ----------
    first, second : FollowedTarget
        The older one, which stays, and the younger one.
    solver : TargetSolver
        Of both.
    evidence : float
        That they are one; log.
    pause : float
        Until it is tried again if it fails, s.
    """

    first: FollowedTarget
    second: FollowedTarget
    solver: TargetSolver
    evidence: float = 0.0
    pause: float = FIRST_PAUSE

    @property
    def pair(self) -> tuple[FollowedTarget, FollowedTarget]:
        """Both targets."""
        return self.first, self.second


@dataclass(frozen=True)
class _Failed:
    """A trial that was given up for now; stamp in ns."""

    trial: Trial
    next_stamp: int


@dataclass(frozen=True)
class Pair:
    """Two targets that are one.

    Attributes
    ----------
    first, second : FollowedTarget
        The one that stays, and the one that ends.
    solver : TargetSolver
        Of both.
    """

    first: FollowedTarget
    second: FollowedTarget
    solver: TargetSolver


class StationPairing:
    """All trials under way: :func:`observe_together` weighs them.

    Parameters
    ----------
    odds : float
        To one, at which a pair is accepted or given up.
    """

    def __init__(self, odds: float) -> None:
        self._threshold = float(np.log(odds))
        self._trials: list[Trial] = []
        self._failed: list[_Failed] = []

    def begin(self, born: FollowedTarget, others: Sequence[FollowedTarget]) -> None:
        """Try a new target, before its first observation, with all others it may be one with."""
        for other in others:
            self._try(other, born, FIRST_PAUSE)

    def _try(self, first: FollowedTarget, second: FollowedTarget, pause: float) -> None:
        apart = set(first.members) & set(second.members)
        if not apart and isinstance(first.solver, TargetSolver) and first.solutions:
            self._trials.append(Trial(first, second, first.solver.copy(), pause=pause))

    def concerned(self, seen: Sequence[Sighting]) -> list[tuple[Trial, Sighting]]:
        """Return what the trials of the targets that a station has seen will take in.

        A station that sees both targets of a trial tells them apart: the trial is given up.
        """
        of_target = dict(seen)
        concerned = []
        for trial in self._trials:
            own = [one for one in trial.pair if one in of_target]
            if len(own) == 2:
                trial.evidence = -np.inf
            elif own:
                concerned.append((trial, (own[0], of_target[own[0]])))
        return concerned

    def end(self, target: FollowedTarget) -> None:
        """Forget the trials of a target that ends."""
        self._trials = [one for one in self._trials if target not in one.pair]
        self._failed = [one for one in self._failed if target not in one.trial.pair]

    def decide(self, stamp: int) -> tuple[Pair, ...]:
        """Return the pairs that are one at a stamp, ns, and give up for now those that are not."""
        self._give_up(stamp)
        if not any(one.evidence >= self._threshold for one in self._trials):
            return ()
        # The others have no part in the best assignment.
        likely = [one for one in self._trials if one.evidence > 0.0]
        firsts = list(dict.fromkeys(one.first for one in likely))
        seconds = list(dict.fromkeys(one.second for one in likely))
        evidence = np.full((len(firsts), len(seconds)), -np.inf)
        for one in likely:
            evidence[firsts.index(one.first), seconds.index(one.second)] = one.evidence
        assigned = associate(evidence + np.log(CHANCE_DENSITY))
        pairs = []
        for column, row in enumerate(assigned):
            if row == FREE or evidence[row, column] - _rival(evidence, row, column) < (
                self._threshold
            ):
                continue
            trial = next(
                one for one in likely if one.first is firsts[row] and one.second is seconds[column]
            )
            pairs.append(Pair(trial.first, trial.second, trial.solver))
        return tuple(pairs)

    def _give_up(self, stamp: int) -> None:
        """Give up what fell behind, for ever only where a station tells the two apart."""
        for failed in [one for one in self._failed if one.next_stamp <= stamp]:
            self._failed.remove(failed)
            self._try(*failed.trial.pair, LATER_PAUSES * failed.trial.pause)
        for trial in [one for one in self._trials if one.evidence <= -self._threshold]:
            self._trials.remove(trial)
            if trial.evidence > -np.inf:
                self._failed.append(_Failed(trial, stamp + nanoseconds(trial.pause)))

    def join(self, pair: Pair) -> None:
        """Take a pair to be one: what the older target is tried with goes on with both."""
        self.end(pair.second)
        for trial in self._trials:
            if pair.first in trial.pair:
                trial.solver = pair.solver.copy()


def _rival(evidence: FloatArray, row: int, column: int) -> float:
    """Return the evidence of the best pair that shares one of the two; at least that of none."""
    rivals = (np.delete(evidence[row], column), np.delete(evidence[:, column], row))
    return float(np.max(np.concatenate(rivals), initial=0.0))
