"""Bearings in a covariance that belong to no track yet: what automatic starts are made of.

MUSIC looks for as many sources as there are by the count. A peak nearer than half a beamwidth to a
track belongs to that track. One whose power, orthogonal to all other bearings, does not stand out
of the noise is none: MUSIC finds a peak for every source asked for, there or not, and the
noise may be of another colour than it is taken for.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sonar_tracking.geometry import is_uniform_line, wavenumber
from sonar_tracking.passive.directions.sources_at_angles import (
    estimated_sources,
    fisher_variance,
    power_ratios,
    unresolved,
)
from sonar_tracking.passive.sources.mdl import smoothed_size
from sonar_tracking.passive.sources.music import music_bearings
from sonar_tracking.passive.sources.spatial_smoothing import forward_backward_smoothed
from sonar_tracking.records.arrays import BoolArray, ComplexArray, FloatArray
from sonar_tracking.records.bearings import SubspaceEstimates

LEAST_POWER_RATIO = 2.25
"""Power along a bearing over that of the noise: a source of -10.8 dB brings it to 15 elements.
Noise with an unknown correlation of 0.3 between neighbouring elements has 1.9 at broadside."""


def new_bearings(
    estimates: SubspaceEstimates,
    covariance: ComplexArray,
    n_sources: int,
    tracked_angles: FloatArray,
    smooth: bool,
) -> tuple[FloatArray, FloatArray]:
    """Return the MUSIC bearings that belong to no track yet, and their variances.

    Parameters
    ----------
    estimates : SubspaceEstimates
        Of a single run.
    covariance : ndarray, shape (n_elements, n_elements), complex
        Its covariance, linear power.
    n_sources : int
        How many sources there are, tracked ones included.
    tracked_angles : ndarray, shape (n_tracks,)
        Arrival angles of the tracks at the stamp, rad.
    smooth : bool
        Some may be coherent: look in the smoothed covariance, where their rank is restored.

    Returns
    -------
    angles, variances : ndarray, shape (n_bearings,)
        rad, rad^2.
    """
    positions = estimates.element_positions
    number = wavenumber(estimates.center_frequency, estimates.sound_speed)
    seen, noise, used = covariance, estimates.noise_covariance, positions
    size = smoothed_size(len(positions), estimates.covariance_snapshots)
    if smooth and n_sources < size and is_uniform_line(positions):
        seen, used = forward_backward_smoothed(covariance, size), positions[:size]
        noise = None if noise is None else forward_backward_smoothed(noise, size)
    angles = music_bearings(seen, n_sources, used, number, noise)
    still = np.zeros_like(angles)
    sources = estimated_sources(replace(estimates, covariance_time_offset=0.0), angles, still)
    variances = fisher_variance(estimates, angles, sources, float(estimates.covariance_snapshots))
    if len(angles) == 0 or sources is None:
        return np.empty(0), np.empty(0)
    free = np.asarray(~unresolved(angles, tracked_angles, estimates).any(axis=1))
    free[free] = _has_power(estimates, angles[free], tracked_angles)
    return angles[free], variances[free]


def _has_power(
    estimates: SubspaceEstimates, angles: FloatArray, tracked_angles: FloatArray
) -> BoolArray:
    """Return which of the free bearings bring power; those near each other are believed."""
    together = np.concatenate([angles, tracked_angles])[: len(estimates.element_positions) - 1]
    weak = power_ratios(estimates, together)[: len(angles)] < LEAST_POWER_RATIO
    close = unresolved(angles, together, estimates).sum(axis=1) > 1
    return np.asarray(close | ~np.append(weak, np.zeros(len(angles) - len(weak), dtype=bool)))
