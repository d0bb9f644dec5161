"""A target that falls silent: it goes on from where it was before its bearings were of nothing.

That bearings are of nothing is known half a minute late (:mod:`.hearing`). Those that were taken in
since then have dragged the target along, so that it goes on from what was known before them, and is
predicted from there for as long as it is not heard. Azimuths alone may be worse since their target
passes overhead, or ahead of a line array: these are taken in.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.records.time import nanoseconds
from sonar_tracking.tma.targets.followed_target import FollowedTarget
from sonar_tracking.tma.targets.target_records import TargetObservation, TargetSolution
from sonar_tracking.tma.targets.target_solver import TargetSolver

NOTICED_AFTER = 30.0
"""What was known so long before it is noticed that a target is silent is of the target, s."""

KEPT_EVERY = 10.0
"""Between two instants that are remembered, s."""


@dataclass(frozen=True)
class Known:
    """What was known of a confirmed target at a stamp, ns."""

    stamp: int
    solver: TargetSolver
    solutions: tuple[TargetSolution, ...]


class KnownBefore:
    """What was known of each confirmed target a short time ago."""

    def __init__(self) -> None:
        self._kept: dict[FollowedTarget, tuple[Known, ...]] = {}
        self._silent: set[FollowedTarget] = set()

    def end(self, target: FollowedTarget) -> None:
        """Forget a target."""
        self._kept.pop(target, None)
        self._silent.discard(target)

    def heard(self, target: FollowedTarget, observation: TargetObservation) -> TargetObservation:
        """Return what of an observation is of the target: no direction of what is not heard.

        One that was confirmed goes on from what was known before, once no station hears it.

        Parameters
        ----------
        target : FollowedTarget
            Has changed then.
        observation : TargetObservation
            Of one of its stations.
        """
        if not observation.azimuths:
            return observation
        stamp, solver = observation.stamp, target.solver
        long_ago = stamp - nanoseconds(NOTICED_AFTER)
        kept = self._kept.get(target, ())
        if target.hearing.take(observation):
            self._silent.discard(target)
            due = not kept or stamp - kept[-1].stamp >= nanoseconds(KEPT_EVERY)
            if due and target.confirmed and isinstance(solver, TargetSolver):
                known = Known(target.solutions[0].stamp, solver.copy(), target.solutions)
                self._kept[target] = (*_since(kept, long_ago), known)
            return observation
        before = _since(kept, long_ago)[:1]
        was_known = bool(before) and before[0].stamp <= long_ago
        if not was_known or not np.isfinite(observation.elevation):
            return observation
        if target not in self._silent and not target.hearing.any_of(target.members):
            self._silent.add(target)
            self._kept[target] = before
            target.go_back(before[0].solver.copy(), before[0].solutions)
        return replace(
            observation,
            azimuths=(),
            azimuth_variance=np.nan,
            elevation=np.nan,
            elevation_variance=np.nan,
        )


def _since(kept: tuple[Known, ...], stamp: int) -> tuple[Known, ...]:
    """Return what was known from a stamp on, ns, and the last before it."""
    later = sum(one.stamp > stamp for one in kept)
    return kept[-later - 1 :]
