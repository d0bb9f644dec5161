"""MUSIC of pyroomacoustics, a peer of the bench where that is installed.

It works on frames of short-time spectra: the snapshots are put into the one bin of a transform of
four samples that holds their frequency, and its speed of sound is set so that the phases agree.

References
----------
R. Scheibler, E. Bezzam, I. Dokmanic, "Pyroomacoustics: a Python package for audio room simulation
and array processing algorithms", ICASSP 2018.
"""

from __future__ import annotations

import importlib.util
from typing import Any

import numpy as np

from sonar_tracking.records.arrays import ComplexArray, FloatArray

_SAMPLE_RATE, _TRANSFORM, _BIN = 4.0, 4, 1


def pyroomacoustics_installed() -> bool:
    """Return whether the peer is there."""
    return importlib.util.find_spec("pyroomacoustics") is not None


class PyroomMusic:
    """Its MUSIC on a grid of arrival angles, set up once.

    Parameters
    ----------
    positions : ndarray, shape (n_elements, 3)
        Element positions in one plane, m.
    wavenumber : float
        rad/m.
    n_sources : int
        Dimension of the signal subspace.
    angles : ndarray, shape (n_angles,)
        The grid, rad from broadside.

    Raises
    ------
    ModuleNotFoundError
        If pyroomacoustics is not installed.
    """

    def __init__(
        self, positions: FloatArray, wavenumber: float, n_sources: int, angles: FloatArray
    ) -> None:
        from pyroomacoustics.doa import MUSIC

        frequency = _SAMPLE_RATE * _BIN / _TRANSFORM
        self._music: Any = MUSIC(
            positions[:, :2].T,
            _SAMPLE_RATE,
            _TRANSFORM,
            c=2.0 * np.pi * frequency / wavenumber,
            num_src=n_sources,
            azimuth=0.5 * np.pi - angles,
        )

    def bearings(self, snapshots: ComplexArray) -> FloatArray:
        """Return the angles of the highest peaks, as many as sources at most.

        Parameters
        ----------
        snapshots : ndarray, shape (n_snapshots, n_elements), complex
            Linear amplitude.

        Returns
        -------
        ndarray, shape (n_found,)
            rad from broadside, ascending.
        """
        spectra = np.zeros((snapshots.shape[1], _TRANSFORM // 2 + 1, len(snapshots)), complex)
        spectra[:, _BIN] = snapshots.T
        self._music.locate_sources(spectra, freq_bins=np.array([_BIN]))
        return np.sort(0.5 * np.pi - np.asarray(self._music.azimuth_recon, dtype=np.float64))
