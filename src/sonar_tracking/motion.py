"""Two-dimensional kinematics in the frame ``map``: straight legs, turns, propagation delay.

A platform moves at constant speed along straight legs joined by turns of constant rate, so that
its state at any instant has a closed form. Azimuths are radians anticlockwise from +x (east).

Sound takes time: what is received at t left the target at the emission time t_e, the root of::

    c (t - t_e) = |p_receiver(t) - p_target(t_e)|.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from sonar_tracking.records.arrays import FloatArray

NEWTON_STEPS = 4
"""Fixed number of steps: the result must not depend on how instants are grouped into arrays."""


def wrap_angle(angle: ArrayLike) -> FloatArray:
    """Return an angle, shape (...), brought into [-pi, pi), rad."""
    return np.mod(np.asarray(angle) + np.pi, 2.0 * np.pi) - np.pi


def wrapped(angle: float) -> float:
    """Return one angle brought into [-pi, pi), rad: the same as an array takes much longer."""
    return (angle + math.pi) % (2.0 * math.pi) - math.pi


def azimuth_from_compass(compass_deg: ArrayLike) -> FloatArray:
    """Return the azimuth, rad in [-pi, pi), of a compass angle, deg, shape (...)."""
    return wrap_angle(np.pi / 2.0 - np.radians(compass_deg))


def compass_from_azimuth(azimuth: ArrayLike) -> FloatArray:
    """Return the compass angle of an azimuth.

    Parameters
    ----------
    azimuth : array_like, shape (...)
        rad, anticlockwise from east.

    Returns
    -------
    ndarray, shape (...)
        deg, clockwise from north, in [0, 360).
    """
    return np.mod(90.0 - np.degrees(azimuth), 360.0)


def vector_from_compass(compass_deg: ArrayLike, length: ArrayLike) -> FloatArray:
    """Return the vector of a compass angle, e.g. the velocity of a course and a speed.

    Parameters
    ----------
    compass_deg : array_like, shape (...)
        deg, clockwise from north.
    length : array_like, shape (...)
        In any unit.

    Returns
    -------
    ndarray, shape (..., 2)
        East and north, in the unit of the length.
    """
    azimuth = azimuth_from_compass(compass_deg)
    return np.stack([length * np.cos(azimuth), length * np.sin(azimuth)], axis=-1)


def compass_from_vector(vector: ArrayLike) -> FloatArray:
    """Return the compass angle of a vector, e.g. the course of a velocity.

    Parameters
    ----------
    vector : array_like, shape (..., 2)
        East and north, in any unit.

    Returns
    -------
    ndarray, shape (...)
        deg, clockwise from north, in [0, 360).
    """
    east, north = np.moveaxis(np.asarray(vector, dtype=np.float64), -1, 0)
    return compass_from_azimuth(np.arctan2(north, east))


@dataclass(frozen=True)
class Turn:
    """A turn of constant rate to a new heading, the shorter way round.

    Attributes
    ----------
    time : float
        When it begins, s.
    azimuth : float
        New heading, rad.
    rate : float
        Magnitude of the turn rate, rad/s, positive.
    """

    time: float
    azimuth: float
    rate: float


def lever_arm(azimuth: float, ahead: float, port: float) -> FloatArray:
    """Return where a point aboard a platform is from the platform's reference, in ``map``.

    Parameters
    ----------
    azimuth : float
        Heading of the platform, rad.
    ahead, port : float
        Of the point ahead of the reference and to port of it, m.

    Returns
    -------
    ndarray, shape (2,)
        m.
    """
    cosine, sine = math.cos(azimuth), math.sin(azimuth)
    return np.array([cosine * ahead - sine * port, sine * ahead + cosine * port])


def swing_velocity(turn_rate: float, arm: FloatArray) -> FloatArray:
    """Return the velocity of a point off the turning point, across its lever arm.

    Parameters
    ----------
    turn_rate : float
        rad/s.
    arm : ndarray, shape (2,)
        From the turning point, in ``map``, m.

    Returns
    -------
    ndarray, shape (2,)
        m/s.
    """
    return turn_rate * np.array([-arm[1], arm[0]])


@dataclass(frozen=True)
class KinematicState:
    """State of a platform at one or several instants.

    Attributes
    ----------
    position, velocity : ndarray, shape (..., 2)
        In ``map``, m and m/s.
    azimuth, turn_rate : ndarray, shape (...)
        Heading, rad (not wrapped), and its rate, rad/s.
    """

    position: FloatArray
    velocity: FloatArray
    azimuth: FloatArray
    turn_rate: FloatArray


class Path(Protocol):
    """Anything that moves."""

    def state(self, times: ArrayLike) -> KinematicState:
        """Return the state at the given times, shape (...), s."""


class Trajectory:
    """Motion at constant speed along straight legs and turns.

    Parameters
    ----------
    position : sequence of float, shape (2,)
        At time 0, in ``map``, m.
    azimuth : float
        Heading until the first turn, rad.
    speed : float
        m/s.
    turns : sequence of Turn
        In ascending order of time, none before time 0. A turn may begin before the one ahead of
        it has ended; it then starts from the heading reached.
    """

    def __init__(
        self,
        position: Sequence[float],
        azimuth: float,
        speed: float,
        turns: Sequence[Turn] = (),
    ) -> None:
        self._speed = speed
        self._starts = np.array([0.0])
        self._positions = np.array([position], dtype=np.float64)
        self._azimuths = np.array([azimuth], dtype=np.float64)
        self._rates = np.array([0.0])
        self._look_up()
        for index, turn in enumerate(turns):
            following = turns[index + 1].time if index + 1 < len(turns) else np.inf
            self._append_turn(turn, following)

    def state(self, times: ArrayLike) -> KinematicState:
        """Return the state at the given instants.

        Parameters
        ----------
        times : array_like, shape (...)
            s; before time 0 the first leg is prolonged backwards.
        """
        times = np.asarray(times, dtype=np.float64)
        if times.ndim == 0:
            leg_at = max(bisect_right(self._begins, float(times)) - 1, 0)
            if self._rates[leg_at] == 0.0:
                return self._straight_state_at(leg_at, times)
        if (only := self._only_leg(times)) is not None:
            return self._straight_state(only, times)
        leg = np.maximum(np.searchsorted(self._starts, times, side="right") - 1, 0)
        elapsed, rate = times - self._starts[leg], self._rates[leg]
        azimuth = self._azimuths[leg] + rate * elapsed
        heading = mean_heading = _unit(azimuth)
        chord = self._speed * elapsed
        if rate.any():
            # The chord of an arc of angle w dt has length v dt sin(w dt / 2) / (w dt / 2) and
            # points along the mean heading; np.sinc has its limit at a straight leg built in.
            half_angle = 0.5 * rate * elapsed
            chord, mean_heading = chord * np.sinc(half_angle / np.pi), _unit(azimuth - half_angle)
        position = self._positions[leg] + chord[..., None] * mean_heading
        return KinematicState(position, self._speed * heading, azimuth, rate)

    def _only_leg(self, times: FloatArray) -> int | None:
        """Return the straight leg that all of several times lie in, if there is one."""
        if times.size < 2:
            return None
        ends = (times.min(), times.max()) if len(self._begins) > 1 else (0.0,)
        legs = {max(bisect_right(self._begins, end) - 1, 0) for end in ends}
        leg = legs.pop()
        return leg if not legs and self._rates[leg] == 0.0 else None

    def _straight_state_at(self, leg: int, time: FloatArray) -> KinematicState:
        """Return the state of a straight leg at one instant."""
        heading = self._headings[leg]
        position = self._positions[leg] + self._speed * (time - self._starts[leg]) * heading
        velocity = self._speed * heading
        return KinematicState(position, velocity, self._azimuths[leg], self._rates[leg])

    def _along(self, leg: int, times: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return x and y on a straight leg, and the velocity of all of it."""
        heading, start = self._own_headings[leg], self._positions[leg]
        chord = self._speed * (times - self._starts[leg])
        return start[0] + chord * heading[0], start[1] + chord * heading[1], self._speed * heading

    def _straight_state(self, leg: int, times: FloatArray) -> KinematicState:
        """Return the states of one straight leg, which has one heading."""
        position = np.empty((*times.shape, 2))  # an inner loop over two numbers would cost more
        position[..., 0], position[..., 1], velocity = self._along(leg, times)
        velocities = np.broadcast_to(velocity, position.shape)
        azimuths = np.broadcast_to(self._azimuths[leg], times.shape)
        return KinematicState(position, velocities, azimuths, np.zeros(times.shape))

    def _append_turn(self, turn: Turn, following: float) -> None:
        begin = self.state(turn.time)
        change = float(wrap_angle(turn.azimuth - begin.azimuth))
        self._append_leg(turn.time, float(np.sign(change)) * turn.rate)
        end_time = turn.time + abs(change) / turn.rate
        if end_time < following:
            self._append_leg(end_time, 0.0)

    def _append_leg(self, start: float, rate: float) -> None:
        begin = self.state(start)
        self._starts = np.append(self._starts, start)
        self._positions = np.vstack([self._positions, begin.position])
        self._azimuths = np.append(self._azimuths, begin.azimuth)
        self._rates = np.append(self._rates, rate)
        self._look_up()

    def _look_up(self) -> None:
        """Keep what an instant is looked up in: beginnings of the legs and their headings."""
        self._begins = self._starts.tolist()
        self._headings = _unit(self._azimuths)
        self._own_headings = [_unit(azimuth) for azimuth in self._azimuths]


