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

from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.geometry import is_uniform_line, variance_along, wavenumber
from sonar_tracking.passive.directions.signal_subspace import noise_factor
from sonar_tracking.passive.sources.mdl import (
    forward_backward_smoothed,
    minimum_description_length,
    smoothed_size,
)
from sonar_tracking.records.arrays import ComplexArray, FloatArray
from sonar_tracking.records.bearings import SubspaceEstimates
from sonar_tracking.records.time import seconds

COUNTED_TOGETHER = 4
"""Covariances in the longest mean that is counted on, if nothing else is said."""

_SNAPSHOTS_PER_ELEMENT = 2

_EPSILON = float(np.finfo(float).eps)

_LARGEST_SPREAD = 1.0
"""Of a second eigenvalue by motion, with the margin, over the noise."""


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
        duration = estimates.covariance_snapshots * estimates.sample_period
        line = is_uniform_line(estimates.element_positions)
        number = wavenumber(estimates.center_frequency, estimates.sound_speed)
        counts = [0]
        together = 1
        while together <= len(self.middles):
            mean = np.mean(self.covariances[-together:], axis=0)
            span = seconds(self.middles[-1] - self.middles[-together]) + duration
            turn = span * maximum_rate
            snapshots = together * estimates.covariance_snapshots
            counts.append(_rank(mean, estimates, snapshots, number, turn))
            if line:
                counts.append(_smoothed_rank(mean, estimates, snapshots, number, turn))
            together *= 2
        return max(counts)


def believed_sources(
    eigenvalues: FloatArray,
    n_snapshots: int,
    positions: FloatArray,
    number: float,
    largest_turn: float,
) -> int:
    """Return the number of weak sources by MDL, without eigenvalues that motion may have spread.

    It is 0 where one is so strong that its motion hides weak ones.

    Parameters
    ----------
    eigenvalues : ndarray, shape (n_elements,)
        Of the (whitened) covariance, linear power, descending.
    n_snapshots : int
        Snapshots in it.
    positions : ndarray, shape (n_elements, 3)
        m.
    number : float
        Wavenumber, rad/m.
    largest_turn : float
        Largest change of a bearing during the snapshots, rad.
    """
    count = minimum_description_length(eigenvalues, n_snapshots)
    if count == 0:
        return 0
    least_noise = float(eigenvalues[0]) * _EPSILON
    ratios = eigenvalues[:count] / max(float(eigenvalues[count:].mean()), least_noise)
    variance = variance_along(positions)
    spread = number**2 * variance * largest_turn**2 / 12.0 * float(ratios[0])
    share = len(positions) / n_snapshots
    least = 2.0 * spread
    if least < np.sqrt(share):
        return count
    if least > _LARGEST_SPREAD:
        return 0
    return int(np.count_nonzero(ratios > (1.0 + least) * (1.0 + share / least)))


def _rank(
    covariance: ComplexArray,
    estimates: SubspaceEstimates,
    n_snapshots: int,
    number: float,
    turn: float,
) -> int:
    """Return the number of weak sources in the covariance, coherent ones counted as one."""
    positions = estimates.element_positions
    if n_snapshots < _SNAPSHOTS_PER_ELEMENT * len(positions):
        return 0
    values = _eigenvalues(covariance, estimates.noise_covariance)
    return believed_sources(values, n_snapshots, positions, number, turn)


def _smoothed_rank(
    covariance: ComplexArray,
    estimates: SubspaceEstimates,
    n_snapshots: int,
    number: float,
    turn: float,
) -> int:
    """Return the number of weak sources, coherent or not, in the covariance of a uniform line."""
    positions, noise = estimates.element_positions, estimates.noise_covariance
    size = smoothed_size(len(positions), n_snapshots)
    smoothed = forward_backward_smoothed(covariance, size)
    colour = None if noise is None else forward_backward_smoothed(noise, size)
    values = _eigenvalues(smoothed, colour)
    return believed_sources(values, n_snapshots, positions[:size], number, turn)


def _eigenvalues(covariance: ComplexArray, noise_covariance: ComplexArray | None) -> FloatArray:
    """Return the eigenvalues of the whitened covariance, descending."""
    if noise_covariance is not None:
        factor = noise_factor(noise_covariance)
        half = np.linalg.solve(factor, covariance)
        covariance = np.asarray(np.linalg.solve(factor, half.conj().T), dtype=np.complex128)
    return np.asarray(np.linalg.eigvalsh(covariance)[::-1], dtype=np.float64)
