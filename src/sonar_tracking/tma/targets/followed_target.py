"""One target of the stage: its solver, the bearing tracks it is made of, what it is called."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.time import NANOSECONDS, nanoseconds
from sonar_tracking.tma.estimators.mixture_moments import mixture_moments
from sonar_tracking.tma.estimators.range_bank_state import REFUSED_AZIMUTHS
from sonar_tracking.tma.estimators.sensor_frame import KINEMATIC
from sonar_tracking.tma.targets.array_sides import SIDE_PROBABILITY
from sonar_tracking.tma.targets.baseline_solver import BaselineSolver
from sonar_tracking.tma.targets.hearing import Hearing
from sonar_tracking.tma.targets.lasting_residuals import LastingResiduals, direction_residuals
from sonar_tracking.tma.targets.misaligned_stations import ALIGNED, UsedAlignment
from sonar_tracking.tma.targets.systematic_errors import (
    Sight,
    SystematicErrors,
    displacement,
    systematic_covariance,
)
from sonar_tracking.tma.targets.target_records import TargetObservation, TargetSolution
from sonar_tracking.tma.targets.target_solver import TargetSolver
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration
from sonar_tracking.tma.targets.unseen_turns import Watches

DOUBTFUL = 2.0
"""A deviation this many times that which confirms a solution ends its confirmation."""

RECENT = 300
"""A station that has not observed a target for longer does not fix its position any more, s."""

INCONSISTENT = 10.0
"""Lasting errors whose variance is larger than told by more than this are no errors of directions:
the target is elsewhere, or not one."""

PLACE = (0, 1, 4)
"""Position in a state of x, y, vx, vy, z, vz."""

SILENCE = 60.0
"""A confirmed target whose bearing tracks went on to something else is predicted so long, s; and so
long what contradicted it is not confirmed instead: it may be a disturbance that passes."""


@dataclass(eq=False)
class FollowedTarget:
    """One target.

    Attributes
    ----------
    solver : TargetSolver or BaselineSolver
        Follows it; only the first kind takes several stations.
    members : dict of str to int
        Bearing track of each station it is made of; the first one names it.
    initiated, updated : int
        First stamp, and stamp of the last measurement used, ns.
    bearing_track_id : int
        The bearing track it was started from.
    existence_probability : float
        Of that bearing track; NaN = not estimated.
    solutions : tuple of TargetSolution
        That stand.
    row_of : dict of str to int
        Identifier of each side's row in the track list.
    confirmed : bool
        Whether the solution is good enough.
    sights : dict of str to Sight
        From where each station has observed it last.
    assumed_z : float
        Height in ``map`` where that of targets is known, m; NaN = it is not.
    residuals : LastingResiduals
        How far the stations go on to differ from the solution.
    doubted : int
        Stamp before which it is not confirmed, since something that was contradicts it, ns.
    misfits : dict of str to int
        Azimuths in a row of each station that no hypothesis explains.
    forsaken : int
        Stamp at which its bearing tracks went on to something else, ns; 0 = they did not.
    hearing : Hearing
        How good the bearings of its stations are beside usual ones.
    watches : Watches
        What its stations go on to measure.
    """

    solver: TargetSolver | BaselineSolver
    members: dict[str, int]
    initiated: int
    updated: int
    bearing_track_id: int
    existence_probability: float = np.nan
    solutions: tuple[TargetSolution, ...] = ()
    row_of: dict[str, int] = field(default_factory=dict)
    confirmed: bool = False
    sights: dict[str, Sight] = field(default_factory=dict)
    assumed_z: float = np.nan
    residuals: LastingResiduals = field(default_factory=LastingResiduals)
    doubted: int = 0
    misfits: dict[str, int] = field(default_factory=dict)
    forsaken: int = 0
    hearing: Hearing = field(default_factory=Hearing)
    watches: Watches = field(default_factory=Watches)

    @property
    def best(self) -> TargetSolution:
        """The most probable solution."""
        return max(self.solutions, key=lambda one: one.probability)

    def weigh(self, sensor_id: str, log_likelihood: float) -> None:
        """Count the azimuths of a station that no hypothesis explains, before they are taken in."""
        explained = log_likelihood > -np.inf
        self.misfits[sensor_id] = 0 if explained else self.misfits.get(sensor_id, 0) + 1

    def conclude(
        self, observation: TargetObservation, solutions: tuple[TargetSolution, ...]
    ) -> tuple[TargetSolution, ...]:
        """Return the solutions that stand after an observation, from those of the solver.

        An azimuth that no hypothesis accepts is no measurement of this target, nor is one of
        something silent.
        """
        if not solutions:
            return self.solutions
        self.watches.take(observation)
        heard = not observation.azimuths or self.hearing.hears(observation.sensor_id)
        if observation.line_ids or (heard and not self.solver.refused):
            self.updated = observation.stamp
        if observation.azimuths:
            elevated = bool(np.isfinite(observation.elevation))
            seen = Sight(
                observation.position,
                observation.sensor_z,
                observation.height,
                elevated,
                observation.stamp,
            )
            before = self.sights.get(observation.sensor_id)
            self.sights[observation.sensor_id] = seen.after(before)
            known = observation.height_deviation == 0.0
            self.assumed_z = observation.sensor_z + observation.height if known else np.nan

        return solutions

    def compare(
        self,
        observation: TargetObservation,
        solutions: tuple[TargetSolution, ...],
        configuration: TmaTrackerConfiguration,
    ) -> None:
        """Compare directions with the solution after them, if it has accepted them."""
        usable = observation.azimuths and not self.solver.refused
        if not solutions or not usable or not configuration.entry.weighs_hypotheses:
            return
        best = max(solutions, key=lambda one: one.probability)
        found = direction_residuals(observation, best, configuration.systematic_errors)
        for kind, residual in found.items():
            self.residuals.add(observation.sensor_id, kind, residual, observation.stamp)

    def take(
        self,
        solutions: tuple[TargetSolution, ...],
        configuration: TmaTrackerConfiguration,
        alignment: UsedAlignment = ALIGNED,
    ) -> None:
        """Let solutions of the solver stand, with what constant errors of the stations add."""
        errors = configuration.systematic_errors
        if solutions is self.solutions or not configuration.entry.weighs_hypotheses:
            self.solutions = solutions
            return
        recent = self._recent()
        seen = {name: one for name, one in self.sights.items() if one.stamp >= recent}
        sights, azimuths = list(seen.values()), alignment.spread(list(seen), errors.deviation)
        factor = self.residuals.factor(_coordinates(solutions), recent)
        self.solutions = tuple(
            _with_errors(one, sights, errors, factor, azimuths) for one in solutions
        )

    def adopt(self, state: KalmanState, stamp: int, configuration: TmaTrackerConfiguration) -> None:
        """Let the only solution be where the stations find it once their alignment is known."""
        if len(self.solutions) != 1 or self.solutions[0].spatial is not None:
            return
        covariance = state.covariance.copy()
        covariance[(0, 1), (0, 1)] += configuration.target_size**2
        (solution,) = self.solutions
        self.solutions = (replace(solution, stamp=stamp, mean=state.mean, covariance=covariance),)
        self.judge(configuration)

    def realign(self, turned: UsedAlignment, state: KalmanState | None) -> None:
        """Move the hypotheses of the solver as stations are turned, or to where the target is.

        Parameters
        ----------
        turned : UsedAlignment
            By how much azimuths that have been taken in are to be turned.
        state : KalmanState or None
            x, y, vx, vy of the target; None = that follows from its stations.
        """
        solver, sights = self.solver, list(self.sights.values())
        if not isinstance(solver, TargetSolver) or solver.state is None or not sights:
            return
        bank = solver.state.bank
        mean = bank.mean.copy()
        if state is not None and len(self.solutions) == 1:
            mean[:, :KINEMATIC] += state.mean - mixture_moments(bank)[0][:KINEMATIC]
        else:
            change = turned.turned(list(self.sights))
            for component in mean:
                component[:2] += displacement(component[:2], sights, change)
        solver.state = replace(solver.state, bank=replace(bank, mean=mean), beginning=None)
        self.residuals = LastingResiduals()

    def go_back(self, solver: TargetSolver, solutions: tuple[TargetSolution, ...]) -> None:
        """Go on from what was known when it was confirmed: what came since was of nothing."""
        self.solver, self.solutions, self.confirmed = solver, solutions, True
        self.updated, self.doubted, self.misfits = solutions[0].stamp, 0, {}
        self.residuals = LastingResiduals()

    def _recent(self) -> int:
        """Return the stamp before which a station's last observation does not count, ns."""
        newest = max((one.stamp for one in self.sights.values()), default=0)
        return newest - RECENT * NANOSECONDS

    @property
    def misled(self) -> bool:
        """Whether its bearings are all of something else by now."""
        return self.solver.refused >= REFUSED_AZIMUTHS

    def forsake(self, stamp: int) -> None:
        """Go on without bearing tracks: predicted, for as long as the source may be silent."""
        self.members, self.misfits, self.forsaken = {}, {}, stamp
        if isinstance(self.solver, TargetSolver):
            self.solver.forgive()

    def patience(self, configuration: TmaTrackerConfiguration) -> float:
        """Return how long it outlives its bearing tracks, s."""
        least = SILENCE if self.forsaken else 0.0
        return max(configuration.coast_duration, least)

    def status(
        self, solution: TargetSolution, stamp: int, configuration: TmaTrackerConfiguration
    ) -> TrackStatus:
        """Return what a row of the track list says of itself at a stamp."""
        sure = self.confirmed and solution.probability > SIDE_PROBABILITY
        late = stamp - self.updated > configuration.coasted_after * NANOSECONDS
        if sure and (late or not self.members):
            return TrackStatus.COASTED
        return TrackStatus.CONFIRMED if sure else TrackStatus.TENTATIVE

    def judge(self, configuration: TmaTrackerConfiguration) -> None:
        """Decide whether the solution is good enough to be confirmed, or not any more.

        One that is confirmed stays so until its position is known to less than half as well as
        a confirmation takes: the target turned, or its bearings proved to be worse than told.
        """
        if not self.solutions:
            return
        best = self.best
        if best.observability < configuration.confirm_observability:
            if self.confirmed and configuration.entry.weighs_hypotheses:
                self._doubt(best.stamp)
            self.confirmed = False
            return
        factor = self.residuals.factor(_coordinates(self.solutions), self._recent())
        if best.stamp < self.doubted or factor > INCONSISTENT:
            self.confirmed = False
            return
        distance = self._distance(best)
        variance = float(np.linalg.eigvalsh(best.covariance[:2, :2])[-1])
        if configuration.entry.weighs_hypotheses:
            # The size of the target, which was added, is no error of the solution.
            variance -= configuration.target_size**2
        limit = configuration.confirm_relative_deviation * distance
        if self.confirmed:
            limit *= DOUBTFUL
        self.confirmed = bool(variance <= limit**2)

    def _doubt(self, stamp: int) -> None:
        """Begin anew after measurements that contradicted what was confirmed."""
        self.doubted = stamp + nanoseconds(SILENCE)
        self.residuals = LastingResiduals()

    def _distance(self, solution: TargetSolution) -> float:
        """Return the range of a solution from the station that is farthest from it, m."""
        places = [one.position for one in self.sights.values()] or [(0.0, 0.0)]
        return float(np.max(np.hypot(*(solution.mean[:2] - places).T)))


