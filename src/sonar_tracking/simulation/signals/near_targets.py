"""Targets that pass so near that their wavefronts are curved, while plane waves are simulated."""

from __future__ import annotations

import math

import numpy as np

from sonar_tracking.errors import Notice
from sonar_tracking.passive.near_field.spherical_steering import plane_wave_notice
from sonar_tracking.simulation.scenarios.kinematic_motion import KinematicMotion
from sonar_tracking.simulation.scenarios.scenario import Scenario

_STEP = 1.0
"""Between the instants that are looked at, s."""


def near_target_notices(scenario: Scenario) -> tuple[Notice, ...]:
    """Return a warning for each target that comes nearer than plane waves hold.

    Parameters
    ----------
    scenario : Scenario
        With an array; only targets that move in ``map`` have a range.
    """
    array = scenario.array
    positions, number = array.element_positions(), array.wavenumber()
    n_instants = max(2, math.ceil(scenario.duration / _STEP) + 1)
    times = scenario.start + np.linspace(0.0, scenario.duration, n_instants)
    own = scenario.own_ship.trajectory().state(times).position
    notices = []
    for index, target in enumerate(scenario.targets, start=1):
        present = target.is_heard(times)
        if not isinstance(target.motion, KinematicMotion) or not present.any():
            continue
        separation = target.motion.trajectory.state(times).position - own
        nearest = float(np.hypot(separation[:, 0], separation[:, 1])[present].min())
        name = target.name or f"target_{index}"
        notices.append(plane_wave_notice(nearest, positions, number, name))
    return tuple(notice for notice in notices if notice is not None)
