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
        Attenuation of the stop band, above 50 dB.

    Returns
    -------
    ndarray, shape (n_taps,)
        n_taps odd; pure numbers.
    """
    nyquist = sample_rate / 2
    width = transition / nyquist
    n_taps = math.ceil((stop_band_db - 7.95) / 2.285 / (np.pi * width) + 1) | 1
    offset = np.arange(n_taps) - 0.5 * (n_taps - 1)
    edge = cutoff / nyquist
    taps = edge * np.sinc(edge * offset) * _window(n_taps, 0.1102 * (stop_band_db - 8.7))
    return np.asarray(taps / np.sum(taps))


def load_bessel_function() -> None:
    """Load the Bessel function now, so that the first filter need not wait for it."""
    _window(3, 1.0)


def _window(n_taps: int, shape: float) -> FloatArray:
    """Return Kaiser's window (n_taps,)."""
    # It takes half as long to load as a whole node to start.
    from scipy.special import i0

    half = (n_taps - 1) / 2.0
    place = (np.arange(n_taps) - half) / half
    return np.asarray(i0(shape * np.sqrt(1.0 - place**2.0)) / i0(shape))