def _coordinates(solutions: tuple[TargetSolution, ...]) -> int:
    """Return how many coordinates of a position are found."""
    return 3 if any(one.spatial is not None for one in solutions) else 2


def _with_errors(
    solution: TargetSolution,
    sights: list[Sight],
    errors: SystematicErrors,
    factor: float,
    azimuths: FloatArray | None,
) -> TargetSolution:
    """Return a solution with the covariance of lasting errors, whose variance has a factor."""
    if not sights or errors.none:
        return solution
    covariance, spatial = solution.covariance.copy(), solution.spatial
    position = solution.mean[:2] if spatial is None else spatial.mean[list(PLACE)]
    added = systematic_covariance(position, sights, errors, factor, azimuths)
    covariance[:2, :2] += added[:2, :2]
    if spatial is not None:
        widened = spatial.covariance.copy()
        widened[np.ix_(PLACE, PLACE)] += added
        spatial = KalmanState(spatial.mean, widened)
    return replace(solution, covariance=covariance, spatial=spatial)


def new_solver(
    configuration: TmaTrackerConfiguration, n_stations: int = 1
) -> TargetSolver | BaselineSolver:
    """Return a solver of the method that is configured, where so many stations report.

    One of several stations does not begin anew: it is compared with trials, which cannot either.
    """
    if configuration.entry.weighs_hypotheses:
        return TargetSolver(configuration, begins_anew=n_stations == 1)
    return BaselineSolver(configuration)


def solver_state(target: FollowedTarget) -> KalmanState | None:
    """Return x, y, vx, vy of a target by its solver alone; None = it is not one place yet.

    Parameters
    ----------
    target : FollowedTarget
        Whose alignment may have been adopted since.
    """
    solver = target.solver
    if not isinstance(solver, TargetSolver) or solver.state is None or len(target.solutions) != 1:
        return None
    mean, covariance = mixture_moments(solver.state.bank)
    return KalmanState(mean[:KINEMATIC], covariance[:KINEMATIC, :KINEMATIC])
