"""From real samples to narrowband complex snapshots: demodulation, low-pass, decimation.

Each channel is shifted in frequency by ``exp(-j 2 pi f t)``, low-pass filtered with a linear-phase
FIR filter and decimated. One bin of a short-time Fourier transform would do the same with its
window as the filter, but it ties the centre frequency to a multiple of the bin width and the
bandwidth to the window; here both are free, the stop band is at least 60 dB down, and the delay of
the symmetric filter is known exactly: a snapshot stands for the sample its window is centred on.

With the ``exp(+j omega t)`` analytic signal an element nearer the source leads in phase. A sine of
amplitude A gives a snapshot of magnitude A.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.passive.lines.kaiser_low_pass import kaiser_low_pass, kaiser_taps
from sonar_tracking.records.arrays import ComplexArray, FloatArray

_STOP_BAND_DB = 60.0

_MOST_TAPS = 1 << 22
"""Of a filter; one of these takes 34 MB."""
_TRANSITION = 0.5
"""Width of the transition from pass band to stop band, in bandwidths."""


@dataclass(frozen=True)
class Band:
    """A narrow band and how it is taken out of the samples.

    Attributes
    ----------
    frequency, bandwidth : float
        Centre and two-sided width (between the points 6 dB down), Hz.
    decimation : int
        Samples per snapshot; the snapshot rate is about the bandwidth, so that snapshots of noise
        are almost independent.
    taps : ndarray, shape (n_taps,)
        Symmetric low-pass filter of gain 1, n_taps odd; pure numbers.
    """

    frequency: float
    bandwidth: float
    decimation: int
    taps: FloatArray

    @property
    def reach(self) -> int:
        """Samples on either side of its own that a snapshot is made from."""
        return len(self.taps) // 2


def design_band(sample_rate: float, frequency: float, bandwidth: float) -> Band:
    """Return the band around a frequency.

    Parameters
    ----------
    sample_rate, frequency, bandwidth : float
        Hz.

    Raises
    ------
    ConfigurationError
        If the band does not lie between zero and half the sample rate.
    """
    if not bandwidth > 0.0:
        raise ConfigurationError(f"The bandwidth is {bandwidth:g} Hz; it must be above zero.")
    half_width = (0.5 + _TRANSITION / 2) * bandwidth
    if frequency - half_width <= 0.0:
        raise ConfigurationError(
            f"The band around {frequency:g} Hz reaches below zero; give a frequency above "
            f"{half_width:g} Hz or a smaller bandwidth."
        )
    if frequency + half_width >= sample_rate / 2:
        raise ConfigurationError(
            f"The band around {frequency:g} Hz reaches above half the sample rate of "
            f"{sample_rate:g} Hz; give a frequency below {sample_rate / 2 - half_width:g} Hz."
        )
    n_taps = kaiser_taps(sample_rate, _TRANSITION * bandwidth, _STOP_BAND_DB)
    if n_taps > _MOST_TAPS:
        raise ConfigurationError(
            f"A bandwidth of {bandwidth:g} Hz at {sample_rate:g} Hz takes a filter of {n_taps} "
            f"samples, {n_taps / sample_rate:.3g} s; give a bandwidth above "
            f"{bandwidth * n_taps / _MOST_TAPS:.2g} Hz, or check the sample rate."
        )
    taps = kaiser_low_pass(sample_rate, bandwidth / 2, _TRANSITION * bandwidth, _STOP_BAND_DB)
    return Band(frequency, bandwidth, int(sample_rate // bandwidth), taps)


class Demodulator:
    """Turns a stream of samples into a stream of snapshots of one band.

    The first snapshot is centred on the first multiple of the decimation whose window lies within
    the samples.

    Parameters
    ----------
    band : Band
        What to take out.
    sample_rate : float
        Hz.
    """

    def __init__(self, band: Band, sample_rate: float) -> None:
        self._band = band
        self._cycles_per_sample = band.frequency / sample_rate
        offsets = np.arange(-band.reach, band.reach + 1)
        kernel = 2.0 * band.taps * np.exp(-2j * np.pi * self._cycles_per_sample * offsets)
        self._kernel = np.stack([kernel.real, kernel.imag])
        self._samples: FloatArray | None = None
        self._first_sample = 0
        step = band.decimation
        self.next_centre = -(-band.reach // step) * step
        """Sample the next snapshot will be centred on."""

    def update(self, samples: FloatArray) -> ComplexArray:
        """Take the next samples and return the snapshots they complete.

        Parameters
        ----------
        samples : ndarray, shape (n_samples, n_channels)
            Linear amplitude, following those of the call before.

        Returns
        -------
        ndarray, shape (n_snapshots, n_channels), complex
            Linear amplitude. Their centres are ``decimation`` samples apart. A sample that is not
            finite makes the snapshots of its channel NaN whose window holds it.
        """
        held = samples if self._samples is None else np.concatenate([self._samples, samples])
        reach, step = self._band.reach, self._band.decimation
        end = self._first_sample + len(held)
        centres = range(self.next_centre, end - reach, step)
        snapshots = np.empty((len(centres), samples.shape[1]), np.complex128)
        with np.errstate(invalid="ignore"):
            for row, centre in enumerate(centres):
                start = centre - reach - self._first_sample
                real, imaginary = self._kernel @ held[start : start + 2 * reach + 1]
                turn = np.exp(-2j * np.pi * ((self._cycles_per_sample * centre) % 1.0))
                snapshots[row] = turn * (real + 1j * imaginary)
        self.next_centre += step * len(centres)
        drop = max(self.next_centre - reach - self._first_sample, 0)
        self._samples = held[drop:]
        self._first_sample += drop
        return snapshots
