"""The strong sources in a covariance, and how well plane waves fit them.

The eigenvectors of eigenvalues that are large beside the noise, and not small beside the largest
one (motion and echoes bring such), lie in the span of as many steering vectors. What the valleys of
their null spectrum do not reach of zero, beyond the noise of the eigenvectors, is what the elements
differ from their description: with independent errors of relative variance e^2 each floor is e^2.

References
----------
A. L. Swindlehurst, T. Kailath (1992) for the model of the errors; T. W. Anderson, "Asymptotic
theory for principal component analysis", Ann. Math. Statist. 34(1), 1963, for the eigenvectors.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sonar_tracking.filtering.eigenpairs import Eigenpairs
from sonar_tracking.filtering.eigenpairs import eigenpairs as all_eigenpairs
from sonar_tracking.passive.directions.signal_subspace import noise_factor, whitened_covariance
from sonar_tracking.passive.sources.music import SHALLOWEST_VALLEY, valley_floors
from sonar_tracking.records.arrays import ComplexArray, FloatArray, IntArray

MOST_ELEMENTS = 64
"""Of an array whose elements are looked at singly: there are half the square of them."""

LEAST_FLOOR = 1e-3
"""Floor of a valley that is no fit: a rms error of 3 per cent."""

_OVER_NOISE = 8.0
"""The same, over what the noise of the eigenvectors leaves."""

_STRONG = 0.05
"""Eigenvalues of strong sources, over the largest one."""

_LEAST_RATIO = 30.0
"""Of the eigenvalue of a strong source to the noise."""


@dataclass(frozen=True)
class StrongSources:
    """Eigenvectors of the strong sources in a covariance.

    Attributes
    ----------
    vectors : ndarray, shape (n_elements, n_strong), complex
        Orthonormal, pure numbers.
    noise_floor : float
        What noise and weaker sources leave of their floors together, pure number: an eigenvector
        leans to each other one by lambda_i lambda_j / (N (lambda_i - lambda_j)^2), squared.
    positions : ndarray, shape (n_elements, 3)
        m.
    wavenumber : float
        rad/m.
    elements : ndarray of int, shape (n_elements,)
        Numbers of the elements in the whole array.
    angles : ndarray, shape (n_strong,)
        Of as many valleys as sources, rad.
    floors : ndarray, shape (n_strong,)
        Of the valleys, pure numbers.
    """

    vectors: ComplexArray
    noise_floor: float
    positions: FloatArray
    wavenumber: float
    elements: IntArray
    angles: FloatArray
    floors: FloatArray

    @cached_property
    def kind(self) -> Hashable:
        """What those that are dealt with together have in common: array, frequency and number."""
        return (self.vectors.shape, self.positions.tobytes(), self.wavenumber)

    @cached_property
    def floor(self) -> float:
        """Sum of the floors."""
        return float(self.floors.sum())

    @property
    def fits(self) -> bool:
        """Whether plane waves explain them within the noise."""
        return self.floor < LEAST_FLOOR * self.vectors.shape[-1] or not self.over_noise

    @property
    def over_noise(self) -> bool:
        """Whether the noise does not explain what the valleys do not reach of zero."""
        return self.floor > _OVER_NOISE * self.noise_floor

    @property
    def shallow(self) -> float:
        """Floor from which on a valley is none, pure number."""
        return SHALLOWEST_VALLEY

    @property
    def resolved(self) -> bool:
        """Whether each source has a valley."""
        return bool((self.floors < SHALLOWEST_VALLEY).all())

    def floors_of(self, vectors: ComplexArray, refined: bool) -> FloatArray:
        """Return the sums of the floors of other vectors.

        Parameters
        ----------
        vectors : ndarray, shape (n, n_elements, n_strong), complex
            Orthonormal, pure numbers.
        refined : bool
            Whether the valleys are sought to the floor, or on the grid only.

        Returns
        -------
        ndarray, shape (n,)
            Pure numbers.
        """
        floors = valley_floors(vectors, self.positions, self.wavenumber, refined)[1]
        return np.asarray(floors.sum(axis=-1))


def stacked_vectors(found: Sequence[StrongSources]) -> ComplexArray:
    """Return the eigenvectors of several of a kind, shape (n, n_elements, n_strong), pure numbers.

    Parameters
    ----------
    found : sequence of StrongSources
        Of the same array, equally many.
    """
    return np.stack([each.vectors for each in found])


def strong_sources(
    covariances: ComplexArray,
    n_snapshots: int,
    positions: FloatArray,
    wavenumber: float,
    elements: IntArray,
    noise_covariance: ComplexArray | None = None,
    eigenpairs: Eigenpairs | None = None,
) -> list[StrongSources | None]:
    """Return the strong sources in each of several covariances, None = none or too many.

    Parameters
    ----------
    covariances : ndarray, shape (n, n_elements, n_elements), complex
        Sample covariances, linear power.
    n_snapshots : int
        Snapshots in each, at least as many as elements.
    positions : ndarray, shape (n_elements, 3)
        m.
    wavenumber : float
        rad/m.
    elements : ndarray of int, shape (n_elements,)
        Numbers of the elements in the whole array.
    noise_covariance : ndarray, shape (..., n_elements, n_elements), complex, optional
        Of all or of each, pure numbers; None = white noise.
    eigenpairs : Eigenpairs, optional
        Of the covariances, if they are known already and the noise is white.
    """
    found: list[StrongSources | None] = [None] * len(covariances)
    n_elements = len(positions)
    if not 3 <= n_elements <= min(MOST_ELEMENTS, n_snapshots):
        return found
    factor = None if noise_covariance is None else noise_factor(noise_covariance)
    white = covariances if factor is None else whitened_covariance(covariances, factor)
    pairs = eigenpairs or all_eigenpairs(white)
    values, vectors = pairs.values[:, ::-1], pairs.vectors
    noise = np.maximum(values[:, n_elements // 2], np.finfo(float).tiny)
    least = np.maximum(_STRONG * values[:, -1], _LEAST_RATIO * noise)
    counts = np.count_nonzero(values >= least[:, None], axis=-1)
    for n_strong in range(1, n_elements // 3 + 1):
        rows = np.flatnonzero(counts == n_strong)
        if not len(rows):
            continue
        within, others = values[rows, -n_strong:, None], values[rows, None, :-n_strong]
        leaning = (within * others / (within - others) ** 2).reshape(len(rows), -1)
        left = leaning.sum(axis=-1) / n_snapshots
        leading = vectors[rows][..., :n_strong]
        if factor is not None:
            # C_v e_m = L v_m lie in the span of the steering vectors, e_m do not.
            own = factor if factor.ndim == 2 else factor[rows]
            leading = np.linalg.qr(own @ leading).Q
        angles, floors = valley_floors(leading, positions, wavenumber)
        for place, row in enumerate(rows.tolist()):
            valleys = (angles[place], floors[place])
            found[row] = StrongSources(
                leading[place], float(left[place]), positions, wavenumber, elements, *valleys
            )
    return found
