"""Bearing and range of near sources from one covariance: MUSIC and maximum likelihood.

Both look at steering vectors on a grid of bearings and of curvatures 1 / range, in which the array
is equally sensitive everywhere: from the plane wave in steps of the inverse Rayleigh distance
lambda / (2 D^2), that is pi / 8 of phase at the ends of the array, to the nearest range. A pattern
search with halved steps follows. MUSIC minimises the part of the steering vector outside the
signal subspace; maximum likelihood, deterministic and by alternating projection, maximises the
power tr(P_A C) that steering vectors explain, one source after the other; it holds for coherent
sources too. At every bearing the best range counts: two sources in the same direction are one.

References
----------
Y.-D. Huang, M. Barkat, "Near-field multiple source localization by passive sensor array", IEEE
Trans. Antennas and Propagation 39(7), 1991, for MUSIC over bearing and range; I. Ziskind, M. Wax,
"Maximum likelihood localization of multiple sources by alternating projection", IEEE Trans. ASSP
36(10), 1988.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sonar_tracking.errors import InputError
from sonar_tracking.geometry import beamwidth, is_line
from sonar_tracking.passive.near_field.spherical_steering import (
    rayleigh_distance,
    spherical_vectors,
)
from sonar_tracking.records.arrays import ComplexArray, FloatArray

Cost = Callable[[ComplexArray], FloatArray]
"""From steering vectors of norm 1 in columns to what is to be least, one number a column."""

_POINTS_PER_BEAM = 4
_HALVINGS = 24
_MOVES = 400
_CYCLES = 20
_CONVERGED = 1e-7
_VECTORS_AT_ONCE = 2048
_NEIGHBOURS = np.array([(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if i or j], dtype=np.float64)


@dataclass(frozen=True)
class NearFieldFix:
    """Where the sources are.

    Attributes
    ----------
    angles : ndarray, shape (n_sources,)
        At the centre of the array, rad, ascending.
    ranges : ndarray, shape (n_sources,)
        From there, m; infinite = plane wave.
    """

    angles: FloatArray
    ranges: FloatArray


@dataclass(frozen=True)
class NearFieldGrid:
    """Bearings and curvatures that are looked at.

    Attributes
    ----------
    positions : ndarray, shape (n_elements, 3)
        m.
    wavenumber : float
        rad/m.
    angles : ndarray, shape (n_angles,)
        rad, ascending.
    curvatures : ndarray, shape (n_curvatures,)
        1/m, ascending from 0; only 0 = plane waves.
    """

    positions: FloatArray
    wavenumber: float
    angles: FloatArray
    curvatures: FloatArray

    def vectors(self, points: FloatArray) -> ComplexArray:
        """Return steering vectors of norm 1.

        Parameters
        ----------
        points : ndarray, shape (n_points, 2)
            Angle and curvature of each, rad and 1/m.

        Returns
        -------
        ndarray, shape (n_elements, n_points), complex
            In columns, pure numbers.
        """
        vectors = spherical_vectors(self.positions, points[:, 0], points[:, 1], self.wavenumber)
        return np.asarray(vectors / np.linalg.norm(vectors, axis=0), dtype=np.complex128)

    def spectrum(self, cost: Cost) -> tuple[FloatArray, FloatArray]:
        """Return at each angle the least cost and the curvature that has it.

        Returns
        -------
        costs : ndarray, shape (n_angles,)
            In units of the cost.
        curvatures : ndarray, shape (n_angles,)
            1/m.
        """
        points = np.stack(np.meshgrid(self.angles, self.curvatures, indexing="ij"), axis=-1)
        flat = points.reshape(-1, 2)
        portions = np.array_split(flat, -(-len(flat) // _VECTORS_AT_ONCE))
        costs = np.concatenate([cost(self.vectors(portion)) for portion in portions])
        costs = costs.reshape(points.shape[:2])
        best = costs.argmin(axis=1)
        return np.take_along_axis(costs, best[:, None], axis=1)[:, 0], self.curvatures[best]

    def refined(self, cost: Cost, point: FloatArray) -> FloatArray:
        """Return the point of least cost near a grid point, by a pattern search.

        Parameters
        ----------
        cost : callable
            From steering vectors to what is to be least.
        point : ndarray, shape (2,)
            Angle and curvature, rad and 1/m.

        Returns
        -------
        ndarray, shape (2,)
            rad and 1/m.
        """
        index = int(np.abs(self.angles - point[0]).argmin())
        cell = np.ptp(self.angles[max(index - 1, 0) : index + 2])
        nearest = self.curvatures[-1]
        step = np.array([0.5 * cell, nearest / max(len(self.curvatures) - 1, 1)])
        lower, upper = (
            np.array([self.angles[0] - cell, 0.0]),
            np.array([self.angles[-1] + cell, nearest]),
        )
        least = float(cost(self.vectors(point[None]))[0])
        halvings = 0
        for _ in range(_MOVES):
            trials = np.clip(point + step * _NEIGHBOURS, lower, upper)
            costs = cost(self.vectors(trials))
            best = int(costs.argmin())
            if costs[best] < least:
                point, least = trials[best], float(costs[best])
                continue
            step, halvings = 0.5 * step, halvings + 1
            if halvings == _HALVINGS:
                break
        return point


def near_field_grid(
    positions: FloatArray, wavenumber: float, nearest: float | None
) -> NearFieldGrid:
    """Return the bearings and curvatures to look at.

    Parameters
    ----------
    positions : ndarray, shape (n_elements, 3)
        m.
    wavenumber : float
        rad/m.
    nearest : float or None
        Least range that is looked at, m; None = plane waves only.
    """
    points = _POINTS_PER_BEAM / beamwidth(positions, wavenumber)
    if is_line(positions):
        sines = np.linspace(-1.0, 1.0, int(np.ceil(2.0 * points)) + 2)[1:-1]
        angles = np.arcsin(sines)
    else:
        angles = np.linspace(-np.pi, np.pi, int(np.ceil(2.0 * np.pi * points)), endpoint=False)
    curvatures = np.zeros(1)
    if nearest is not None:
        steps = int(np.ceil(rayleigh_distance(positions, wavenumber) / nearest))
        curvatures = np.linspace(0.0, 1.0 / nearest, steps + 1)
    return NearFieldGrid(positions, wavenumber, angles, curvatures)


def near_field_music(covariance: ComplexArray, n_sources: int, grid: NearFieldGrid) -> NearFieldFix:
    """Return the deepest valleys of the MUSIC spectrum over bearing and range.

    Parameters
    ----------
    covariance : ndarray, shape (n_elements, n_elements), complex
        Sample covariance in white noise, linear power.
    n_sources : int
        Dimension of the signal subspace, below n_elements.
    grid : NearFieldGrid
        Where to look.

    Returns
    -------
    NearFieldFix
        At most n_sources.

    Raises
    ------
    InputError
        If there are not fewer sources than elements, or none.
    """
    _check_sources(n_sources, covariance)
    signal = np.linalg.eigh(covariance).eigenvectors[:, -n_sources:]

    def outside(vectors: ComplexArray) -> FloatArray:
        inside = signal.conj().T @ vectors
        return np.asarray(1.0 - (inside.real**2 + inside.imag**2).sum(axis=0))

    spectrum, curvatures = grid.spectrum(outside)
    padded = np.concatenate([[np.inf], spectrum, [np.inf]])
    valleys = np.flatnonzero((spectrum <= padded[:-2]) & (spectrum < padded[2:]))
    valleys = valleys[np.argsort(spectrum[valleys], kind="stable")][:n_sources]
    points = np.array(
        [grid.refined(outside, np.array([grid.angles[v], curvatures[v]])) for v in valleys]
    )
    return _fix(points.reshape(-1, 2))


def near_field_maximum_likelihood(
    covariance: ComplexArray, n_sources: int, grid: NearFieldGrid
) -> NearFieldFix:
    """Return the deterministic maximum-likelihood bearings and ranges; sources may be coherent.

    Parameters
    ----------
    covariance : ndarray, shape (n_elements, n_elements), complex
        Sample covariance in white noise, linear power.
    n_sources : int
        How many there are, fewer than elements.
    grid : NearFieldGrid
        Where to look.

    Returns
    -------
    NearFieldFix
        n_sources of them.

    Raises
    ------
    InputError
        If there are not fewer sources than elements, or none.
    """
    _check_sources(n_sources, covariance)
    points = np.empty((0, 2))
    for _ in range(n_sources):
        missed = _missed_power(covariance, grid.vectors(points))
        spectrum, curvatures = grid.spectrum(missed)
        best = int(spectrum.argmin())
        point = grid.refined(missed, np.array([grid.angles[best], curvatures[best]]))
        points = _alternated(covariance, grid, np.concatenate([points, point[None]]))
    return _fix(points)


def _alternated(covariance: ComplexArray, grid: NearFieldGrid, points: FloatArray) -> FloatArray:
    """Refine the sources in turn, each given the others, until none moves."""
    if len(points) == 1:
        return points
    for _ in range(_CYCLES):
        before = points.copy()
        for row in range(len(points)):
            others = grid.vectors(np.delete(points, row, axis=0))
            points[row] = grid.refined(_missed_power(covariance, others), points[row])
        if np.abs(points - before).max() < _CONVERGED:
            break
    return points


def _missed_power(covariance: ComplexArray, others: ComplexArray) -> Cost:
    """Return the cost of one more source: minus the share of power that it explains."""
    basis = np.linalg.qr(others).Q
    total = float(np.trace(covariance).real)

    def cost(vectors: ComplexArray) -> FloatArray:
        outside = vectors - basis @ (basis.conj().T @ vectors)
        power = (outside.conj() * (covariance @ outside)).real.sum(axis=0)
        norms = (outside.real**2 + outside.imag**2).sum(axis=0)
        # A vector in the span of the others explains nothing more.
        return np.asarray(-power / np.maximum(norms, 1e-9) / total)

    return cost


def _check_sources(n_sources: int, covariance: ComplexArray) -> None:
    if not 0 < n_sources < len(covariance):
        raise InputError(
            f"{n_sources} sources cannot be looked for with {len(covariance)} elements; give at "
            f"least 1 and at most {len(covariance) - 1}."
        )


def _fix(points: FloatArray) -> NearFieldFix:
    order = np.argsort(points[:, 0], kind="stable")
    with np.errstate(divide="ignore"):
        return NearFieldFix(points[order, 0], 1.0 / points[order, 1])
