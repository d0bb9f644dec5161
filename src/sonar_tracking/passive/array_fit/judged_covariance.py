"""The covariance in which the fit of an array is judged: enough snapshots for its elements."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass

import numpy as np

from sonar_tracking.filtering.eigenpairs import Eigenpairs
from sonar_tracking.geometry import is_uniform_line
from sonar_tracking.passive.array_fit.noise_evidence import NoiseEvidence
from sonar_tracking.passive.array_fit.noise_models import NoiseModel
from sonar_tracking.passive.sources.moving_source_counting import sample_covariance
from sonar_tracking.records.arrays import ComplexArray, FloatArray, IntArray

_SNAPSHOTS_PER_ELEMENT = 2

_FEWEST_ELEMENTS = 6
_MOST_ELEMENTS = 32
"""More show no more of a smooth colour, and cost the cube."""


@dataclass(frozen=True)
class JudgedCovariance:
    """A sample covariance that the fit of an array is judged by.

    Attributes
    ----------
    covariance : ndarray, shape (n_elements, n_elements), complex, or None
        Linear power; None = of more elements than are looked at singly.
    of_noise : ndarray, shape (size, size), complex
        The one the noise is judged by, linear power.
    n_snapshots : int
        Snapshots in it.
    positions : ndarray, shape (n_elements, 3)
        m.
    wavenumber : float
        rad/m.
    elements : ndarray of int, shape (n_elements,)
        Numbers of the elements in the whole array.
    noise : ndarray, shape (n_elements, n_elements), complex, or None
        Noise covariance that is known, pure numbers.
    model : NoiseModel or None
        Of the noise of the first ``size`` elements; None = it is known, or cannot be judged.
    eigenpairs : Eigenpairs or None
        Of ``covariance``, if they are known already.
    white : NoiseEvidence or None
        What it says at white noise, if that is known already.
    """

    covariance: ComplexArray | None
    of_noise: ComplexArray
    n_snapshots: int
    positions: FloatArray
    wavenumber: float
    elements: IntArray
    noise: ComplexArray | None
    model: NoiseModel | None
    eigenpairs: Eigenpairs | None = None
    white: NoiseEvidence | None = None

    @property
    def judged_whole(self) -> bool:
        """Whether the noise is judged by the covariance of all elements, of known eigenpairs."""
        return self.of_noise is self.covariance and self.eigenpairs is not None

    def kind(self, noise: ComplexArray | None) -> Hashable:
        """Return what covariances in which sources are sought together have in common.

        Parameters
        ----------
        noise : ndarray, shape (n_elements, n_elements), complex, or None
            Noise covariance, known or found, pure numbers; None = white.
        """
        array = (self.positions.tobytes(), self.elements.tobytes(), self.wavenumber)
        known = noise is None and self.eigenpairs is not None
        return (array, self.n_snapshots, noise is None, known)


def judged_size(positions: FloatArray, n_snapshots: int) -> int:
    """Return how many elements the fit is judged on, 0 = too few snapshots.

    Parameters
    ----------
    positions : ndarray, shape (n_elements, 3)
        Element positions, m.
    n_snapshots : int
        Snapshots in the covariance.
    """
    n_elements = len(positions)
    size = min(n_elements, _MOST_ELEMENTS, n_snapshots // _SNAPSHOTS_PER_ELEMENT)
    if size < _FEWEST_ELEMENTS or (size < n_elements and not is_uniform_line(positions)):
        return 0
    return size


def judged_covariance(snapshots: ComplexArray, size: int) -> ComplexArray:
    """Return the covariance of so many elements, of all sub-arrays of a longer line together.

    Parameters
    ----------
    snapshots : ndarray, shape (n_snapshots, n_elements), complex
        Linear amplitude.
    size : int
        Elements to judge: all, or those of a sub-array of a uniform line. The sub-arrays stand
        side by side, forward and backward.

    Returns
    -------
    ndarray, shape (size, size), complex
        Linear power.
    """
    n_elements = snapshots.shape[-1]
    if size == n_elements:
        return sample_covariance(snapshots)
    n_arrays = n_elements // size
    own = snapshots[:, : n_arrays * size].reshape(-1, size)
    forward = sample_covariance(own)
    return np.asarray(0.5 * (forward + forward[::-1, ::-1].conj()))
