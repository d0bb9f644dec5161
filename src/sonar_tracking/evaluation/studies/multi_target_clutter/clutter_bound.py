"""Cramer-Rao bound of tracking in clutter: the information of a ping times what clutter leaves.

    J+ = (F J^-1 F^T + Q)^-1 + q2 H^T R^-1 H,

along the true path, the turns known, with the information reduction factor q2 of P_D and of the
clutter in the gate of the bound itself.

References
----------
Tichavsky, Muravchik, Nehorai (1998); Hernandez, Farina, Ristic (2006) for the reduction factor.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from sonar_tracking.active.contacts.contact_positions import position_covariance
from sonar_tracking.active.detection.detection_threshold import GATE_SIZE
from sonar_tracking.active.detection.information_reduction import information_reduction
from sonar_tracking.active.tracks.motion_modes import turn_matrices, white_acceleration_noise
from sonar_tracking.evaluation.studies.multi_target_clutter.scene import (
    ACCELERATION_DEVIATION,
    LATERAL_ACCELERATION,
    PING_INTERVAL,
    TARGETS,
    SceneOptions,
    turning,
)
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.time import NANOSECONDS
from sonar_tracking.simulation.sensors.contact_simulation import SimulatedPing

INITIAL_SPEED_DEVIATION = 1.5


def position_bound(
    options: SceneOptions, pings: Sequence[SimulatedPing], settled: int
) -> FloatArray:
    """Return the bound of the square position error of all targets.

    Parameters
    ----------
    options : SceneOptions
        The scene.
    pings : sequence of SimulatedPing
        One run of it.
    settled : int
        Pings of each target that are left out at its start.

    Returns
    -------
    ndarray, shape (n,)
        sigma_x^2 + sigma_y^2, m^2, over targets and pings.
    """
    bounds = []
    for identity, first, last, _ in TARGETS:
        path = [
            (number, ping, ping.state[ping.target_id == identity][0])
            for number, ping in enumerate(pings)
            if identity in ping.target_id
        ]
        if not path:
            continue
        sign = 1.0 if identity % 2 else -1.0
        covariance = _first_covariance(*path[0][1:])
        for (before, _, state), (_, ping, now) in pairwise(path):
            turns = options.turns and turning(first, last, before)
            rate = sign * LATERAL_ACCELERATION / np.hypot(*state[2:]) if turns else 0.0
            matrix = turn_matrices(np.array(rate), PING_INTERVAL)
            noise = white_acceleration_noise(ACCELERATION_DEVIATION, PING_INTERVAL)
            covariance = _updated(matrix @ covariance @ matrix.T + noise, ping, now)
            if (
                ping.contacts.stamp - path[0][1].contacts.stamp
                >= settled * PING_INTERVAL * NANOSECONDS
            ):
                bounds.append(covariance[0, 0] + covariance[1, 1])
    return np.array(bounds)


def _noise(ping: SimulatedPing, state: FloatArray) -> FloatArray:
    separation = state[:2] - np.array(ping.contacts.sensor_position)
    distance = np.maximum(np.hypot(*separation), 1e-3)
    return position_covariance(
        separation[None] / distance,
        np.array([distance]),
        ping.contacts.range_standard_deviation,
        ping.contacts.azimuth_standard_deviation,
    )[0]


def _first_covariance(ping: SimulatedPing, state: FloatArray) -> FloatArray:
    covariance = INITIAL_SPEED_DEVIATION**2 * np.eye(4)
    covariance[:2, :2] = _noise(ping, state)
    return covariance


def _updated(covariance: FloatArray, ping: SimulatedPing, state: FloatArray) -> FloatArray:
    noise = _noise(ping, state)
    contacts = ping.contacts
    area = np.pi * GATE_SIZE**2 * np.sqrt(np.linalg.det(covariance[:2, :2] + noise))
    density = contacts.clutter_density
    if not np.isfinite(density):
        cell = contacts.range_resolution * contacts.azimuth_resolution * np.hypot(*state[:2])
        density = contacts.false_alarm_probability / cell
    factor = float(information_reduction(contacts.detection_probability, density * area))
    information = np.linalg.inv(covariance)
    information[:2, :2] += factor * np.linalg.inv(noise)
    return np.asarray(np.linalg.inv(information))
