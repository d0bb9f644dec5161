"""What a station observed of its targets, taken in by all of them and by all their trials at once.

A trial is weighed before anything is taken in: how well its solver explains the azimuths, against
how well the target does alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from sonar_tracking.errors import InputError
from sonar_tracking.tma.stations.lasting_error import NO_ERROR, LastingError
from sonar_tracking.tma.stations.solver_likelihoods import Weighed, weigh
from sonar_tracking.tma.stations.station_association import CHANCE_DENSITY
from sonar_tracking.tma.stations.station_pairing import StationPairing
from sonar_tracking.tma.stations.station_trials import Sighting, Trial
from sonar_tracking.tma.targets.baseline_solver import BaselineSolver
from sonar_tracking.tma.targets.followed_target import FollowedTarget
from sonar_tracking.tma.targets.target_records import TargetObservation, TargetSolution
from sonar_tracking.tma.targets.target_solver import (
    Problem,
    Splits,
    TargetSolver,
    Task,
    update_solvers,
)

WILD_SHARE = 0.01
"""Of the bearings may be from anywhere: one outlier decides nothing."""
_LOG_WILD, _LOG_TAME = float(np.log(WILD_SHARE)), float(np.log1p(-WILD_SHARE))

Outcome = tuple[TargetSolution, ...] | Problem
"""The solutions that stand, or why the observation could not be used."""


Scene = tuple[Sequence[Sighting], StationPairing]
"""What one station observed of different targets at one instant, and the trials of their pairs."""


def observe_together(scenes: Sequence[Scene]) -> list[list[Outcome]]:
    """Let targets take in what one station observed of each at one instant, in several scenes.

    Parameters
    ----------
    scenes : sequence of Scene
        Independent of each other. Trials are weighed and take it in, too.

    Returns
    -------
    list of list of Outcome
        Of each target of each scene.
    """
    trials = [_expected(pairing.concerned(seen)) for seen, pairing in scenes]
    tasks: list[Task] = []
    ends = [0]
    for (seen, _), tried in zip(scenes, trials, strict=True):
        _weigh(seen, tried)
        tasks += _tasks(seen, tried)
        ends.append(len(tasks))
    problems = update_solvers(tasks)
    return [
        _outcomes(seen, tried, problems[begin:end])
        for (seen, _), tried, (begin, end) in zip(scenes, trials, pairwise(ends), strict=True)
    ]


def _tasks(seen: Sequence[Sighting], trials: Sequence[tuple[Trial, Sighting]]) -> list[Task]:
    """Return what the solvers of trials, of their targets alone, and of the targets take in."""
    tasks: list[Task] = [(trial.solver, observation) for trial, (_, observation) in trials]
    tasks += [
        (trial.alone[target], observation)
        for trial, (target, observation) in trials
        if target in trial.alone
    ]
    tasks += [
        (target.solver, observation)
        for target, observation in seen
        if not isinstance(target.solver, BaselineSolver)
    ]
    return tasks


def _outcomes(
    seen: Sequence[Sighting],
    trials: Sequence[tuple[Trial, Sighting]],
    problems: Sequence[Problem | None],
) -> list[Outcome]:
    """Return what the targets of a scene made of it, and end what the trials cannot go on with."""
    for (trial, _), problem in zip(trials, problems, strict=False):
        if problem is not None:
            trial.evidence = -np.inf
    n_solvers = sum(not isinstance(target.solver, BaselineSolver) for target, _ in seen)
    own = iter(problems[len(problems) - n_solvers :])
    return [
        _outcome(
            target, observation, None if isinstance(target.solver, BaselineSolver) else next(own)
        )
        for target, observation in seen
    ]


def _expected(trials: Sequence[tuple[Trial, Sighting]]) -> list[tuple[Trial, Sighting]]:
    """Return the trials whose solvers are prepared for what they will take in."""
    splits: Splits = {}
    ready = []
    for trial, (target, observation) in trials:
        try:
            trial.solver.expect(observation, splits)
        except np.linalg.LinAlgError:
            trial.evidence = -np.inf
        else:
            ready.append((trial, (target, observation)))
    return ready


def _weigh(seen: Sequence[Sighting], trials: Sequence[tuple[Trial, Sighting]]) -> None:
    """Weigh the trials, and count what the targets of several stations do not explain."""
    weighed = [
        (trial, target, one, _rival(trial, target))
        for trial, (target, one) in trials
        if one.azimuths and trial.solver.state is not None
    ]
    joined = [
        (target, target.solver, one)
        for target, one in seen
        if one.azimuths
        and len(target.members) > 1
        and not isinstance(target.solver, BaselineSolver)
    ]
    tasks: list[Task] = []
    errors: list[LastingError] = []
    for trial, _, one, rival in weighed:
        tasks.append((trial.solver, one))
        errors.append(trial.error_of(one.sensor_id))
        if rival is not None:
            tasks.append((rival, one))
            errors.append(trial.error_alone(one.sensor_id))
    tasks += [(solver, one) for _, solver, one in joined]
    found = iter(weigh(tasks, errors + [NO_ERROR] * len(joined)))
    for trial, target, one, rival in weighed:
        chance, sensor = _chance(one), one.sensor_id
        trial.count(target)
        density, trial.errors[sensor] = _density(next(found), trial.error_of(sensor), chance)
        own = chance
        if rival is not None:
            error = trial.error_alone(sensor)
            own, trial.errors_alone[sensor] = _density(next(found), error, chance)
        trial.evidence += density - own
    for target, _, one in joined:
        target.weigh(one.sensor_id, next(found).log_likelihood)


def _rival(trial: Trial, target: FollowedTarget) -> TargetSolver | None:
    """Return what a trial is compared with: its target alone, where anything is known of it."""
    if target in trial.alone:
        solver = trial.alone[target]
        return solver if solver.state is not None else None
    own = target.solver
    return None if isinstance(own, BaselineSolver) or not target.solutions else own


def _density(explained: Weighed, error: LastingError, chance: float) -> tuple[float, LastingError]:
    """Return the log density of azimuths, and what is known of the station's error after them."""
    densities = (
        _log_density(explained.log_likelihood, chance),
        _log_density(explained.with_error, chance),
    )
    learnt = error.learnt(*densities, explained.innovation, explained.spread)
    return error.density(*densities), learnt


def _outcome(
    target: FollowedTarget, observation: TargetObservation, problem: Problem | None
) -> Outcome:
    if problem is not None:
        return problem
    try:
        if isinstance(target.solver, BaselineSolver):
            solutions = target.solver.update(observation)
        else:
            solutions = target.solver.solutions()
    except (InputError, np.linalg.LinAlgError) as error:
        return error
    return target.conclude(observation, solutions)


def _log_density(log_likelihood: float, chance: float) -> float:
    return float(np.logaddexp(_LOG_TAME + log_likelihood, _LOG_WILD + chance))


def _chance(observation: TargetObservation) -> float:
    """Return the log density of azimuths from anywhere; two stand for one angle of a cone."""
    return float(np.log(CHANCE_DENSITY * len(observation.azimuths)))