def emission_times(
    target: Path,
    receiver_positions: ArrayLike,
    reception_times: ArrayLike,
    sound_speed: float,
    near: ArrayLike | None = None,
) -> FloatArray:
    """Return when the sound left the target that is received at the given instants.

    Newton's iteration on the delay; the error after each step is of order (v/c)^2 of the one
    before, so that four steps reach rounding for any target slower than sound.

    Parameters
    ----------
    target : Path
        The source, slower than ``sound_speed``.
    receiver_positions : array_like, shape (..., 2)
        Receiver at the reception times, m.
    reception_times : array_like, shape (...)
        s.
    sound_speed : float
        m/s.
    near : array_like, shape (...), optional
        Emission times for receivers some metres away, which save half of the steps, s.

    Returns
    -------
    ndarray, shape (...)
        Emission times, s.
    """
    receiver_positions = np.asarray(receiver_positions, dtype=np.float64)
    times = np.asarray(reception_times, dtype=np.float64)
    delay = np.zeros_like(times) if near is None else times - np.asarray(near)
    for _ in range(NEWTON_STEPS if near is None else NEWTON_STEPS // 2):
        place_x, place_y, velocity = _moved(target, times - delay)
        x, y = place_x - receiver_positions[..., 0], place_y - receiver_positions[..., 1]
        distance = np.hypot(x, y)
        range_rate = (x * velocity[..., 0] + y * velocity[..., 1]) / np.maximum(distance, 1e-9)
        delay = delay + (distance - sound_speed * delay) / (sound_speed + range_rate)
    return times - delay


def _moved(path: Path, times: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return x, y and velocity; the latter once where it is that of all times."""
    if isinstance(path, Trajectory) and (leg := path._only_leg(times)) is not None:
        return path._along(leg, times)
    state = path.state(times)
    return state.position[..., 0], state.position[..., 1], state.velocity


def _unit(azimuth: FloatArray) -> FloatArray:
    unit = np.empty((*np.shape(azimuth), 2))
    unit[..., 0] = np.cos(azimuth)
    unit[..., 1] = np.sin(azimuth)
    return unit
