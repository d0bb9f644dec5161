"""How well solvers explain what stations observe next: what trials are weighed by."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sonar_tracking.tma.estimators.range_bank_state import RangeBankState
from sonar_tracking.tma.estimators.recursion import elapsed
from sonar_tracking.tma.targets.station_association import azimuth_log_likelihoods
from sonar_tracking.tma.targets.target_solver import TargetSolver, Task


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
    if not tasks:
        return []
    states = [_known_state(solver) for solver, _ in tasks]
    observations = [observation for _, observation in tasks]
    intervals = [
        elapsed(state.stamp, one.stamp) for state, one in zip(states, observations, strict=True)
    ]
    density = azimuth_log_likelihoods(
        [state.bank for state in states],
        np.array(intervals),
        np.array([solver.configuration.acceleration for solver, _ in tasks]),
        np.array([one.position for one in observations]),
        np.array([(*one.azimuths, np.nan)[:2] for one in observations]),
        np.array([one.azimuth_variance for one in observations])[:, None],
        tasks[0][0].configuration.gate,
        np.array([one.propagation_speed for one in observations]),
    )
    return [float(one) for one in np.logaddexp.reduce(density, axis=1)]


def _known_state(solver: TargetSolver) -> RangeBankState:
    assert solver.state is not None
    return solver.state
