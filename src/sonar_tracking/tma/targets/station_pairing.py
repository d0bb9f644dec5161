"""Finds out whether targets of different stations are one: by trying it.

For each pair of targets that no station tells apart, a trial solver is fed with the observations
of both. The evidence that they are one is

    log p(observations of both | one target) - log p(of one | alone) - log p(of the other | alone),

summed innovation by innovation; the first bearing of a target alone comes from anywhere. What is
taken to be one is the most likely assignment, once it beats every other one by the stated odds.
Bearings that cross where no target is (ghosts) fall behind as the stations or the targets move.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.tma.targets.followed_target import FollowedTarget
from sonar_tracking.tma.targets.station_association import CHANCE_DENSITY, FREE, associate
from sonar_tracking.tma.targets.target_records import TargetObservation
from sonar_tracking.tma.targets.target_solver import TargetSolver

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
    """

    first: FollowedTarget
    second: FollowedTarget
    solver: TargetSolver
    evidence: float = 0.0

    @property
    def pair(self) -> tuple[FollowedTarget, FollowedTarget]:
        """Both targets."""
        return self.first, self.second


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

    def begin(self, born: FollowedTarget, others: Sequence[FollowedTarget]) -> None:
        """Try a new target, before its first observation, with all others it may be one with."""
        for other in others:
            apart = set(other.members) & set(born.members)
            if not apart and isinstance(other.solver, TargetSolver) and other.solutions:
                self._trials.append(Trial(other, born, other.solver.copy()))

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

    def decide(self) -> tuple[Pair, ...]:
        """Return the pairs that are one, and give up those that are not."""
        self._trials = [one for one in self._trials if one.evidence > -self._threshold]
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
