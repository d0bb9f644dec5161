"""Lines in one Hann spectrum: peaks above the threshold, their frequencies and how well known.

A peak is a bin above the threshold that none of its neighbours exceeds. A parabola through the log
powers of the three bins has its vertex at p; for a pure tone p is a known function of the offset
d of the line from the bin, and its inverse takes the bias (up to 0.016 bins) away. To first order
the noise in phase with the line moves the three log powers, so that

    var d = kappa(d) / snr,    kappa(d) = 2 c' R c,  c_i = (d'(p) dp/dL_i) / W(i - d),

with the Hann window's transform W, the correlation R (1, 2/3, 1/6) of its bins and the
signal-to-noise ratio of the line on its own frequency; kappa is 0.37 at the bin and 0.26 halfway
between two. Below 15 dB a factor 1 + 1/snr + 10/snr^2 + 600/snr^3 stands for the higher orders and
for weak lines that pass the threshold by their noise, fitted to simulated tones. The Cramer-Rao
bound of a whole frame is 0.101 / snr.

A line's skirts are no lines: a peak is left out below the envelope of the Hann window's sidelobes,
1 / (pi x (x^2 - 1)) at x bins, of a stronger one, with a margin of 6 dB.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.records.arrays import BoolArray, FloatArray, IntArray

_BIN_CORRELATION = np.array([[1.0, 2 / 3, 1 / 6], [2 / 3, 1.0, 2 / 3], [1 / 6, 2 / 3, 1.0]])
_SKIRT_MARGIN = 4.0
_MAIN_LOBE = 2.0
"""Bins from the top of a line to its first zero."""


@dataclass(frozen=True)
class SpectralPeaks:
    """Lines of one spectrum, by rising frequency.

    Attributes
    ----------
    bin : ndarray of int, shape (n_peaks,)
        Bin of the peak.
    position, variance : ndarray, shape (n_peaks,)
        Of the line, in bins, and its variance.
    signal_to_noise_ratio : ndarray, shape (n_peaks,)
        Linear, on the frequency of the line, in the analysis bandwidth of 1.5 bins.
    """

    bin: IntArray
    position: FloatArray
    variance: FloatArray
    signal_to_noise_ratio: FloatArray


def hann_transform(offset: FloatArray) -> FloatArray:
    """Return the transform of a Hann window, relative to its top.

    Parameters
    ----------
    offset : ndarray, shape (...)
        From the top, in bins.

    Returns
    -------
    ndarray, shape (...)
        Linear amplitude.
    """
    square = np.asarray(offset, np.float64) ** 2
    pole = np.abs(square - 1.0) < 1e-12
    top = np.full(square.shape, 0.5)
    return np.asarray(np.divide(np.sinc(offset), 1.0 - square, out=top, where=~pole))


def find_peaks(normalised: FloatArray, threshold: FloatArray, power: FloatArray) -> SpectralPeaks:
    """Return the lines in a spectrum.

    Parameters
    ----------
    normalised : ndarray, shape (n_bins,)
        Linear power over background.
    threshold : ndarray, shape (n_bins,)
        Of the same, linear.
    power : ndarray, shape (n_bins,)
        Linear, before the normalisation: a strong line is in the background of the bins
        beside it, which would bend its top.
    """
    middle = normalised[1:-1]
    top = (middle >= normalised[:-2]) & (middle > normalised[2:]) & (middle > threshold[1:-1])
    bins = np.flatnonzero(top) + 1
    around = power[bins[:, None] + np.arange(-1, 2)]
    around = around * (normalised[bins] / around[:, 1])[:, None]
    offset = np.interp(_vertex(np.log(np.maximum(around, 1e-12))), _VERTEX, _OFFSET)
    ratio = np.maximum((around[:, 1] - 1.0) / hann_transform(offset) ** 2, 0.5)
    higher = 1.0 + 1.0 / ratio + 10.0 / ratio**2 + 600.0 / ratio**3
    variance = np.interp(offset, _OFFSET, _KAPPA) / ratio * higher
    keep = ~_skirts(bins + offset, ratio)
    return SpectralPeaks(bins[keep], (bins + offset)[keep], variance[keep], ratio[keep])


def _skirts(position: FloatArray, ratio: FloatArray) -> BoolArray:
    if len(position) < 2:
        return np.zeros(len(position), dtype=bool)
    distance = np.abs(position[:, None] - position)
    envelope = np.ones_like(distance)
    outside = distance > _MAIN_LOBE
    far = distance[outside]
    envelope[outside] = (np.pi * far * (far**2 - 1.0)) ** -2
    limit = _SKIRT_MARGIN * np.minimum(envelope, 1.0 / _SKIRT_MARGIN) * ratio
    np.fill_diagonal(limit, 0.0)
    return np.asarray(np.any(ratio[:, None] < limit, axis=1))


def _vertex(log_power: FloatArray) -> FloatArray:
    left, middle, right = np.moveaxis(log_power, -1, 0)
    curvature = np.minimum(left - 2.0 * middle + right, -1e-9)
    return 0.5 * (left - right) / curvature


def _response() -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return offsets, their vertices without noise, and kappa."""
    offset = np.linspace(-0.6, 0.6, 241)
    window = hann_transform(np.arange(-1, 2) - offset[:, None])
    log_power = 2.0 * np.log(window)
    left, middle, right = np.moveaxis(log_power, -1, 0)
    curvature, slope = left - 2.0 * middle + right, left - right
    gradient = np.stack(
        [
            0.5 / curvature - 0.5 * slope / curvature**2,
            slope / curvature**2,
            -0.5 / curvature - 0.5 * slope / curvature**2,
        ],
        axis=-1,
    )
    vertex = 0.5 * slope / curvature
    weight = gradient * np.gradient(offset, vertex)[:, None] / window
    kappa = 2.0 * np.einsum("ni,ij,nj->n", weight, _BIN_CORRELATION, weight)
    return offset, vertex, kappa


_OFFSET, _VERTEX, _KAPPA = _response()
