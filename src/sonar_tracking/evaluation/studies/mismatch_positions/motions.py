"""How targets of the study move, and own ship: changes of velocity, frame by frame."""

from __future__ import annotations

import numpy as np

from sonar_tracking.evaluation.studies.tma_frequency_fusion.scenarios import scenario
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.simulation.sensors.tma_scene import TmaScene

N_FRAMES = 600
"""Of the scenes in which a target turns, 1 s apart."""

FIRST_LEG, SECOND_LEG = 100, 200
"""Frames at which own ship changes its course by 90 degrees, and changes back."""

TURN_START = 330
"""Frame at which the target begins to turn, with own ship straight for 130 s."""

TURN_DEG = 90.0

OWN_SPEED = 6.0


def turn(velocity: FloatArray, rate_deg: float, n_frames: int) -> FloatArray:
    """Return the changes of velocity of a turn by 90 degrees.

    Parameters
    ----------
    velocity : ndarray, shape (2,)
        Before, m/s.
    rate_deg : float
        Of turn, anticlockwise, degrees a frame.
    n_frames : int
        Of the scene.

    Returns
    -------
    ndarray, shape (n_frames, 2)
        m/s.
    """
    steps = round(TURN_DEG / abs(rate_deg))
    angle = np.radians(rate_deg) * np.arange(steps + 1)
    x, y = velocity
    turned = np.stack(
        [x * np.cos(angle) - y * np.sin(angle), x * np.sin(angle) + y * np.cos(angle)], axis=1
    )
    changes = np.zeros((n_frames, 2))
    changes[TURN_START : TURN_START + steps] = np.diff(turned, axis=0)
    return changes


def zigzag(
    velocity: FloatArray, angle_deg: float, interval: int, n_frames: int, first: int, side: int
) -> FloatArray:
    """Return the changes of velocity of a zig-zag about a mean course.

    Parameters
    ----------
    velocity : ndarray, shape (2,)
        Along the mean course, m/s.
    angle_deg : float
        Between the two courses, degrees.
    interval : int
        Frames from one turn to the next.
    n_frames : int
        Of the scene.
    first : int
        Frame of the first turn.
    side : int
        1 = to port at first, -1 = to starboard.

    Returns
    -------
    ndarray, shape (n_frames, 2)
        m/s.
    """
    speed, course = np.hypot(*velocity), np.arctan2(velocity[1], velocity[0])
    changes, now = np.zeros((n_frames, 2)), np.array(velocity)
    for frame in range(first, n_frames - 1, interval):
        angle = course + side * np.radians(0.5 * angle_deg)
        after = speed * np.array([np.cos(angle), np.sin(angle)])
        changes[frame], now = after - now, after
        side = -side
    return changes


def turning_scene(own_ship_turns: bool, rate_deg: float, lines: int) -> TmaScene:
    """Return the published target with a turn by 90 degrees, seen for ten minutes.

    Parameters
    ----------
    own_ship_turns : bool
        At 100 and 200 s; it goes straight while the target turns in any case.
    rate_deg : float
        Of the target's turn, anticlockwise, degrees per second.
    lines : int
        0, 1 or 4 tonals, with a deviation of 0.1 Hz.
    """
    frames = np.arange(N_FRAMES)
    across = own_ship_turns & (frames >= FIRST_LEG) & (frames < SECOND_LEG)
    course = np.where(across, 0.5 * np.pi, 0.0)
    velocity = OWN_SPEED * np.stack([np.cos(course), np.sin(course)], axis=-1)
    position = np.concatenate([np.zeros((1, 2)), np.cumsum(velocity, axis=0)[:-1]])
    published = scenario("S1")
    return TmaScene(
        times=frames.astype(np.float64),
        sensor_position=position,
        sensor_velocity=velocity,
        target=published.target,
        line_frequency=np.array([210.0, 200.0, 300.0, 350.0])[: max(lines, 1)],
        heard=np.full((N_FRAMES, max(lines, 1)), lines > 0),
        azimuth_deviation=published.azimuth_deviation,
        frequency_deviation=0.1,
        acceleration=0.01,
        commanded=turn(published.target[2:], rate_deg, N_FRAMES),
    )
