"""True angles at which a station hears targets, of many of its frames at once.

An instant by itself costs as much as a hundred together, and has the same angles.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.simulation.scenarios.platforms import Receiver
from sonar_tracking.simulation.scenarios.target import TargetConfiguration

FRAMES_AT_ONCE = 128


class ArrivalsAhead:
    """Angles of all targets, whether they are there or not, frame by frame.

    Parameters
    ----------
    targets : sequence of TargetConfiguration
        What the station listens to.
    receiver : Receiver
        The station; cones of a line array, azimuths in ``map`` of any other.
    times : ndarray, shape (n_frames,)
        Of its frames, s.
    """

    def __init__(
        self, targets: Sequence[TargetConfiguration], receiver: Receiver, times: FloatArray
    ) -> None:
        self._targets = tuple(targets)
        self._receiver = receiver
        self._times = times
        self._first = self._end = 0
        self._angles = self._rates = np.empty((0, len(self._targets)))

    def at(self, frame: int, rows: Sequence[int]) -> tuple[FloatArray, FloatArray]:
        """Return angles and their rates of some targets.

        Parameters
        ----------
        frame : int
            Its number, from 0.
        rows : sequence of int
            Numbers of the targets, from 0.

        Returns
        -------
        angle, rate : ndarray, shape (n_rows,)
            rad and rad/s.
        """
        if not self._first <= frame < self._end:
            self._look_ahead(frame)
        place = frame - self._first
        return self._angles[place, rows], self._rates[place, rows]

    def _look_ahead(self, frame: int) -> None:
        times = self._times[frame : frame + FRAMES_AT_ONCE]
        self._first, self._end = frame, frame + len(times)
        shape = (len(times), len(self._targets))
        self._angles, self._rates = np.empty(shape), np.empty(shape)
        for row, target in enumerate(self._targets):
            angles, rates = target.motion.arrival(times, self._receiver)
            self._angles[:, row], self._rates[:, row] = angles, rates
        if self._receiver.ambiguous:
            return
        state = self._receiver.trajectory.state(times)
        axis = state.azimuth + self._receiver.mounting_yaw
        self._angles = wrap_angle((axis + 0.5 * np.pi)[:, None] - self._angles)
        self._rates = state.turn_rate[:, None] - self._rates
