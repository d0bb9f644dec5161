"""The broad trend of a spectrum: ambient noise falls with frequency, often as a power of it.

A polynomial of the logarithm of frequency is fitted to the logarithm of the power by least squares,
twice: the second time what lies above the first fit, such as lines, counts no more than
``CLIPPING``. The trend need not be right, only about as steep as the background: its level and all
that is left are estimated afterwards, near each bin.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.records.arrays import FloatArray

DEGREE = 2
CLIPPING = 1.5
"""Largest residual of the log power that counts."""

_FLOOR, _TINY = 1e-12, 1e-300


class SpectralTrend:
    """Fits trends to spectra.

    Parameters
    ----------
    frequencies : ndarray, shape (n_bins,)
        Of the bins, in any unit, positive.
    """

    def __init__(self, frequencies: FloatArray) -> None:
        logarithm = np.log(frequencies)
        spread = np.ptp(logarithm)
        where = (logarithm - np.mean(logarithm)) / spread if spread > 0.0 else 0.0 * logarithm
        powers = np.stack([where**degree for degree in range(min(DEGREE + 1, len(where)))], axis=1)
        self._basis, _ = np.linalg.qr(powers)

    def of(self, power: FloatArray) -> FloatArray:
        """Return the trend of spectra.

        Parameters
        ----------
        power : ndarray, shape (..., n_bins)
            Linear.

        Returns
        -------
        ndarray, shape (..., n_bins)
            Linear, positive; where there is no power it is 1.
        """
        silent = ~np.any(power > 0.0, axis=-1, keepdims=True)
        floor = np.maximum(_FLOOR * np.max(power, axis=-1, keepdims=True), _TINY)
        logarithm = np.log(np.maximum(power, floor))
        first = self._fitted(logarithm)
        second = self._fitted(np.minimum(logarithm, first + CLIPPING))
        return np.where(silent, 1.0, np.exp(second))

    def _fitted(self, values: FloatArray) -> FloatArray:
        return np.asarray((values @ self._basis) @ self._basis.T)
