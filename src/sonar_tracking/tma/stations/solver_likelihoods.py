"""How well solvers explain what stations observe next: what trials are weighed by."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from sonar_tracking.tma.estimators.range_bank_state import RangeBankState
from sonar_tracking.tma.estimators.recursion import elapsed
from sonar_tracking.tma.stations.lasting_error import NO_ERROR, LastingError
from sonar_tracking.tma.stations.station_association import weigh_azimuths
from sonar_tracking.tma.targets.target_solver import TargetSolver, Task

SIDES = 2
"""Azimuths that one angle of a line array may have."""

SIGN_OF_SIDE = np.array([1.0, -1.0])
"""One error of a line array's angle turns the azimuth on its right the other way."""


class Weighed(NamedTuple):
    """The azimuths of an observation against a solver.

    Logs of their density, rad^-1, if the sensor has no lasting error, and if it has; -inf = outside
    the gate of every hypothesis. Innovation in the second case, rad, and its variance, rad^2; the
    variance is 0 where there is none.
    """

    log_likelihood: float
    with_error: float
    innovation: float
    spread: float


def log_likelihoods(tasks: Sequence[Task]) -> list[float]:
    """Return how well the azimuths of observations fit their solvers, before they are taken in.

    Parameters
    ----------
    tasks : sequence of Task
        Solvers that have had an azimuth; observations of whatever sensors, not older than the
        solver's last one, with azimuths. All with one gate.

    Returns
    -------
    list of float
        Log of the density of each, rad^-1; -inf = outside the gate of every hypothesis.
    """
    return [one.log_likelihood for one in weigh(tasks, [NO_ERROR] * len(tasks))]


def weigh(tasks: Sequence[Task], errors: Sequence[LastingError]) -> list[Weighed]:
    """Return the same, without and with the lasting errors of the sensors.

    Parameters
    ----------
    tasks : sequence of Task
        As there.
    errors : sequence of LastingError
        Of the sensor of each observation.
    """
    if not tasks:
        return []
    states = [_known_state(solver) for solver, _ in tasks]
    observations = [observation for _, observation in tasks]
    intervals = [
        elapsed(state.stamp, one.stamp) for state, one in zip(states, observations, strict=True)
    ]
    azimuths = np.array([(*one.azimuths, np.nan)[:2] for one in observations])
    variance = np.array([one.azimuth_variance for one in observations])
    shift = np.array([one.mean for one in errors])[:, None] * SIGN_OF_SIDE
    wider = variance + [one.variance for one in errors]
    found = weigh_azimuths(
        [state.bank for state in states],
        np.array(intervals),
        np.array([solver.configuration.acceleration for solver, _ in tasks]),
        np.array([one.position for one in observations]),
        np.concatenate([azimuths, azimuths - shift], axis=1),
        np.stack([variance, variance, wider, wider], axis=1),
        tasks[0][0].configuration.gate,
        np.array([one.propagation_speed for one in observations]),
    )
    plain, shifted = found.log_likelihood[:, :SIDES], found.log_likelihood[:, SIDES:]
    total = np.logaddexp.reduce(shifted, axis=1)
    known = np.isfinite(total)[:, None]
    share = np.exp(np.where(known, shifted - np.where(known, total[:, None], 0.0), -np.inf))
    columns = (
        np.logaddexp.reduce(plain, axis=1),
        total,
        np.sum(share * SIGN_OF_SIDE * found.innovation[:, SIDES:], axis=1),
        np.sum(share * found.spread[:, SIDES:], axis=1),
    )
    return [Weighed(*one) for one in zip(*(one.tolist() for one in columns), strict=True)]


def _known_state(solver: TargetSolver) -> RangeBankState:
    assert solver.state is not None
    return solver.state
