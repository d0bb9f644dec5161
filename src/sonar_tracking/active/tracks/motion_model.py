"""What the trackers of contacts ask of a motion model with interacting modes."""

from __future__ import annotations

from typing import Protocol

from sonar_tracking.records.arrays import FloatArray


class MotionModel(Protocol):
    """Modes of motion, each linear with white noise, between which a target changes by chance."""

    @property
    def n_modes(self) -> int:
        """Number of modes."""

    @property
    def mode_prior(self) -> FloatArray:
        """Return the mode probabilities of a new target, shape (n_modes,)."""

    @property
    def speed_deviation(self) -> FloatArray:
        """Return the speed per axis of a new target in each mode, shape (n_modes,), m/s."""

    @property
    def static_mode(self) -> int | None:
        """Return the mode of what is fixed; None if there is none."""

    @property
    def widest_mode(self) -> int | None:
        """Return the mode of the hardest manoeuvres; None if there are none to be looked for."""

    def transition(
        self, interval: float, entered: FloatArray, calm: FloatArray, pooled: FloatArray
    ) -> FloatArray:
        """Return Pi of each target over an interval, row = mode before.

        Parameters
        ----------
        interval : float
            s.
        entered : ndarray, shape (n, n_modes)
            How often each mode or a harder one has been entered, pure numbers.
        calm : ndarray, shape (n, n_modes)
            Time spent in moving modes calmer than each, s.
        pooled : ndarray, shape (2, n_modes) or (n, 2, n_modes)
            Both, of all confirmed targets of the scene together, pure numbers and s.

        Returns
        -------
        ndarray, shape (n, n_modes, n_modes) or (n_modes, n_modes)
            Probabilities; the latter if all targets are alike.
        """

    def matrices(self, velocity: FloatArray, interval: float) -> FloatArray:
        """Return F of each mode over an interval.

        Parameters
        ----------
        velocity : ndarray, shape (..., n_modes, 2)
            Before it, m/s.
        interval : float
            s.

        Returns
        -------
        ndarray, shape (..., n_modes, 4, 4) or (n_modes, 4, 4)
            For the state x, y, vx, vy; pure numbers, s and 1/s; the latter if all are alike.
        """

    def noise(self, velocity: FloatArray, interval: float) -> FloatArray:
        """Return Q of each mode over an interval.

        Parameters
        ----------
        velocity : ndarray, shape (..., n_modes, 2)
            Before it, m/s.
        interval : float
            s.

        Returns
        -------
        ndarray, shape (..., n_modes, 4, 4) or (4, 4)
            m^2, m^2/s, m^2/s^2; the latter if all are alike.
        """
