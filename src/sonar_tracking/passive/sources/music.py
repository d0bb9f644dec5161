"""MUSIC: arrival angles from one sample covariance, by a grid and its refinement.

The steering vectors of the sources are orthogonal to the noise eigenvectors E_n of the
(whitened) covariance, so that f(theta) = |E_n^H a(theta)|^2 / |a(theta)|^2 is least there. The
grid is fine enough to fall into the valley of each resolved source; Newton steps inside a
grid cell then find its floor. A valley that stays shallow is not taken for a source.

References
----------
R. O. Schmidt, "Multiple emitter location and signal parameter estimation", IEEE Trans. Antennas
and Propagation 34(3), 1986.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.filtering.leading_eigenvectors import leading_eigenvectors, leading_left_vectors
from sonar_tracking.passive.directions.signal_subspace import whitened_covariance
from sonar_tracking.passive.sources.angle_grid import AngleGrid, angle_grid
from sonar_tracking.passive.sources.null_spectrum import NullSpectrum
from sonar_tracking.records.arrays import ComplexArray, FloatArray, IndexArray

_REFINEMENT_STEPS = 8
_FLOOR_REACHED = 1e-13
"""Change of an angle by one step more, rad: Newton steps square the error."""

SHALLOWEST_VALLEY = 0.3
"""Null spectrum above which a valley is no source: less than 70 % of its steering vector lies in
the signal subspace. Of 100 snapshots of 5 resolved sources on 15 elements it is 0.04 at -5 dB and
below 0.15 (99 %) at -8 dB; an unresolved pair leaves a shallow valley anywhere, as echoes do."""


def music_bearings(
    covariance: ComplexArray,
    n_sources: int,
    positions: FloatArray,
    wavenumber: float,
    noise_covariance: ComplexArray | None = None,
) -> FloatArray:
    """Return the arrival angles of the sources that MUSIC resolves.

    Parameters
    ----------
    covariance : ndarray, shape (n_elements, n_elements), complex
        Sample covariance, linear power.
    n_sources : int
        Dimension of the signal subspace, below n_elements.
    positions : ndarray, shape (n_elements, 3)
        Element positions, m.
    wavenumber : float
        rad/m.
    noise_covariance : ndarray, shape (n_elements, n_elements), complex, optional
        Pure numbers; None = white noise.

    Returns
    -------
    ndarray, shape (n_resolved,)
        rad, ascending; at most n_sources, fewer when sources are not resolved.
    """
    angles = bearings_in_covariances(
        covariance[None], n_sources, positions, wavenumber, noise_covariance
    )[0]
    return angles[~np.isnan(angles)]


def bearings_in_covariances(
    covariances: ComplexArray,
    n_sources: int,
    positions: FloatArray,
    wavenumber: float,
    noise_covariance: ComplexArray | None = None,
) -> FloatArray:
    """Return the arrival angles of the sources that MUSIC resolves in each of several covariances.

    Parameters
    ----------
    covariances : ndarray, shape (n_covariances, n_elements, n_elements), complex
        Sample covariances, linear power.
    n_sources : int
        Dimension of each signal subspace, below n_elements.
    positions : ndarray, shape (n_elements, 3)
        Element positions, m.
    wavenumber : float
        rad/m.
    noise_covariance : ndarray, shape (n_elements, n_elements), complex, optional
        Pure numbers; None = white noise.

    Returns
    -------
    ndarray, shape (n_covariances, n_sources)
        rad, ascending; NaN, at the end, where sources are not resolved.
    """
    factor = _factor(noise_covariance)
    white = covariances if factor is None else whitened_covariance(covariances, factor)
    # In ascending order of the eigenvalues.
    vectors = leading_eigenvectors(white, n_sources)[1][..., ::-1]
    grid = angle_grid(positions, wavenumber)
    return _resolved(NullSpectrum(positions, wavenumber, vectors, factor), grid)


def bearings_in_snapshots(
    snapshots: ComplexArray,
    n_sources: int,
    positions: FloatArray,
    wavenumber: float,
    noise_covariance: ComplexArray | None = None,
) -> FloatArray:
    """Return the arrival angles of the sources that MUSIC resolves in each of several windows.

    Parameters
    ----------
    snapshots : ndarray, shape (n_windows, n_snapshots, n_elements), complex
        Linear amplitude.
    n_sources : int
        Dimension of each signal subspace, below n_elements.
    positions : ndarray, shape (n_elements, 3)
        Element positions, m.
    wavenumber : float
        rad/m.
    noise_covariance : ndarray, shape (..., n_elements, n_elements), complex, optional
        Of all windows or of each, pure numbers; None = white noise.

    Returns
    -------
    ndarray, shape (n_windows, n_sources)
        rad, ascending; NaN, at the end, where sources are not resolved.
    """
    factor = _factor(noise_covariance)
    white = np.swapaxes(snapshots, -1, -2)
    if factor is not None:
        white = np.asarray(np.linalg.solve(factor, white), dtype=np.complex128)
    vectors = leading_left_vectors(white, n_sources)
    grid = angle_grid(positions, wavenumber, rounded=True)
    return _resolved(NullSpectrum(positions, wavenumber, vectors, factor), grid)


def valley_floors(
    vectors: ComplexArray, positions: FloatArray, wavenumber: float, refined: bool = True
) -> tuple[FloatArray, FloatArray]:
    """Return the deepest valleys of the null spectra of several signal subspaces.

    Parameters
    ----------
    vectors : ndarray, shape (n_spectra, n_elements, n_sources), complex
        Orthonormal bases, pure numbers.
    positions : ndarray, shape (n_elements, 3)
        Element positions, m.
    wavenumber : float
        rad/m.
    refined : bool
        Whether they are sought to the floor, or on the grid only.

    Returns
    -------
    angles : ndarray, shape (n_spectra, n_sources)
        Of the valleys, rad, deepest on the grid first.
    floors : ndarray, shape (n_spectra, n_sources)
        The null spectrum there, pure numbers; 1 where there is no valley more.
    """
    spectrum = NullSpectrum(positions, wavenumber, vectors, None)
    grid = angle_grid(positions, wavenumber, rounded=True)
    on_grid = spectrum.on_grid(grid)
    found = _deepest_valleys(on_grid, vectors.shape[-1])
    if refined:
        angles = _refined(spectrum, grid.angles, found)
        return angles, np.where(found < 0, 1.0, spectrum.at(angles))
    floors = np.take_along_axis(on_grid, np.maximum(found, 0), axis=-1)
    return grid.angles[found], np.where(found < 0, 1.0, floors)


def _factor(noise_covariance: ComplexArray | None) -> ComplexArray | None:
    if noise_covariance is None:
        return None
    return np.asarray(np.linalg.cholesky(noise_covariance), dtype=np.complex128)


def _resolved(null_spectra: NullSpectrum, grid: AngleGrid) -> FloatArray:
    """Return the floors of the deepest valleys of each spectrum, rad, ascending; NaN = shallow."""
    n_sources = null_spectra.signal_vectors.shape[-1]
    found = _deepest_valleys(null_spectra.on_grid(grid), n_sources)
    angles = np.where(found < 0, np.nan, _refined(null_spectra, grid.angles, found))
    angles.sort(axis=-1)
    shallow = ~(null_spectra.at(np.nan_to_num(angles)) < SHALLOWEST_VALLEY)
    angles[shallow] = np.nan
    angles.sort(axis=-1)
    return angles


def _deepest_valleys(spectra: FloatArray, count: int) -> IndexArray:
    """Return where on the grid the deepest valleys of each spectrum are, deepest first; -1 = none.

    Parameters
    ----------
    spectra : ndarray, shape (n_spectra, n_angles)
        Pure numbers.
    count : int
        Valleys wanted of each.

    Returns
    -------
    ndarray of int, shape (n_spectra, count)
        Of the angles.
    """
    # The grid is cyclic: at half a wavelength both ends of a line array are the same wave.
    around = np.concatenate((spectra[:, -1:], spectra, spectra[:, :1]), axis=-1)
    row, column = np.nonzero((spectra <= around[:, :-2]) & (spectra < around[:, 2:]))
    order = np.lexsort((spectra[row, column], row))
    place = np.arange(len(row)) - np.searchsorted(row, row)
    deepest = place < count
    found = np.full((len(spectra), count), -1)
    found[row[deepest], place[deepest]] = column[order[deepest]]
    return found


def _refined(null_spectrum: NullSpectrum, grid: FloatArray, found: IndexArray) -> FloatArray:
    """Return the floors of valleys, shape (n_spectra, count), rad, from their places on the grid.

    The floor of a spectrum is sought until it is reached in all valleys of that spectrum, so that
    it does not depend on the others.
    """
    angles, valleys = grid[found], found >= 0
    low = grid[np.maximum(found - 1, 0)]
    high = grid[np.minimum(found + 1, len(grid) - 1)]
    rows = np.flatnonzero(valleys.any(axis=-1))
    for _ in range(_REFINEMENT_STEPS):
        if not rows.size:
            break
        here = rows if len(rows) < len(found) else slice(None)
        step = null_spectrum.of(rows).newton_step(angles[here])
        refined = np.minimum(np.maximum(angles[here] + step, low[here]), high[here])
        change = (np.abs(refined - angles[here]) * valleys[here]).max(axis=-1)
        angles[here] = refined
        rows = rows[null_spectrum.curvature * change**2 >= _FLOOR_REACHED]
    return angles
