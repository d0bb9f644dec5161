"""A target that does not quite hold its course: random acceleration on top of a trajectory."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from sonar_tracking.motion import KinematicState, Path
from sonar_tracking.records.arrays import FloatArray, IndexArray

CHUNK = 1024
"""Seconds of acceleration drawn at a time."""


class WanderingPath:
    """A path with Gaussian acceleration, constant over each whole second, from time 0 on.

    What happens until some instant does not depend on how far anybody looks beyond it.

    Parameters
    ----------
    path : Path
        Where it would go.
    acceleration : float
        Standard deviation per axis, m/s^2.
    seed : int
        Of the random numbers.
    """

    def __init__(self, path: Path, acceleration: float, seed: int) -> None:
        self._path = path
        self._deviation = acceleration
        self._generator = np.random.default_rng(seed)
        self._acceleration = np.empty((0, 2))
        self._velocity = np.zeros((1, 2))
        self._position = np.zeros((1, 2))

    def state(self, times: ArrayLike) -> KinematicState:
        """Return the state at the given instants; the heading is that of the path.

        Parameters
        ----------
        times : array_like, shape (...)
            s; before time 0 there is no acceleration.
        """
        times = np.asarray(times, dtype=np.float64)
        while times.max(initial=0.0) >= len(self._acceleration):
            self._extend()
        base = self._path.state(times)
        second: IndexArray | int
        rest: FloatArray | float
        if times.ndim:
            since = np.maximum(times, 0.0)
            second = np.floor(since).astype(int)
            rest = (since - second)[..., None]
        else:  # one instant without arrays of one number, which would take most of the time
            moment = max(float(times), 0.0)
            second = int(moment)
            rest = moment - second
        acceleration = self._acceleration[second]
        velocity = self._velocity[second] + rest * acceleration
        position = self._position[second] + rest * 0.5 * (self._velocity[second] + velocity)
        return KinematicState(
            base.position + position, base.velocity + velocity, base.azimuth, base.turn_rate
        )

    def _extend(self) -> None:
        drawn = self._deviation * self._generator.standard_normal((CHUNK, 2))
        velocity = self._velocity[-1] + np.cumsum(drawn, axis=0)
        before = np.concatenate([self._velocity[-1:], velocity[:-1]])
        position = self._position[-1] + np.cumsum(0.5 * (before + velocity), axis=0)
        self._acceleration = np.concatenate([self._acceleration, drawn])
        self._velocity = np.concatenate([self._velocity, velocity])
        self._position = np.concatenate([self._position, position])
