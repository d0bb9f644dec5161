"""Parameters of the tracker that is told the truth: how the targets of a scene move."""

from __future__ import annotations

import numpy as np

from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.evaluation.studies.multi_target_clutter import scene as published

MEAN_TURN = float(np.radians(135.0))

SMALLEST_TOLD_ACCELERATION = 1e-4
"""m/s^2: that of targets that do not accelerate."""


def told_straight(speed: float, acceleration_deviation: float = 0.0) -> ContactTrackerConfiguration:
    """Return the parameters for targets that do not turn.

    Parameters
    ----------
    speed : float
        m/s.
    acceleration_deviation : float
        Per axis, m/s^2.
    """
    return ContactTrackerConfiguration(
        sound_speed=0.0,
        motion="straight",
        acceleration_deviation=max(acceleration_deviation, SMALLEST_TOLD_ACCELERATION),
        initial_speed_deviation=max(speed, 0.1) / float(np.sqrt(2.0)),
    )


def told_turning(
    speed: float, lateral_acceleration: float, interval: float, turns_a_ping: float
) -> ContactTrackerConfiguration:
    """Return the parameters for targets that turn by 90 to 180 degrees.

    Parameters
    ----------
    speed, lateral_acceleration : float
        m/s and m/s^2.
    interval : float
        Between pings, s.
    turns_a_ping : float
        That begin.
    """
    pings_of_a_turn = MEAN_TURN * speed / lateral_acceleration / interval
    return ContactTrackerConfiguration(
        sound_speed=0.0,
        motion="turning",
        acceleration_deviation=1e-3,
        lateral_acceleration=lateral_acceleration,
        initial_speed_deviation=speed / float(np.sqrt(2.0)),
        turn_probability=turns_a_ping,
        stay_probability=float(np.clip(1.0 - 1.0 / pings_of_a_turn, 0.34, 0.999)),
    )


TOLD_PUBLISHED = ContactTrackerConfiguration(
    sound_speed=0.0,
    motion="turning",
    acceleration_deviation=published.ACCELERATION_DEVIATION,
    lateral_acceleration=published.LATERAL_ACCELERATION,
    initial_speed_deviation=1.5,
    turn_probability=0.01,
    stay_probability=0.9,
)
"""What the paper of the scene tells, and what was chosen for it."""
