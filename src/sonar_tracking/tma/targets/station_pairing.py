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

from sonar_tracking.errors import InputError
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.tma.targets.followed_target import FollowedTarget
from sonar_tracking.tma.targets.station_association import CHANCE_DENSITY, FREE, associate
from sonar_tracking.tma.targets.target_records import TargetObservation, TargetSolution
from sonar_tracking.tma.targets.target_solver import TargetSolver

WILD_SHARE = 0.01
"""Of the bearings may be from anywhere: one outlier decides nothing."""


@dataclass
class _Trial:
    """Two targets taken to be one.

    Attributes
    ----------
    first, second : FollowedTarget
        The older one, which stays, and the younger one.
    solver : TargetSolver
        Of both.
    evidence : float
        That they are one; log.
    solutions : tuple of TargetSolution
        Of the solver.
    """

    first: FollowedTarget
    second: FollowedTarget
    solver: TargetSolver
    evidence: float = 0.0
    solutions: tuple[TargetSolution, ...] = ()


@dataclass(frozen=True)
class Pair:
    """Two targets that are one.

    Attributes
    ----------
    first, second : FollowedTarget
        The one that stays, and the one that ends.
    solver : TargetSolver
        Of both.
    solutions : tuple of TargetSolution
        Of the solver.
    """

    first: FollowedTarget
    second: FollowedTarget
    solver: TargetSolver
    solutions: tuple[TargetSolution, ...]


class StationPairing:
    """All trials under way.

    Parameters
    ----------
    odds : float
        To one, at which a pair is accepted or given up.
    """

    def __init__(self, odds: float) -> None:
        self._threshold = float(np.log(odds))
        self._trials: list[_Trial] = []

    def begin(self, born: FollowedTarget, others: Sequence[FollowedTarget]) -> None:
        """Try a new target, before its first observation, with all others it may be one with."""
        for other in others:
            apart = set(other.members) & set(born.members)
            if not apart and isinstance(other.solver, TargetSolver) and other.solutions:
                self._trials.append(_Trial(other, born, other.solver.copy()))

    def observe(self, target: FollowedTarget, observation: TargetObservation) -> None:
        """Weigh an observation of a target, before the target itself takes it in."""
        own: float | None = None
        for trial in self._trials:
            if target not in (trial.first, trial.second):
                continue
            if observation.azimuths:
                trial.solver.expect(observation)
                own = _log_density(target, observation) if own is None else own
                trial.evidence += _log_density_of(trial.solver, observation) - own
            try:
                trial.solutions = trial.solver.update(observation) or trial.solutions
            except InputError:
                trial.evidence = -np.inf

    def end(self, target: FollowedTarget) -> None:
        """Forget the trials of a target that ends."""
        self._trials = [one for one in self._trials if target not in (one.first, one.second)]

    def decide(self) -> tuple[Pair, ...]:
        """Return the pairs that are one, and give up those that are not."""
        self._trials = [one for one in self._trials if one.evidence > -self._threshold]
        firsts = list({id(one.first): one.first for one in self._trials}.values())
        seconds = list({id(one.second): one.second for one in self._trials}.values())
        evidence = np.full((len(firsts), len(seconds)), -np.inf)
        for one in self._trials:
            evidence[firsts.index(one.first), seconds.index(one.second)] = one.evidence
        assigned = associate(evidence + np.log(CHANCE_DENSITY))
        pairs = []
        for column, row in enumerate(assigned):
            if row == FREE or evidence[row, column] - _rival(evidence, row, column) < (
                self._threshold
            ):
                continue
            trial = next(
                one
                for one in self._trials
                if one.first is firsts[row] and one.second is seconds[column]
            )
            pairs.append(Pair(trial.first, trial.second, trial.solver, trial.solutions))
        return tuple(pairs)

    def join(self, pair: Pair) -> None:
        """Take a pair to be one: what the older target is tried with goes on with both."""
        self.end(pair.second)
        for trial in self._trials:
            if pair.first in (trial.first, trial.second):
                trial.solver = pair.solver.copy()


def _rival(evidence: FloatArray, row: int, column: int) -> float:
    """Return the evidence of the best pair that shares one of the two; at least that of none."""
    rivals = (np.delete(evidence[row], column), np.delete(evidence[:, column], row))
    return float(np.max(np.concatenate(rivals), initial=0.0))


def _log_density(target: FollowedTarget, observation: TargetObservation) -> float:
    if not target.solutions:
        return _chance(observation)
    assert isinstance(target.solver, TargetSolver)
    return _log_density_of(target.solver, observation)


def _log_density_of(solver: TargetSolver, observation: TargetObservation) -> float:
    likely = np.log1p(-WILD_SHARE) + solver.log_likelihood(observation)
    return float(np.logaddexp(likely, np.log(WILD_SHARE) + _chance(observation)))


def _chance(observation: TargetObservation) -> float:
    """Return the log density of azimuths from anywhere; two stand for one angle of a cone."""
    return float(np.log(CHANCE_DENSITY * len(observation.azimuths)))
