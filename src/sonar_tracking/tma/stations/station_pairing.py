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
fallen behind is tried again, after longer pauses: from what is known of the older target then, and,
if a single station sees it, from nothing, too.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.time import nanoseconds
from sonar_tracking.tma.estimators.range_bank_configuration import RangeBankConfiguration
from sonar_tracking.tma.stations.station_association import CHANCE_DENSITY, FREE, associate
from sonar_tracking.tma.stations.station_crossings import certain_crossings, pointed_at
from sonar_tracking.tma.stations.station_trials import (
    FIRST_PAUSE,
    LEAST_BEARINGS,
    Key,
    Sighting,
    Trial,
)
from sonar_tracking.tma.targets.followed_target import FollowedTarget
from sonar_tracking.tma.targets.target_solver import TargetSolver

AGILE = 0.05
"""Process noise of targets that do not go straight for long, m/s^2."""

FEW = 4
"""Where a new target may be one with so many others at most, agile ones are tried at once; a trial
is begun again when there are fewer."""

LATER_PAUSES, LONGEST_PAUSE = 2.0, 90.0
"""How much longer each further pause of a trial that failed is, and the longest of them, s: targets
that stations see with errors that last fall behind again and again before they are found to be one.
"""

UNDECIDED = 60.0
"""A further station is tried anew if so long nothing was decided, s: the others may point to it
better by then."""


@dataclass(frozen=True)
class _Failed:
    """A trial that was given up for now; stamp in ns."""

    trial: Trial
    next_stamp: int


class _Pause(NamedTuple):
    """Until when targets are not tried together, ns, and how long that was, s."""

    end: int
    length: float


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


@lru_cache(maxsize=16)
def _agile_version(given: RangeBankConfiguration) -> RangeBankConfiguration:
    """Return the one object of a configuration of targets that move freely.

    Solvers of one object are computed at once, those of several stages too.
    """
    return replace(given, acceleration=max(given.acceleration, AGILE))


def _after(pause: float) -> float:
    """Return how long a trial pauses the next time, s."""
    return min(LATER_PAUSES * pause, LONGEST_PAUSE)


