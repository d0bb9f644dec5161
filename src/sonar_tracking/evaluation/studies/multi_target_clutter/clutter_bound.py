"""Cramer-Rao bound of tracking in clutter: the information of a ping times what clutter leaves.

    J+ = (F J^-1 F^T + Q)^-1 + q2 H^T R^-1 H,

along the true path, the turns known, with the information reduction factor q2 of P_D and of the
clutter in the gate of the bound itself. That of all targets of several runs is computed at once,
ping by ping.

References
----------
Tichavsky, Muravchik, Nehorai (1998); Hernandez, Farina, Ristic (2006) for the reduction factor.
"""

from __future__ import annotations

from collections.abc import Sequence

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
from sonar_tracking.records.contacts import Contacts
from sonar_tracking.simulation.sensors.contact_simulation import SimulatedPing

INITIAL_SPEED_DEVIATION = 1.5

_IDENTITIES = [identity for identity, *_ in TARGETS]


def position_bounds(
    options: SceneOptions, runs: Sequence[Sequence[SimulatedPing]], settled: int
) -> list[FloatArray]:
    """Return the bound of the square position error of all targets.

    Parameters
    ----------
    options : SceneOptions
        The scene.
    runs : sequence of sequence of SimulatedPing
        Pings of each run, equally many.
    settled : int
        Pings of each target that are left out at its start.

    Returns
    -------
    list of ndarray, shape (n,)
        sigma_x^2 + sigma_y^2, m^2, over targets and pings, of each run.
    """
    shape = (len(runs), len(TARGETS))
    state, covariance = np.zeros((*shape, 4)), np.zeros((*shape, 4, 4))
    bounds = np.full((*shape, len(runs[0])), np.nan)
    first = np.full(len(TARGETS), -1)
    for number, pings in enumerate(zip(*runs, strict=True)):
        contacts = pings[0].contacts
        there = np.isin(_IDENTITIES, pings[0].target_id)
        now = np.array([ping.state for ping in pings])
        goes_on = there & (first >= 0)
        matrix = _transition(options, number - 1, state)[:, goes_on]
        noise = white_acceleration_noise(ACCELERATION_DEVIATION, PING_INTERVAL)
        predicted = matrix @ covariance[:, goes_on] @ matrix.swapaxes(-1, -2) + noise
        state[:, there] = now
        covariance[:, goes_on] = _updated(predicted, contacts, state[:, goes_on])
        new = there & ~goes_on
        covariance[:, new] = _first_covariance(contacts, state[:, new])
        first[new] = number
        counted = goes_on & (number - first >= settled)
        bounds[:, counted, number] = (covariance[..., 0, 0] + covariance[..., 1, 1])[:, counted]
    return [own[np.isfinite(own)] for own in bounds]


def _transition(options: SceneOptions, ping: int, state: FloatArray) -> FloatArray:
    """Return F of each target after a ping, for states of shape (n_runs, n_targets, 4)."""
    sign = [
        0.0 if not (options.turns and turning(first, last, ping)) else 1.0 if name % 2 else -1.0
        for name, first, last, _ in TARGETS
    ]
    speed = np.hypot(state[..., 2], state[..., 3])
    rate = np.array(sign) * LATERAL_ACCELERATION / np.where(speed > 0.0, speed, 1.0)
    return turn_matrices(rate, PING_INTERVAL)


def _noise(contacts: Contacts, state: FloatArray) -> FloatArray:
    separation = state[..., :2].reshape(-1, 2) - np.array(contacts.sensor_position)
    distance = np.maximum(np.hypot(separation[:, 0], separation[:, 1]), 1e-3)
    noise = position_covariance(
        separation / distance[:, None],
        distance,
        contacts.range_standard_deviation,
        contacts.azimuth_standard_deviation,
    )
    return noise.reshape(*state.shape[:-1], 2, 2)


def _first_covariance(contacts: Contacts, state: FloatArray) -> FloatArray:
    covariance = np.zeros((*state.shape, 4)) + INITIAL_SPEED_DEVIATION**2 * np.eye(4)
    covariance[..., :2, :2] = _noise(contacts, state)
    return covariance


def _updated(covariance: FloatArray, contacts: Contacts, state: FloatArray) -> FloatArray:
    noise = _noise(contacts, state)
    area = np.pi * GATE_SIZE**2 * np.sqrt(np.linalg.det(covariance[..., :2, :2] + noise))
    density: FloatArray | float = contacts.clutter_density
    if not np.isfinite(density):
        cell = contacts.range_resolution * contacts.azimuth_resolution
        density = contacts.false_alarm_probability / (cell * np.hypot(state[..., 0], state[..., 1]))
    factor = information_reduction(contacts.detection_probability, density * area)
    information = np.linalg.inv(covariance)
    information[..., :2, :2] += factor[..., None, None] * np.linalg.inv(noise)
    return np.asarray(np.linalg.inv(information))
