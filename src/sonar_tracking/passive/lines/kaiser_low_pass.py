"""Linear-phase low-pass filters: a sinc under Kaiser's window.

The same as ``scipy.signal.firwin``, to the last bit; but that takes three times as long to load as
all else a node needs, and the Bessel function alone does not.

References
----------
Kaiser (1974), Nonrecursive digital filter design using the I0-sinh window function.
"""

from __future__ import annotations

import math

import numpy as np

from sonar_tracking.records.arrays import FloatArray

_CHEBYSHEV = (
    -4.4153416464793395e-18,
    3.3307945188222384e-17,
    -2.431279846547955e-16,
    1.715391285555133e-15,
    -1.1685332877993451e-14,
    7.676185498604936e-14,
    -4.856446783111929e-13,
    2.95505266312964e-12,
    -1.726826291441556e-11,
    9.675809035373237e-11,
    -5.189795601635263e-10,
    2.6598237246823866e-09,
    -1.300025009986248e-08,
    6.046995022541919e-08,
    -2.670793853940612e-07,
    1.1173875391201037e-06,
    -4.4167383584587505e-06,
    1.6448448070728896e-05,
    -5.754195010082104e-05,
    0.00018850288509584165,
    -0.0005763755745385824,
    0.0016394756169413357,
    -0.004324309995050576,
    0.010546460394594998,
    -0.02373741480589947,
    0.04930528423967071,
    -0.09490109704804764,
    0.17162090152220877,
    -0.3046826723431984,
    0.6767952744094761,
)
"""Coefficients of exp(-x) I0(x) from 0 to 8."""


def kaiser_low_pass(
    sample_rate: float, cutoff: float, transition: float, stop_band_db: float
) -> FloatArray:
    """Return the taps of a symmetric low-pass filter of gain 1.

    Parameters
    ----------
    sample_rate : float
        Hz.
    cutoff : float
        Where the gain is one half, Hz; between 0 and half the sample rate.
    transition : float
        From pass band to stop band, Hz.
    stop_band_db : float
        Attenuation of the stop band, from 50 to 81 dB.

    Returns
    -------
    ndarray, shape (n_taps,)
        n_taps odd; pure numbers.
    """
    nyquist = sample_rate / 2
    n_taps = kaiser_taps(sample_rate, transition, stop_band_db)
    offset = np.arange(n_taps) - 0.5 * (n_taps - 1)
    edge = cutoff / nyquist
    taps = edge * np.sinc(edge * offset) * _window(n_taps, 0.1102 * (stop_band_db - 8.7))
    return np.asarray(taps / np.sum(taps))


def kaiser_taps(sample_rate: float, transition: float, stop_band_db: float) -> int:
    """Return how many taps such a filter has; the parameters are those of the filter."""
    width = transition / (sample_rate / 2)
    return math.ceil((stop_band_db - 7.95) / 2.285 / (np.pi * width) + 1) | 1


def _window(n_taps: int, shape: float) -> FloatArray:
    """Return Kaiser's window (n_taps,)."""
    half = (n_taps - 1) / 2.0
    place = (np.arange(n_taps) - half) / half
    return _bessel(shape * np.sqrt(1.0 - place**2.0)) / _bessel(np.array([shape]))


def _bessel(values: FloatArray) -> FloatArray:
    """Return the modified Bessel function of order zero of values from 0 to 8.

    The one of ``scipy.special``, to the last bit, takes 13 MB and half as long to load as a whole
    node to start; that of numpy has other exponentials.

    References
    ----------
    S. L. Moshier, Cephes Mathematical Library, function i0.
    """
    argument = values / 2.0 - 2.0
    last, before = np.zeros_like(values), np.zeros_like(values)
    result = np.full_like(values, _CHEBYSHEV[0])
    for coefficient in _CHEBYSHEV[1:]:
        before, last = last, result
        result = argument * last - before + coefficient
    exponentials = np.array([math.exp(value) for value in values])
    return np.asarray(exponentials * (0.5 * (result - before)))
