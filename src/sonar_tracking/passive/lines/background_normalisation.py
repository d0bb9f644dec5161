"""Two-pass split-window background and a threshold of constant false-alarm probability.

First the spectrum is divided by its broad trend, so that a steep background is flat within the
windows. The background of a bin is then the mean power of the bins around it, without a gap that a
line in the bin would leak into. A second pass leaves out what stands out in the first: bins above
``CLIPPING`` times their background count as that background. Beside a strong line the first
background is too high to leave its skirts out, so that the second pass is repeated with the better
one.

The mean B of n exponential powers that Hann frames correlate is a quadratic form of Gaussian
variables: noise exceeds t times the background with the probability
E exp(-t B) = 1 / det(I + t/n R), R being the correlations 1, 2/3, 1/6 of neighbouring bins. The
determinant follows from the spectrum w of R by Szegoe's theorem,

    ln det(I + s R) = n c_0 + sum_k k c_k^2,    ln(1 + s w) = sum_k c_k exp(j k omega),

one for each side of the window, and the threshold t from it. Clipping makes the mean too low by the
factor

    b = 1 - (1 + a/N)^-N - (a - 1) (1 + a/N)^-(N+1),    a = CLIPPING, N = n / 1.94,

that of a gamma variable of the same variance.

References
----------
Struzinski, Lowe (1984), A performance comparison of four noise background normalization schemes
(the two-pass split window); Finn, Johnson (1968), Adaptive detection mode with threshold control
(cell averaging); Szegoe (1952), On certain Hermitian forms (the determinant).
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.passive.lines.spectral_trend import SpectralTrend
from sonar_tracking.records.arrays import FloatArray, IntArray

CLIPPING = 8.0
"""First backgrounds above which a bin does not count in the second pass."""

GAP_BINS = 3
"""Distance of the nearest bin used: Hann frames correlate bins up to two apart."""

REPETITIONS = 6
"""Of the second pass."""

_BISECTIONS = 60
_HANN_CORRELATION = 1.0 + 2.0 * (4.0 / 9.0 + 1.0 / 36.0)
_HANN_SPECTRUM = (2.0 / 3.0) * (1.0 + np.cos(2.0 * np.pi * np.arange(64) / 64)) ** 2


class BackgroundNormaliser:
    """Divides spectra by their background.

    Parameters
    ----------
    frequencies : ndarray, shape (n_bins,)
        Of the bins of a spectrum, in any unit, positive; at its ends the window is one-sided.
    half_width : int
        Bins used on either side.
    false_alarm_probability : float
        Per bin.

    Attributes
    ----------
    threshold : ndarray, shape (n_bins,)
        For the normalised power.
    """

    def __init__(
        self, frequencies: FloatArray, half_width: int, false_alarm_probability: float
    ) -> None:
        n_bins = len(frequencies)
        self._trend = SpectralTrend(frequencies)
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
        self.threshold = _thresholds(
            last - first, other_last - other_first, false_alarm_probability
        )

    def normalise(self, power: FloatArray) -> FloatArray:
        """Return the power over its background.

        Parameters
        ----------
        power : ndarray, shape (..., n_bins)
            Linear.

        Returns
        -------
        ndarray, shape (..., n_bins)
            Linear ratio: noise has the value 1 on average; a spectrum of zeros stays 0.
        """
        power = power / self._trend.of(power)
        background = self._windowed_mean(power)
        for _ in range(REPETITIONS):
            clipped = np.where(power > CLIPPING * background, background, power)
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


def _thresholds(left: IntArray, right: IntArray, probability: float) -> FloatArray:
    """Return the threshold of each bin, from the numbers of bins on either side."""
    windows, which = np.unique(np.stack([left, right], axis=1), axis=0, return_inverse=True)
    count = np.maximum(windows.sum(axis=1), 1)
    low, high = np.zeros(len(windows)), np.full(len(windows), 1.0)
    while np.any(short := _exponent(high, windows, count) < -np.log(probability)):
        high[short] *= 2.0
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        below = _exponent(middle, windows, count) < -np.log(probability)
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return np.asarray(high[which.reshape(-1)])


def _exponent(threshold: FloatArray, windows: IntArray, count: IntArray) -> FloatArray:
    """Return minus the log of the probability that noise exceeds a threshold."""
    scale = (threshold / count)[:, None]
    coefficients = np.fft.rfft(np.log1p(scale * _HANN_SPECTRUM)).real / len(_HANN_SPECTRUM)
    orders = np.arange(coefficients.shape[1])
    ends = np.sum(orders * coefficients**2, axis=1)
    sides = np.sum(windows > 0, axis=1)
    return np.asarray(count * coefficients[:, 0] + sides * ends)
