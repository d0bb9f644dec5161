"""Finds out whether targets of different stations are one: by trying it.

For each pair of targets that no station tells apart, a trial solver is fed with the observations
of both. The evidence that they are one is

    log p(observations of both | one target) - log p(of one | alone) - log p(of the other | alone),

summed innovation by innovation; the first bearing of a target alone comes from anywhere. What is
taken to be one is the most likely assignment, once it beats every other one by the stated odds.
Bearings that cross where no target is (ghosts) fall behind as the stations or the targets move.

The motion that is allowed is that of the target's class: of a ship, and, in a trial of its own, of
something agile, as animals and divers are. That is compared with solvers alone that allow for it
too. Where many pairs are possible agile targets are tried only later: a pair whose trials have all
fallen behind is tried again, from what is known of the older target then, after ever longer pauses.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.time import nanoseconds
from sonar_tracking.tma.estimators.range_bank_configuration import RangeBankConfiguration
from sonar_tracking.tma.targets.followed_target import FollowedTarget
from sonar_tracking.tma.targets.station_association import CHANCE_DENSITY, FREE, associate
from sonar_tracking.tma.targets.target_records import TargetObservation
from sonar_tracking.tma.targets.target_solver import TargetSolver

AGILE = 0.05
"""Process noise of targets that do not go straight for long, m/s^2."""

FEW = 4
"""Where a new target may be one with so many others at most, agile ones are tried at once; a trial
is begun again when there are fewer."""

FIRST_PAUSE, LATER_PAUSES = 30.0, 2.0
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
    alone : dict of FollowedTarget to TargetSolver
        What the trial is compared with where this is not the target's own solver.
    """

    first: FollowedTarget
    second: FollowedTarget
    solver: TargetSolver
    evidence: float = 0.0
    pause: float = FIRST_PAUSE
    alone: dict[FollowedTarget, TargetSolver] = field(default_factory=dict)

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
        self._agile: RangeBankConfiguration | None = None

    def begin(self, born: FollowedTarget, others: Sequence[FollowedTarget]) -> None:
        """Try a new target, before its first observation, with all others it may be one with."""
        possible = [one for one in others if _may_be_one(one, born)]
        for other in possible:
            if isinstance(other.solver, TargetSolver):
                self._trials.append(Trial(other, born, other.solver.copy()))
                if len(possible) <= FEW:
                    self._try_agile(other, born, FIRST_PAUSE)

    def _try_agile(self, first: FollowedTarget, second: FollowedTarget, pause: float) -> None:
        """Begin a trial in which neither the pair nor one alone need go straight for long.

        Not of a target that is only predicted: it could be anywhere soon.
        """
        if not _may_be_one(first, second) or not isinstance(first.solver, TargetSolver):
            return
        if not first.members:
            return
        if self._agile is None:
            given = first.solver.configuration
            self._agile = replace(given, acceleration=max(given.acceleration, AGILE))
        alone = {first: first.solver.copy(self._agile), second: TargetSolver(self._agile)}
        solver = first.solver.copy(self._agile)
        self._trials.append(Trial(first, second, solver, pause=pause, alone=alone))

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

    def choose_side(self, target: FollowedTarget, side: str) -> None:
        """Let the side of a target, ``left`` or ``right``, be certain in all its trials."""
        for trial in self._trials:
            if target is trial.first:
                trial.solver.choose_side(side)
            if target in trial.alone:
                trial.alone[target].choose_side(side)

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
            place = firsts.index(one.first), seconds.index(one.second)
            evidence[place] = max(evidence[place], one.evidence)
        assigned = associate(evidence + np.log(CHANCE_DENSITY))
        pairs = []
        for column, row in enumerate(assigned):
            if row == FREE or evidence[row, column] - _rival(evidence, row, column) < (
                self._threshold
            ):
                continue
            pair = firsts[row], seconds[column]
            trial = max((one for one in likely if one.pair == pair), key=lambda one: one.evidence)
            pairs.append(Pair(trial.first, trial.second, trial.solver))
        return tuple(pairs)

    def _give_up(self, stamp: int) -> None:
        """Give up what fell behind, for ever only where a station tells the two apart."""
        for failed in [one for one in self._failed if one.next_stamp <= stamp]:
            first, second = failed.trial.pair
            if sum(one.second is second for one in self._trials) < FEW:
                self._failed.remove(failed)
                self._try_agile(first, second, LATER_PAUSES * failed.trial.pause)
        for trial in [one for one in self._trials if one.evidence <= -self._threshold]:
            self._trials.remove(trial)
            parallel = any(one.pair == trial.pair for one in self._trials)
            if trial.evidence > -np.inf and not parallel:
                self._failed.append(_Failed(trial, stamp + nanoseconds(trial.pause)))

    def join(self, pair: Pair) -> None:
        """Take a pair to be one: what the older target is tried with goes on with both."""
        self.end(pair.second)
        for trial in self._trials:
            if pair.first in trial.pair:
                trial.solver = pair.solver.copy(trial.solver.configuration)
            if pair.first in trial.alone:
                trial.alone[pair.first] = pair.solver.copy(trial.solver.configuration)


def _may_be_one(first: FollowedTarget, second: FollowedTarget) -> bool:
    """Return whether no station tells two targets apart, and something is known of the first."""
    return not set(first.members) & set(second.members) and bool(first.solutions)


def _rival(evidence: FloatArray, row: int, column: int) -> float:
    """Return the evidence of the best pair that shares one of the two; at least that of none."""
    rivals = (np.delete(evidence[row], column), np.delete(evidence[:, column], row))
    return float(np.max(np.concatenate(rivals), initial=0.0))
