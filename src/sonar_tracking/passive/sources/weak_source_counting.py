"""Counting on several successive covariances: weak sources that one covariance does not show.

The mean of n covariances without common snapshots has n times the snapshots, and MDL sees sources
about 10 lg(n) / 2 dB weaker in it. But a source that turns by d meanwhile spreads over a second
eigenvalue p = s M (k d)^2 var(x) / 12 of its ratio s M to the noise. An eigenvalue is believed to
be a source only if it exceeds what the strongest one could have spread, with a margin of two:

    lambda / sigma^2 > (1 + 2 p)(1 + c / (2 p)),  c = M / N  (for 2 p < sqrt(c) MDL sees no spread),

the right-hand side being where N snapshots show an eigenvalue 1 + 2 p. Where p exceeds a half,
nothing is given: strong sources are counted on few snapshots
(:mod:`sonar_tracking.passive.sources.moving_source_counting`), and their echoes are not sought
here.

References
----------
M. Wax, T. Kailath (1985) for the criterion; J. Baik, J. Silverstein, "Eigenvalues of large sample
covariance matrices of spiked population models", J. Multivariate Analysis 97(6), 2006.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sonar_tracking.geometry import is_uniform_line, variance_along, wavenumber
from sonar_tracking.passive.directions.signal_subspace import noise_factor, whitened_covariance
from sonar_tracking.passive.sources.mdl import (
    signal_counts,
    smoothed_size,
)
from sonar_tracking.passive.sources.spatial_smoothing import forward_backward_smoothed
from sonar_tracking.records.arrays import ComplexArray, FloatArray, IntArray
from sonar_tracking.records.bearings import SubspaceEstimates
from sonar_tracking.records.time import seconds

COUNTED_TOGETHER = 4
"""Covariances in the longest mean that is counted on, if nothing else is said."""

_SNAPSHOTS_PER_ELEMENT = 2

_EPSILON, _TINY = float(np.finfo(float).eps), float(np.finfo(float).tiny)

_LARGEST_SPREAD = 1.0
"""Of a second eigenvalue by motion, with the margin, over the noise."""

_SURELY = 1.0 + 1e-6
"""Beyond all rounding."""


@dataclass(frozen=True)
class WeakSourceCounter:
    """Counts on the newest covariances that share no snapshots, oldest first.

    Attributes
    ----------
    middles : tuple of int
        Middle of the snapshots of each, ns.
    covariances : tuple of ndarray, shape (n_elements, n_elements), complex
        Linear power, all of as many snapshots.
    counted_together : int
        Most of them whose mean is counted on; so are the means of the last 1, 2, 4 and so on below.
    """

    middles: tuple[int, ...] = ()
    covariances: tuple[ComplexArray, ...] = ()
    counted_together: int = COUNTED_TOGETHER

    def add(self, middle: int, covariance: ComplexArray) -> WeakSourceCounter:
        """Return the counter with one more covariance, without those no longer counted on.

        After a change of the array the others are dropped.

        Parameters
        ----------
        middle : int
            Middle of its snapshots, ns.
        covariance : ndarray, shape (n_elements, n_elements), complex
            Linear power.
        """
        if self.covariances and self.covariances[-1].shape != covariance.shape:
            return replace(self, middles=(middle,), covariances=(covariance,))
        oldest = max(len(self.middles) + 1 - self.counted_together, 0)
        return replace(
            self,
            middles=(*self.middles[oldest:], middle),
            covariances=(*self.covariances[oldest:], covariance),
        )

    def count(self, estimates: SubspaceEstimates, maximum_rate: float) -> int:
        """Return how many sources there are at least, 0 if too few snapshots to tell.

        Parameters
        ----------
        estimates : SubspaceEstimates
            Array, frequency and noise; snapshots of each covariance.
        maximum_rate : float
            Fastest bearing that must not be counted twice, rad/s.
        """
        return int(counts_together([self], estimates, maximum_rate)[0])

    @property
    def ages(self) -> tuple[int, ...]:
        """How long before the newest covariance each was, ns."""
        return tuple(self.middles[-1] - middle for middle in self.middles)


def counts_together(
    counters: Sequence[WeakSourceCounter], estimates: SubspaceEstimates, maximum_rate: float
) -> IntArray:
    """Return how many sources there are at least in each of several runs.

    Parameters
    ----------
    counters : sequence of WeakSourceCounter
        One a run; their covariances are as many, as far apart.
    estimates : SubspaceEstimates
        Array, frequency and noise; snapshots of each covariance; of any of the runs.
    maximum_rate : float
        Fastest bearing that must not be counted twice, rad/s.

    Returns
    -------
    ndarray of int, shape (n_runs,)
        0 if too few snapshots to tell.
    """
    duration = estimates.covariance_snapshots * estimates.sample_period
    ages, counts = counters[0].ages, np.zeros(len(counters), dtype=np.int64)
    total, added, together = np.zeros((), dtype=np.complex128), 0, 1
    while together <= len(ages):
        for age in range(added + 1, together + 1):
            total = total + np.stack([counter.covariances[-age] for counter in counters])
        added = together
        mean = _MeanCovariances(
            total / together,
            together * estimates.covariance_snapshots,
            (seconds(ages[-together]) + duration) * maximum_rate,
            estimates,
        )
        counts = np.maximum(counts, mean.ranks())
        if is_uniform_line(estimates.element_positions):
            counts = np.maximum(counts, mean.smoothed_ranks())
        together *= 2
    return counts


def believed_sources(
    eigenvalues: NDArray[np.floating],
    n_snapshots: int,
    positions: FloatArray,
    number: float,
    largest_turn: float,
) -> IntArray:
    """Return the number of weak sources by MDL, without eigenvalues that motion may have spread.

    It is 0 where one is so strong that its motion hides weak ones.

    Parameters
    ----------
    eigenvalues : ndarray, shape (..., n_elements)
        Of the (whitened) covariance, linear power, descending.
    n_snapshots : int
        Snapshots in it.
    positions : ndarray, shape (n_elements, 3)
        m.
    number : float
        Wavenumber, rad/m.
    largest_turn : float
        Largest change of a bearing during the snapshots, rad.

    Returns
    -------
    ndarray of int, shape (...)
        One a covariance.
    """
    counts = signal_counts(eigenvalues, n_snapshots)
    n_elements = eigenvalues.shape[-1]
    signal = np.arange(n_elements) < counts[..., None]
    noise = (
        eigenvalues.sum(axis=-1, where=~signal, keepdims=True) / (n_elements - counts)[..., None]
    )
    ratios = eigenvalues / np.maximum(noise, eigenvalues[..., :1] * _EPSILON + _TINY)
    share = len(positions) / n_snapshots
    least = 2.0 * _spread_of_unit(positions, number, largest_turn) * ratios[..., :1]
    spread = least >= np.sqrt(share)
    believed = signal & (~spread | (least <= _LARGEST_SPREAD))
    if (believed & spread).any():
        # Where motion may show at all, what it may have spread is not counted.
        believed &= ~spread | (ratios > (1.0 + least) * (1.0 + share / np.maximum(least, _TINY)))
    return np.asarray(believed.sum(axis=-1))


def _spread_of_unit(positions: FloatArray, number: float, turn: float) -> float:
    """Return the second eigenvalue of a source that turns, over its first one."""
    return number**2 * variance_along(positions) * turn**2 / 12.0


@dataclass(frozen=True)
class _MeanCovariances:
    """Mean covariances of several runs, and how far a bearing may have turned in them, rad."""

    covariances: ComplexArray
    n_snapshots: int
    turn: float
    estimates: SubspaceEstimates

    def ranks(self) -> IntArray:
        """Return the number of weak sources in each, coherent ones counted as one."""
        positions, noise = self.estimates.element_positions, self.estimates.noise_covariance
        if self.n_snapshots < _SNAPSHOTS_PER_ELEMENT * len(positions):
            return np.zeros(len(self.covariances), dtype=np.int64)
        return self._believed(self.covariances, positions, noise)

    def smoothed_ranks(self) -> IntArray:
        """Return the number of weak sources, coherent or not, in each one of a uniform line."""
        positions, noise = self.estimates.element_positions, self.estimates.noise_covariance
        size = smoothed_size(len(positions), self.n_snapshots)
        smoothed = forward_backward_smoothed(self.covariances, size)
        colour = None if noise is None else forward_backward_smoothed(noise, size)
        return self._believed(smoothed, positions[:size], colour)

    def _believed(
        self, covariances: ComplexArray, positions: FloatArray, noise: ComplexArray | None
    ) -> IntArray:
        if noise is not None:
            covariances = whitened_covariance(covariances, noise_factor(noise))
        number = wavenumber(self.estimates.center_frequency, self.estimates.sound_speed)
        counts = np.zeros(len(covariances), dtype=np.int64)
        # Where even the least ratio that trace and norm allow spreads too far, none is believed
        # whatever the eigenvalues are; to find that costs a tenth of them.
        spread = _spread_of_unit(positions, number, self.turn) * least_ratios(covariances)
        most = max(_LARGEST_SPREAD, np.sqrt(len(positions) / self.n_snapshots))
        rows = np.flatnonzero(~(2.0 * spread > _SURELY * most))
        if rows.size:
            values = np.linalg.eigvalsh(covariances[rows])[:, ::-1]
            counts[rows] = believed_sources(values, self.n_snapshots, positions, number, self.turn)
        return counts


def least_ratios(covariances: ComplexArray) -> FloatArray:
    """Return what largest eigenvalues are at least, over the mean of any number of smallest ones.

    The largest is not below sum(lambda^2) / sum(lambda), the mean of the smallest not above that of
    all others.

    Parameters
    ----------
    covariances : ndarray, shape (n, n_elements, n_elements), complex
        Linear power.

    Returns
    -------
    ndarray, shape (n,)
        Pure numbers.
    """
    power = (covariances.real**2 + covariances.imag**2).sum(axis=(-2, -1))
    trace = np.maximum(np.trace(covariances, axis1=-2, axis2=-1).real, _TINY)
    largest = power / trace
    others = np.maximum(trace - largest, _EPSILON * trace) / (covariances.shape[-1] - 1)
    return np.asarray(largest / others)
