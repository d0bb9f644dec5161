"""When the sound left its source that each element of the array receives.

The sound at element m and time t left a target in ``map`` at t_e, the root of
c (t - t_e) = |p_m(t) - p_target(t_e)|, so that delay, Doppler, wavefront curvature and the motion
of every element are exact. A target of which only the arrival angle theta is given is a plane
wave: t_e = t + (x_m sin theta + y_m cos theta) / c, without Doppler of its own.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.motion import emission_times
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.simulation.scenarios.kinematic_motion import KinematicMotion
from sonar_tracking.simulation.scenarios.platforms import Receiver
from sonar_tracking.simulation.scenarios.target import TargetMotion


def element_emission_times(
    motion: TargetMotion, receiver: Receiver, element_positions: FloatArray, times: FloatArray
) -> FloatArray:
    """Return the emission times of what the elements receive.

    Parameters
    ----------
    motion : TargetMotion
        Of the source.
    receiver : Receiver
        The array.
    element_positions : ndarray, shape (n_elements, 3)
        In the frame of the array, m.
    times : ndarray, shape (n_times,)
        Of reception, s.

    Returns
    -------
    ndarray, shape (n_times, n_elements)
        s.
    """
    if not isinstance(motion, KinematicMotion):
        angles, _ = motion.arrival(times, receiver)
        return plane_wave_emission_times(angles, receiver.sound_speed, element_positions, times)
    array = receiver.trajectory.state(times)
    axis = (array.azimuth + receiver.mounting_yaw)[:, None]
    x, y = element_positions[:, 0], element_positions[:, 1]
    offset = np.stack(
        [x * np.cos(axis) - y * np.sin(axis), x * np.sin(axis) + y * np.cos(axis)], axis=-1
    )
    received = np.broadcast_to(times[:, None], offset.shape[:-1])
    at_origin = emission_times(motion.trajectory, array.position, times, receiver.sound_speed)
    return emission_times(
        motion.trajectory,
        array.position[:, None] + offset,
        received,
        receiver.sound_speed,
        near=np.broadcast_to(at_origin[:, None], received.shape),
    )


def plane_wave_emission_times(
    angles: FloatArray, sound_speed: float, element_positions: FloatArray, times: FloatArray
) -> FloatArray:
    """Return the emission times of a plane wave, relative to the origin of the array.

    Parameters
    ----------
    angles : ndarray, shape (n_times,)
        Arrival angles, rad.
    sound_speed : float
        m/s.
    element_positions : ndarray, shape (n_elements, 3)
        m.
    times : ndarray, shape (n_times,)
        Of reception, s.

    Returns
    -------
    ndarray, shape (n_times, n_elements)
        s.
    """
    angles = np.broadcast_to(angles, times.shape)[:, None]
    x, y = element_positions[:, 0], element_positions[:, 1]
    return times[:, None] + (x * np.sin(angles) + y * np.cos(angles)) / sound_speed
