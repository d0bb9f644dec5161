"""Band-limited Gaussian noise that can be read at any rising instants.

White numbers on a regular grid are interpolated by a sinc under a Kaiser window, so that a moving
source is heard with its exact delay at every element, and with the Doppler that follows from it.
The spectrum is flat up to 0.85 of half the rate. ``compiled_waveform`` interpolates if a compiler
was there when the package was installed; the bits are those of the coding in numpy.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.compiled_modules import compiled_module
from sonar_tracking.records.arrays import FloatArray

COMPILED = compiled_module("simulation.signals.compiled_waveform")
"""The compiled function, None where there is none."""

_REACH = 16
"""Grid points on either side of an instant that its value is made from."""

_KAISER_SHAPE = 8.0
_PHASES = 4096
"""Steps of the kernel's table between two grid points: a phase error below 4e-4 rad."""


def _kernel_table() -> FloatArray:
    offsets = np.arange(1 - _REACH, _REACH + 1) - np.arange(_PHASES + 1)[:, None] / _PHASES
    inside = np.sqrt(np.maximum(1.0 - (offsets / _REACH) ** 2, 0.0))
    return np.asarray(np.sinc(offsets) * np.i0(_KAISER_SHAPE * inside) / np.i0(_KAISER_SHAPE))


_TABLE = _kernel_table()


class BroadbandWaveform:
    """Noise of variance 1 emitted by one source.

    Parameters
    ----------
    generator : numpy.random.Generator
        Of the numbers on the grid; drawn in the order of time, whatever instants are asked for.
    rate : float
        Of the grid, Hz.
    """

    def __init__(self, generator: np.random.Generator, rate: float) -> None:
        self._generator = generator
        self._rate = rate
        self._first = 0
        self._grid: FloatArray | None = None

    def at(self, times: FloatArray) -> FloatArray:
        """Return the noise at the given instants.

        Parameters
        ----------
        times : ndarray, shape (...)
            s; the earliest not before the earliest of the call before.

        Returns
        -------
        ndarray, shape (...)
            Linear amplitude, variance 1.
        """
        steps = np.asarray(times * self._rate, order="C")
        first, last = (int(np.floor(step)) for step in (steps.min(), steps.max()))
        grid = self._provide(first - _REACH, last + _REACH + 1)
        if COMPILED is None:
            return _interpolated(grid, self._first, steps)
        noise = np.empty_like(steps)
        COMPILED.interpolate(grid, _TABLE, steps, noise, (self._first, _PHASES, 2 * _REACH))
        return noise

    def _provide(self, first: int, last: int) -> FloatArray:
        """Return the grid points from first to last; forget earlier ones."""
        if self._grid is None:
            self._grid, self._first = np.empty(0), first
        missing = last + 1 - self._first - len(self._grid)
        drawn = self._generator.standard_normal(max(missing, 0))
        self._grid = np.concatenate([self._grid, drawn])[first - self._first :]
        self._first = first
        return self._grid


def _interpolated(grid: FloatArray, first: int, steps: FloatArray) -> FloatArray:
    """Return the noise at some steps, from a grid whose first point is at step ``first``."""
    whole = np.floor(steps)
    begin = whole.astype(np.int64) + 1 - _REACH - first
    kernel = _TABLE.T[:, np.rint((steps - whole) * _PHASES).astype(np.int64)]
    noise = grid[begin] * kernel[0]
    for tap in range(1, 2 * _REACH):
        noise += grid[begin + tap] * kernel[tap]
    return noise
