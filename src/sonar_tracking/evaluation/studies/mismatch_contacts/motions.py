"""How the targets move: tables of states, one row a ping.

All tables have shape (n_pings, n_targets, 4): x, y, vx, vy in m and m/s. Targets that should not
meet have lanes or quarters of the survey of their own.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.motion import Trajectory, Turn, wrap_angle
from sonar_tracking.records.arrays import FloatArray

LANES = np.array([-0.6, -0.2, 0.2, 0.6])
"""Distance of parallel courses from the centre, as a share of the radius of the survey."""

SLOW_SPREAD = 0.6
"""Share of the radius within which ships are in the middle of the run."""

QUARTERS = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
QUARTER_DISTANCE = 0.45
"""Centres of the quarters, as a share of the radius along both axes."""

SMALLEST_TURN, LARGEST_TURN = np.radians([90.0, 179.0])


def parallel_lanes(
    times: FloatArray, speed: float, radius: float, generator: np.random.Generator
) -> FloatArray:
    """Return ships on parallel lanes, either way, all turned by one random angle.

    Parameters
    ----------
    times : ndarray, shape (n_pings,)
        s.
    speed : float
        m/s.
    radius : float
        Of the survey, m.
    generator : numpy.random.Generator
        Of the places.

    Returns
    -------
    ndarray, shape (n_pings, n_targets, 4)
        x, y, vx, vy, m and m/s.
    """
    n_ships = len(LANES)
    way = generator.choice([-1.0, 1.0], n_ships)
    reach = max(0.0, SLOW_SPREAD * radius - 0.5 * speed * float(times[-1]))
    middle = generator.uniform(-reach, reach, n_ships)
    state = np.zeros((len(times), n_ships, 4))
    state[..., 0] = middle + way * speed * (times - 0.5 * times[-1])[:, None]
    state[..., 1] = radius * (LANES + generator.uniform(-0.05, 0.05, n_ships))
    state[..., 2] = way * speed
    return turned(state, generator.uniform(0.0, 2.0 * np.pi))


def turning_paths(
    times: FloatArray,
    speed: float,
    lateral_acceleration: float,
    n_turns: int,
    radius: float,
    generator: np.random.Generator,
) -> FloatArray:
    """Return boats that each turn about their quarter: straight, 90 to 180 degrees, straight.

    Parameters
    ----------
    times : ndarray, shape (n_pings,)
        s.
    speed, lateral_acceleration : float
        m/s and, in a turn, m/s^2.
    n_turns : int
        All to the same side.
    radius : float
        Of the survey, m.
    generator : numpy.random.Generator
        Of courses, instants and angles.

    Returns
    -------
    ndarray, shape (n_pings, n_targets, 4)
        x, y, vx, vy, m and m/s.
    """
    paths = []
    for quarter in QUARTERS:
        part = float(times[-1]) / (n_turns + 1)
        starts = part * (np.arange(n_turns) + 0.5 + generator.uniform(-0.1, 0.1, n_turns))
        side = generator.choice([-1.0, 1.0])
        course = generator.uniform(-np.pi, np.pi)
        courses = course + side * np.cumsum(generator.uniform(SMALLEST_TURN, LARGEST_TURN, n_turns))
        rate = lateral_acceleration / speed
        turns = [
            Turn(float(start), float(wrap_angle(new)), rate)
            for start, new in zip(starts, courses, strict=True)
        ]
        motion = Trajectory((0.0, 0.0), course, speed, turns).state(times)
        paths.append(np.hstack([motion.position, motion.velocity]))
        paths[-1][:, :2] += QUARTER_DISTANCE * radius * quarter - np.mean(motion.position, axis=0)
    return np.stack(paths, axis=1)


def random_walks(
    times: FloatArray,
    speed: float,
    acceleration_deviation: float,
    radius: float,
    generator: np.random.Generator,
) -> FloatArray:
    """Return ships with white acceleration, constant from ping to ping, one a quarter.

    Parameters
    ----------
    times : ndarray, shape (n_pings,)
        At equal intervals, s.
    speed : float
        At the start, m/s.
    acceleration_deviation : float
        Per axis, m/s^2.
    radius : float
        Of the survey, m.
    generator : numpy.random.Generator
        Of courses and accelerations.

    Returns
    -------
    ndarray, shape (n_pings, n_targets, 4)
        x, y, vx, vy, m and m/s.
    """
    n_pings, n_ships = len(times), len(QUARTERS)
    interval = float(times[1] - times[0])
    course = generator.uniform(0.0, 2.0 * np.pi, n_ships)
    acceleration = acceleration_deviation * generator.standard_normal((n_pings, n_ships, 2))
    velocity = speed * np.stack([np.cos(course), np.sin(course)], axis=-1)
    velocity = velocity + interval * _summed_before(acceleration)
    position = _summed_before(interval * velocity + 0.5 * interval**2 * acceleration)
    position += QUARTER_DISTANCE * radius * QUARTERS - np.mean(position, axis=0)
    return np.concatenate([position, velocity], axis=-1)


def convoy(
    times: FloatArray,
    speed: float,
    spacing: float,
    distance: float,
    n_ships: int,
    generator: np.random.Generator,
) -> FloatArray:
    """Return ships one behind the other that pass the origin, nearest in the middle of the run.

    Parameters
    ----------
    times : ndarray, shape (n_pings,)
        s.
    speed, spacing : float
        m/s and, from ship to ship, m.
    distance : float
        At which they pass, m.
    n_ships : int
        Of the convoy.
    generator : numpy.random.Generator
        Of its course.

    Returns
    -------
    ndarray, shape (n_pings, n_targets, 4)
        x, y, vx, vy, m and m/s.
    """
    state = np.zeros((len(times), n_ships, 4))
    places = spacing * (np.arange(n_ships) - 0.5 * (n_ships - 1))
    state[..., 0] = places + speed * (times - 0.5 * times[-1])[:, None]
    state[..., 1] = distance
    state[..., 2] = speed
    return turned(state, generator.uniform(0.0, 2.0 * np.pi))


def crossing(
    times: FloatArray,
    speed: float,
    distance: float,
    n_ships: int,
    generator: np.random.Generator,
) -> FloatArray:
    """Return ships from all sides that are at one point in the middle of the run.

    Parameters
    ----------
    times : ndarray, shape (n_pings,)
        s.
    speed : float
        m/s.
    distance : float
        Of the point from the origin, m.
    n_ships : int
        Their courses differ by equal angles, give or take a quarter of it.
    generator : numpy.random.Generator
        Of place and courses.

    Returns
    -------
    ndarray, shape (n_pings, n_targets, 4)
        x, y, vx, vy, m and m/s.
    """
    bearing = generator.uniform(0.0, 2.0 * np.pi)
    share = np.arange(n_ships) + generator.uniform(-0.25, 0.25, n_ships)
    course = 2.0 * np.pi * share / n_ships
    velocity = speed * np.stack([np.cos(course), np.sin(course)], axis=-1)
    elapsed = (times - 0.5 * times[-1])[:, None, None]
    point = distance * np.array([np.cos(bearing), np.sin(bearing)])
    return np.concatenate(
        [point + elapsed * velocity, np.broadcast_to(velocity, (len(times), n_ships, 2))], axis=-1
    )


def wharf(
    times: FloatArray,
    boat_speed: float,
    centre: tuple[float, float],
    n_reflectors: int,
    spacing: float,
    passing_distance: float,
    generator: np.random.Generator,
) -> FloatArray:
    """Return reflectors at rest in a row from west to east, and last a boat that passes them.

    Parameters
    ----------
    times : ndarray, shape (n_pings,)
        s.
    boat_speed : float
        m/s.
    centre : tuple of float
        Of the row, m.
    n_reflectors : int
        Of the row.
    spacing, passing_distance : float
        Between the reflectors, and of the boat from the row, m.
    generator : numpy.random.Generator
        Of the boat's way: east or west.

    Returns
    -------
    ndarray, shape (n_pings, n_targets, 4)
        x, y, vx, vy, m and m/s.
    """
    way = generator.choice([-1.0, 1.0])
    state = np.zeros((len(times), n_reflectors + 1, 4))
    state[..., :2] = centre
    state[:, :-1, 0] += spacing * (np.arange(n_reflectors) - 0.5 * (n_reflectors - 1))
    state[:, -1, 0] += way * boat_speed * (times - 0.5 * times[-1])
    state[:, -1, 1] -= passing_distance
    state[:, -1, 2] = way * boat_speed
    return state


def within(state: FloatArray, centre: FloatArray, radius: float) -> FloatArray:
    """Return states with NaN where a target is out of reach.

    Parameters
    ----------
    state : ndarray, shape (n_pings, n_targets, 4)
        m and m/s.
    centre : ndarray, shape (n_pings, 2)
        Where the sensor is, m.
    radius : float
        Of its survey, m.

    Returns
    -------
    ndarray, shape (n_pings, n_targets, 4)
        x, y, vx, vy, m and m/s.
    """
    away = state[..., :2] - centre[:, None]
    there = np.hypot(away[..., 0], away[..., 1]) <= radius
    return np.where(there[..., None], state, np.nan)


def turned(state: FloatArray, angle: float) -> FloatArray:
    """Return states, shape (..., 4), m and m/s, turned about the origin by an angle, rad."""
    cosine, sine = np.cos(angle), np.sin(angle)
    rotation = np.array([[cosine, sine], [-sine, cosine]])
    return np.concatenate([state[..., :2] @ rotation, state[..., 2:] @ rotation], axis=-1)


def _summed_before(steps: FloatArray) -> FloatArray:
    """Return the sum of the steps before each one, along the first axis."""
    return np.concatenate([np.zeros_like(steps[:1]), np.cumsum(steps[:-1], axis=0)])