class StationPairing:
    """All trials under way: :func:`observe_together` weighs them.

    Parameters
    ----------
    odds : float
        To one, at which a pair is accepted or given up.
    deviation : float
        Of the lasting error of a station's azimuths, rad.
    """

    def __init__(self, odds: float, deviation: float = 0.0) -> None:
        self._deviation = deviation
        self._threshold = float(np.log(odds))
        self._trials: list[Trial] = []
        self._failed: list[_Failed] = []
        self._pauses: dict[Key, _Pause] = {}
        self._joined: list[FollowedTarget] = []
        self._agile: RangeBankConfiguration | None = None

    def begin(self, born: FollowedTarget, others: Sequence[FollowedTarget]) -> None:
        """Try a new target, before its first observation, with all others it may be one with."""
        possible = [one for one in others if _may_be_one(one, born)]
        for other in possible:
            if isinstance(other.solver, TargetSolver):
                self._trials.append(
                    Trial((other, born), other.solver.copy(), deviation=self._deviation)
                )
                if len(possible) <= FEW:
                    self._try_agile(other, born, FIRST_PAUSE)

    def _try_agile(
        self,
        first: FollowedTarget,
        second: FollowedTarget,
        pause: float,
        forgetting: bool = False,
    ) -> None:
        """Begin a trial in which neither the pair nor one alone need go straight for long.

        Not of a target that is only predicted: it could be anywhere soon. What is known of the
        first one may be forgotten: of a station at rest alone its range is that of a target which
        moves as much as is assumed, and may be wrong for good.
        """
        if not _may_be_one(first, second) or not isinstance(first.solver, TargetSolver):
            return
        if not first.members:
            return
        if self._agile is None:
            self._agile = _agile_version(first.solver.configuration)
        new = TargetSolver(self._agile, begins_anew=False)
        known = new if forgetting else first.solver
        alone = {first: known.copy(self._agile), second: new}
        solver = known.copy(self._agile)
        trial = Trial(
            (first, second),
            solver,
            pause=pause,
            alone=alone,
            agile=True,
            deviation=self._deviation,
        )
        self._trials.append(trial)

    def concerned(self, seen: Sequence[Sighting]) -> list[tuple[Trial, Sighting]]:
        """Return what the trials of the targets that a station has seen will take in.

        A station that sees both targets of a trial tells them apart: the trial is given up.
        """
        of_target = dict(seen)
        located = [one for one in self._joined if len(one.members) > 1]
        begun, elsewhere = pointed_at(
            self._trials, located, seen, self._known(seen), self._deviation
        )
        self._trials += begun
        for key in elsewhere:
            self._pause(key, seen[0][1].stamp)
        concerned = []
        for trial in self._trials:
            own = [one for one in trial.targets if one in of_target]
            if len(own) > 1:
                trial.evidence = -np.inf
            elif own:
                concerned.append((trial, (own[0], of_target[own[0]])))
        return concerned

    def _known(self, seen: Sequence[Sighting]) -> set[Key]:
        """Return what is tried, or not to be tried at the instant of what is seen."""
        failed = [one.trial for one in self._failed]
        paused = {key for key, one in self._pauses.items() if one.end > seen[0][1].stamp}
        return {trial.key for trial in (*self._trials, *failed)} | paused

    def _pause(self, key: Key, stamp: int) -> None:
        """Do not try targets together for some time, longer each time."""
        before = self._pauses.get(key)
        length = FIRST_PAUSE if before is None else _after(before.length)
        self._pauses[key] = _Pause(stamp + nanoseconds(length), length)

    def end(self, target: FollowedTarget) -> None:
        """Forget the trials of a target that ends."""
        self._joined = [one for one in self._joined if one is not target]
        self._trials = [one for one in self._trials if target not in one.targets]
        self._failed = [one for one in self._failed if target not in one.trial.targets]
        self._pauses = {key: one for key, one in self._pauses.items() if target not in key[0]}

    def choose_side(self, target: FollowedTarget, side: str) -> None:
        """Let the side of a target, ``left`` or ``right``, be certain in all its trials."""
        for trial in self._trials:
            if target is trial.targets[0]:
                trial.solver.choose_side(side)
            if target in trial.alone:
                trial.alone[target].choose_side(side)

    def decide(self, stamp: int) -> tuple[Pair, ...]:
        """Return the pairs that are one at a stamp, ns, and give up for now those that are not.

        Three that are one are two pairs, with the same first target.
        """
        self._give_up(stamp)
        if not any(one.evidence >= self._threshold for one in self._trials):
            return ()
        larger = [one for one in self._trials if not one.is_pair]
        certain = certain_crossings(self._trials, self._threshold) if larger else []
        together = [(one, more) for one in certain for more in one.targets[1:]]
        pairs = [Pair(one.targets[0], more, one.solver) for one, more in together]
        taken = {target for one in certain for target in one.targets}
        alone = self._certain_pairs(larger)
        return (*pairs, *(one for one in alone if taken.isdisjoint((one.first, one.second))))

    def _certain_pairs(self, larger: Sequence[Trial]) -> list[Pair]:
        """Return the pairs of the best assignment that beat all others by the odds."""
        # The others have no part in the best assignment.
        likely = [one for one in self._trials if one.evidence > 0.0 and one.is_pair]
        firsts = list(dict.fromkeys(one.targets[0] for one in likely))
        seconds = list(dict.fromkeys(one.targets[1] for one in likely))
        evidence = np.full((len(firsts), len(seconds)), -np.inf)
        for one in likely:
            place = firsts.index(one.targets[0]), seconds.index(one.targets[1])
            evidence[place] = max(evidence[place], one.evidence)
        assigned = associate(evidence + np.log(CHANCE_DENSITY))
        pairs = []
        for column, row in enumerate(assigned):
            if row == FREE:
                continue
            pair = firsts[row], seconds[column]
            rival = max(_rival(evidence, row, column), _larger_rival(larger, pair))
            if evidence[row, column] - rival < self._threshold:
                continue
            own = [one for one in likely if one.targets == pair]
            trial = max(own, key=lambda one: one.evidence)
            if trial.was_pointed_to and trial.bearings < LEAST_BEARINGS:
                continue
            pairs.append(Pair(*pair, trial.solver))
        return pairs

    def _give_up(self, stamp: int) -> None:
        """Give up what fell behind, for ever only where a station tells the two apart."""
        tried = Counter(one.targets[1] for one in self._trials if one.is_pair)
        for failed in [one for one in self._failed if one.next_stamp <= stamp]:
            first, second = failed.trial.targets
            if tried[second] < FEW:
                self._failed.remove(failed)
                pause = _after(failed.trial.pause)
                before = len(self._trials)
                self._try_agile(first, second, pause)
                if len(first.members) == 1:
                    self._try_agile(first, second, pause, forgetting=True)
                tried[second] += len(self._trials) - before
        for trial in [one for one in self._trials if self._fell_behind(one)]:
            self._trials.remove(trial)
            own = set(trial.targets)
            parallel = any(set(one.targets) == own for one in self._trials)
            if trial.was_pointed_to:
                self._pause(trial.key, stamp)
            elif trial.evidence > -np.inf and not parallel:
                self._failed.append(_Failed(trial, stamp + nanoseconds(trial.pause)))
        self._trials = [one for one in self._trials if not self._is_undecided(one, stamp)]

    def _fell_behind(self, trial: Trial) -> bool:
        """Return whether a trial is given up: one worse than without its last target, too."""
        base = trial.base
        lost = base is not None and base in self._trials and trial.evidence < base.evidence
        return lost or trial.evidence <= -self._threshold

    def _is_undecided(self, trial: Trial, stamp: int) -> bool:
        """Return whether a further station is to be tried anew."""
        if not trial.was_pointed_to or stamp - trial.begun < nanoseconds(UNDECIDED):
            return False
        before = 0.0 if trial.base is None else trial.base.evidence
        return trial.evidence - before < self._threshold

    def join(self, pair: Pair) -> None:
        """Take a pair to be one: what the older target is tried with goes on with both."""
        self.end(pair.second)
        if pair.first not in self._joined:
            self._joined.append(pair.first)
        # It is somewhere else than both alone were taken to be: what was found with it is void.
        self._failed = [one for one in self._failed if pair.first not in one.trial.targets]
        self._pauses = {key: one for key, one in self._pauses.items() if pair.first not in key[0]}
        points = len(pair.first.members | pair.second.members) > 1
        self._trials = [
            one
            for one in self._trials
            if pair.first not in one.targets or (one.is_pair and not points)
        ]
        for trial in self._trials:
            if pair.first in trial.targets:
                trial.solver = pair.solver.copy(trial.solver.configuration)
            if pair.first in trial.alone:
                trial.alone[pair.first] = pair.solver.copy(trial.solver.configuration)


def _may_be_one(first: FollowedTarget, second: FollowedTarget) -> bool:
    """Return whether no station tells two targets apart, and something is known of the first."""
    return not set(first.members) & set(second.members) and bool(first.solutions)


def _larger_rival(larger: Sequence[Trial], pair: tuple[FollowedTarget, FollowedTarget]) -> float:
    """Return the evidence of the best trial of more that one of a pair is in, but not the other."""
    other = [one.evidence for one in larger if len({*one.targets}.intersection(pair)) == 1]
    return max(other, default=0.0)


def _rival(evidence: FloatArray, row: int, column: int) -> float:
    """Return the evidence of the best pair that shares one of the two; at least that of none."""
    rivals = (np.delete(evidence[row], column), np.delete(evidence[:, column], row))
    return float(np.max(np.concatenate(rivals), initial=0.0))
