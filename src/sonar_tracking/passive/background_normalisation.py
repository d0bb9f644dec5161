"""Two-pass split-window background and a threshold of constant false-alarm probability.

The background of a bin is the mean power of the bins around it, without a gap that a line in the
bin would leak into. A second pass leaves out what stands out in the first: bins above ``CLIPPING``
times their first background count as that background. The mean of n exponential powers that Hann
frames correlate with 4/9 (neighbours) and 1/36 (next but one) scatters like a gamma variable of
shape N = n / (1 + 2 (4/9 + 1/36)), so that the clipped mean is too low by the factor

    b = 1 - (1 + a/N)^-N - (a - 1) (1 + a/N)^-(N+1),    a = CLIPPING,

and noise exceeds t times the background with the probability (1 + t/N)^-N, which gives t. Measured
false alarms are within 5 % of the stated ones for 25 bins on either side and more; with fewer they
are rarer (by 15 % with 15 bins), since clipping also lightens the lower tail of the mean.

References
----------
Struzinski, Lowe (1984), A performance comparison of four noise background normalization schemes
(the two-pass split window); Finn, Johnson (1968), Adaptive detection mode with threshold control
(cell averaging).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

CLIPPING = 8.0
"""First backgrounds above which a bin does not count in the second pass."""

GAP_BINS = 3
"""Distance of the nearest bin used: Hann frames correlate bins up to two apart."""

_HANN_CORRELATION = 1.0 + 2.0 * (4.0 / 9.0 + 1.0 / 36.0)


class BackgroundNormaliser:
    """Divides spectra by their background.

    Parameters
    ----------
    n_bins : int
        Of a spectrum; at its ends the window is one-sided.
    half_width : int
        Bins used on either side.
    false_alarm_probability : float
        Per bin.

    Attributes
    ----------
    threshold : ndarray, shape (n_bins,)
        For the normalised power.
    """

    def __init__(self, n_bins: int, half_width: int, false_alarm_probability: float) -> None:
        bins = np.arange(n_bins)
        self._edges = tuple(
            np.clip(edge, 0, n_bins)
            for edge in (
                bins - GAP_BINS - half_width + 1,
                bins - GAP_BINS + 1,
                bins + GAP_BINS,
                bins + GAP_BINS + half_width,
            )
        )
        first, last, other_first, other_last = self._edges
        self._count = np.maximum((last - first) + (other_last - other_first), 1)
        shape = np.maximum(self._count / _HANN_CORRELATION, 1.0)
        below = 1.0 + CLIPPING / shape
        self._clipped_mean = 1.0 - below**-shape - (CLIPPING - 1.0) * below ** -(shape + 1.0)
        self.threshold = shape * (false_alarm_probability ** (-1.0 / shape) - 1.0)

    def normalise(self, power: FloatArray) -> FloatArray:
        """Return the power over its background.

        Parameters
        ----------
        power : ndarray, shape (..., n_bins)
            Linear. Noise has the value 1 on average in the result; a spectrum of zeros stays 0.
        """
        first = self._windowed_mean(power)
        clipped = np.where(power > CLIPPING * first, first, power)
        background = self._windowed_mean(clipped) / self._clipped_mean
        normalised = np.zeros_like(power)
        np.divide(power, background, out=normalised, where=background > 0.0)
        return normalised

    def _windowed_mean(self, values: FloatArray) -> FloatArray:
        sums = np.zeros((*values.shape[:-1], values.shape[-1] + 1))
        np.cumsum(values, axis=-1, out=sums[..., 1:])
        first, last, other_first, other_last = self._edges
        total = sums[..., last] - sums[..., first] + sums[..., other_last] - sums[..., other_first]
        # Differences of running sums may round to less than nothing beside a very strong line.
        return np.maximum(total, 0.0) / self._count
