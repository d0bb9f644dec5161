"""A trial: targets of different stations taken to be one, with a solver of their own."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from sonar_tracking.records.time import UNKNOWN_STAMP
from sonar_tracking.tma.stations.lasting_error import NO_ERROR, LastingError
from sonar_tracking.tma.targets.followed_target import FollowedTarget
from sonar_tracking.tma.targets.misaligned_stations import ODDS_AGAINST
from sonar_tracking.tma.targets.target_records import TargetObservation
from sonar_tracking.tma.targets.target_solver import TargetSolver

FIRST_PAUSE = 30.0
"""Of a trial that failed, until it is begun again, s."""

ERRS_LASTINGLY = -float(np.log(ODDS_AGAINST))
"""Log odds that a station does: most arrays are aligned."""

LEAST_BEARINGS = 4
"""Of the newest target, before it is certain that it is the one a trial pointed to."""

Sighting = tuple[FollowedTarget, TargetObservation]
"""A target, and what a station observed of it."""


@dataclass(eq=False)
class Trial:
    """Targets of different stations taken to be one.

    Attributes
    ----------
    targets : tuple of FollowedTarget
        The oldest one, which stays, and the others.
    solver : TargetSolver
        Of all.
    evidence : float
        That they are one; log.
    pause : float
        Until it is tried again if it fails, s.
    alone : dict of FollowedTarget to TargetSolver
        What the trial is compared with where this is not the target's own solver.
    agile : bool
        Whether they need not go straight for long.
    newest : FollowedTarget or None
        The one that was added last; None = the second one.
    bearings : int
        Its bearings that have been taken in.
    base : Trial or None
        The trial of all but the newest that it goes on from.
    begun : int
        Stamp of its first bearing, ns.
    deviation : float
        Of the lasting error of a station's azimuths, rad.
    errors, errors_alone : dict of str to LastingError
        What is known of that of each station, if they are one, and if they are not: errors that
        last must not count for a trial whose other target was not seen meanwhile.
    """

    targets: tuple[FollowedTarget, ...]
    solver: TargetSolver
    evidence: float = 0.0
    pause: float = FIRST_PAUSE
    alone: dict[FollowedTarget, TargetSolver] = field(default_factory=dict)
    agile: bool = False
    newest: FollowedTarget | None = None
    bearings: int = 0
    base: Trial | None = None
    begun: int = UNKNOWN_STAMP
    deviation: float = 0.0
    errors: dict[str, LastingError] = field(default_factory=dict)
    errors_alone: dict[str, LastingError] = field(default_factory=dict)

    def error_of(self, sensor_id: str) -> LastingError:
        """Return what is known of the lasting error of a station if the targets are one."""
        return self.errors.get(sensor_id, self._unknown_error())

    def error_alone(self, sensor_id: str) -> LastingError:
        """Return the same if they are not."""
        return self.errors_alone.get(sensor_id, self._unknown_error())

    def _unknown_error(self) -> LastingError:
        if self.deviation == 0.0:
            return NO_ERROR
        return LastingError(0.0, self.deviation**2, ERRS_LASTINGLY)

    def count(self, target: FollowedTarget) -> None:
        """Count a bearing of one of them."""
        self.bearings += target is (self.newest or self.targets[-1])

    @property
    def is_pair(self) -> bool:
        """Whether it is of two."""
        return len(self.targets) == 2

    @property
    def was_pointed_to(self) -> bool:
        """Whether its newest target was found where others pointed, and not tried from birth."""
        return self.begun != UNKNOWN_STAMP

    @property
    def key(self) -> Key:
        """What no two trials have in common."""
        return frozenset(self.targets), self.agile


Key = tuple[frozenset[FollowedTarget], bool]
"""Targets of a trial, and whether they may be agile."""
