"""Scenarios of the tma-frequency-fusion study.

S1 is the paper's (Tables 1 and 2): own ship turns three times, and the turns alone make the range
observable. In S2 own ship goes straight on, so that only Doppler makes it observable; S3 is S2
with lines measured twenty times better.

References
----------
Cheong (2011), Tables 1 and 2 and Fig. 3. The schedule of the lines is not printed there.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.motion import azimuth_from_compass
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.simulation.sensors.tma_scene import TmaScene

N_FRAMES = 400
LEG_FRAMES = 100
OWN_SPEED = 6.0

SCHEDULE: dict[float, tuple[tuple[int, int], ...]] = {
    200.0: ((0, 120), (180, 400)),
    210.0: ((0, 400),),
    220.0: ((50, 235),),
    300.0: ((0, 90), (150, 400)),
    350.0: ((100, 400),),
    400.0: ((30, 130), (200, 400)),
}
"""Frames [first, past last) in which each line is present, by its frequency in Hz."""


def scenario(name: str) -> TmaScene:
    """Return S1, S2 or S3.

    Raises
    ------
    KeyError
        If there is no such scenario.
    """
    legs, deviation = {
        "S1": ((90.0, 0.0, 90.0, 0.0), 1.0),
        "S2": ((90.0,) * 4, 1.0),
        "S3": ((90.0,) * 4, 0.05),
    }[name]
    return scene_of_legs(legs, deviation)


def scene_of_legs(
    legs_deg: tuple[float, ...], frequency_deviation: float, acceleration: float = 0.01
) -> TmaScene:
    """Return the paper's target seen from own ship on legs of 100 frames.

    Parameters
    ----------
    legs_deg : tuple of float
        Compass course of each leg, degrees.
    frequency_deviation : float
        Of every line, Hz.
    acceleration : float
        Of the target, m/s^2.
    """
    course = azimuth_from_compass(np.repeat(np.asarray(legs_deg), LEG_FRAMES))
    velocity = OWN_SPEED * np.stack([np.cos(course), np.sin(course)], axis=-1)
    position = np.concatenate([np.zeros((1, 2)), np.cumsum(velocity, axis=0)[:-1]])
    n_frames = len(course)
    heard = np.zeros((n_frames, len(SCHEDULE)), dtype=bool)
    for column, spans in enumerate(SCHEDULE.values()):
        for first, past_last in spans:
            heard[first:past_last, column] = True
    return TmaScene(
        times=np.arange(n_frames, dtype=np.float64),
        sensor_position=position,
        sensor_velocity=velocity,
        target=np.array([4000.0, 3000.0, -3.0, 0.0]),
        line_frequency=np.array(list(SCHEDULE)),
        heard=heard,
        azimuth_deviation=float(np.radians(0.5)),
        frequency_deviation=frequency_deviation,
        acceleration=acceleration,
        commanded=np.zeros((n_frames, 2)),
    )


def polar(states: FloatArray, sensor_position: FloatArray) -> FloatArray:
    """Return range, azimuth, course azimuth and speed of states.

    Parameters
    ----------
    states : ndarray, shape (..., 4)
        x, y, vx, vy, m and m/s.
    sensor_position : ndarray, shape (..., 2)
        Where range and azimuth are seen from, m.

    Returns
    -------
    ndarray, shape (..., 4)
        m, rad, rad, m/s.
    """
    offset = states[..., :2] - sensor_position
    return np.stack(
        [
            np.hypot(offset[..., 0], offset[..., 1]),
            np.arctan2(offset[..., 1], offset[..., 0]),
            np.arctan2(states[..., 3], states[..., 2]),
            np.hypot(states[..., 2], states[..., 3]),
        ],
        axis=-1,
    )
