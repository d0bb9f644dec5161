"""Targets that move in the frame ``map``, heard with the propagation delay.

The sound received at t left the target at the emission time t_e. With p_a the array, p_t the
target, psi the azimuth of the array axis and r = |p_t(t_e) - p_a(t)|:

    alpha = azimuth of p_t(t_e) - p_a(t)
    theta = pi/2 - |alpha - psi|    (line array; without the modulus for any other array)
    dt_e/dt = (c + u . v_a) / (c + u . v_t),    u = (p_t(t_e) - p_a(t)) / r
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from sonar_tracking.configuration import SECTION, parameter
from sonar_tracking.motion import Path, emission_times, wrap_angle
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.simulation.scenarios.platforms import (
    Receiver,
    TurnConfiguration,
    make_trajectory,
)
from sonar_tracking.simulation.scenarios.wandering_path import WanderingPath


@dataclass(frozen=True)
class KinematicMotion:
    """Straight legs and turns in ``map``."""

    kind: str = parameter("kinematic", "kind of motion", choices=("kinematic",))
    position: tuple[float, ...] = parameter(
        (0.0, 1000.0), "x, y in map at scenario time 0", unit="m"
    )
    course_deg: float = parameter(0.0, "compass course until the first turn", unit="deg")
    speed: float = parameter(0.0, "constant speed", unit="m/s", minimum=0.0, maximum=100.0)
    acceleration: float = parameter(
        0.0,
        "standard deviation per axis of a random acceleration, new each second",
        unit="m/s^2",
        minimum=0.0,
        maximum=10.0,
    )
    acceleration_seed: int = parameter(1, "of the random acceleration", minimum=0)
    turns: tuple[TurnConfiguration, ...] = field(default=(), metadata=SECTION)

    @cached_property
    def trajectory(self) -> Path:
        """Motion of the target."""
        planned = make_trajectory(self.position, self.course_deg, self.speed, self.turns)
        if self.acceleration == 0.0:
            return planned
        return WanderingPath(planned, self.acceleration, self.acceleration_seed)

    def arrival(self, times: FloatArray, receiver: Receiver) -> tuple[FloatArray, FloatArray]:
        """Return the arrival angle at the array and its rate.

        Parameters
        ----------
        times : ndarray, shape (...)
            Of reception, s.
        receiver : Receiver
            The array.

        Returns
        -------
        angle, rate : ndarray, shape (...)
            rad from broadside, rad/s.
        """
        array = receiver.trajectory.state(times)
        emitted = emission_times(self.trajectory, array.position, times, receiver.sound_speed)
        source = self.trajectory.state(emitted)
        separation = source.position - array.position
        distance = np.maximum(np.hypot(separation[..., 0], separation[..., 1]), 1e-9)
        direction = separation / distance[..., None]

        axis = array.azimuth + receiver.mounting_yaw
        from_axis = wrap_angle(np.arctan2(separation[..., 1], separation[..., 0]) - axis)

        dilation = (receiver.sound_speed + np.sum(direction * array.velocity, axis=-1)) / (
            receiver.sound_speed + np.sum(direction * source.velocity, axis=-1)
        )
        relative = source.velocity * dilation[..., None] - array.velocity
        across = direction[..., 0] * relative[..., 1] - direction[..., 1] * relative[..., 0]
        azimuth_rate = across / distance - array.turn_rate
        if receiver.ambiguous:
            return np.pi / 2.0 - np.abs(from_axis), -np.sign(from_axis) * azimuth_rate
        return wrap_angle(np.pi / 2.0 - from_axis), -azimuth_rate
