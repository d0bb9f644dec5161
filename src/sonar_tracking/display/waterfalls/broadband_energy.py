"""Broadband energy of beams from element time series.

The series are cut into half-overlapping Hann frames. In each bin of the band the elements are
steered by the exact phase of their delays and averaged, and the powers of the bins are added:

    b(theta) = 2 / (N sum w^2) sum_f |1/M sum_m X_m(f) exp(-2 pi j f tau_m(theta))|^2,

so that a plane wave gives in its own direction the power it has in the band on one element.
Frames are eight times as long as sound takes along the array: then the delays do not shift a
wave out of its frame.

The band of an array is the octave below the frequency at which its elements are half a wavelength
apart, or below what was recorded: there its beams are narrowest, and each is a single one.

References
----------
Van Trees (2002), Optimum Array Processing, section 6.10 (frequency-domain beamforming);
Welch (1967), The use of fast Fourier transform for the estimation of power spectra.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sonar_tracking.display.waterfalls.beam_rows import BeamAxis, BeamRow, beam_axis
from sonar_tracking.geometry import aperture, largest_spacing, steering_vectors, wavenumber
from sonar_tracking.records.arrays import BoolArray, FloatArray
from sonar_tracking.records.samples import ArraySamples
from sonar_tracking.records.time import NANOSECONDS
from sonar_tracking.sensor_pose import yaw_of

FRAME_PER_APERTURE = 8.0
"""Length of a frame over the time sound takes along the array."""

SHORTEST_FRAME = 0.1
"""s."""

USABLE_SHARE = 0.8
"""Of half the sample rate: recorders cut off what is above."""

LARGEST_KEPT = 8_000_000
"""Steering factors that are kept, 64 MB; of more, they are computed anew each time."""

Band = tuple[float, float]
"""Lowest and highest frequency, Hz."""


def array_band(positions: FloatArray, sample_rate: float, sound_speed: float) -> Band:
    """Return the highest octave in which an array has no second beam, Hz.

    Parameters
    ----------
    positions : ndarray, shape (n_elements, 3)
        Element positions, m.
    sample_rate : float
        Hz.
    sound_speed : float
        m/s.
    """
    usable = USABLE_SHARE * 0.5 * sample_rate
    spacing = largest_spacing(positions)
    highest = min(usable, 0.5 * sound_speed / spacing) if spacing > 0.0 else usable
    return 0.5 * highest, highest


class BroadbandEnergy:
    """Turns the blocks of one array into rows of its beams.

    Parameters
    ----------
    band : (float, float), optional
        Lowest and highest frequency, Hz; default: :func:`array_band`.
    """

    def __init__(self, band: Band | None = None) -> None:
        self._band = band
        self._array: tuple[bytes, float, float] | None = None
        self._steering: _Steering
        self._held: NDArray[np.float32]
        self._next_stamp = 0

    def row(self, block: ArraySamples) -> BeamRow | None:
        """Take a block and return the row of the frames it completes.

        Parameters
        ----------
        block : ArraySamples
            The next block; another array, a gap or samples that are no numbers begin anew.

        Returns
        -------
        BeamRow or None
            None = no frame is complete yet, or most elements give no numbers.
        """
        self._take(block)
        hop, rate = self._steering.hop, block.sample_rate
        count = len(self._held) // hop - 1
        if count < 1:
            return None
        first = block.end_stamp - round(len(self._held) / rate * NANOSECONDS)
        frames = np.lib.stride_tricks.sliding_window_view(self._held, 2 * hop, axis=0)
        power = self._steering.power(frames[::hop][:count])
        self._held = self._held[count * hop :].copy()
        if power is None:
            return None
        # A frame stands for the half around its middle, so that successive rows touch.
        begin = first + round(0.5 * hop / rate * NANOSECONDS)
        return BeamRow(
            begin=begin,
            end=begin + round(count * hop / rate * NANOSECONDS),
            axis=self._steering.axis,
            power=power,
            integrated=count * hop / rate,
            sensor_id=block.sensor.sensor_id,
            axis_azimuth=yaw_of(block.sensor.orientation),
        )

    def _take(self, block: ArraySamples) -> None:
        """Hold the samples of a block behind those that wait for the end of their frame."""
        positions, rate, sound_speed = block.element_positions, block.sample_rate, block.sound_speed
        array = (positions.tobytes(), rate, sound_speed)
        new = array != self._array
        if new:
            band = self._band or array_band(positions, rate, sound_speed)
            self._steering = _Steering(positions, rate, sound_speed, band)
            self._array = array
        data = block.data.astype(np.float32)
        gap = abs(block.stamp - self._next_stamp) * rate > 0.5 * NANOSECONDS
        self._held = data if new or gap else np.concatenate([self._held, data])
        self._next_stamp = block.end_stamp


class _Steering:
    """Frames, bins and steering factors of one array."""

    def __init__(self, positions: FloatArray, rate: float, sound_speed: float, band: Band) -> None:
        travel = aperture(positions) / sound_speed
        wanted = max(SHORTEST_FRAME, FRAME_PER_APERTURE * travel) * rate
        self.hop = 2 ** max(math.ceil(math.log2(wanted)) - 1, 3)
        self.axis: BeamAxis = beam_axis(positions, wavenumber(band[1], sound_speed))
        self._positions, self._sound_speed = positions, sound_speed
        frequencies = np.arange(self.hop) * rate / (2 * self.hop)
        self._bins = np.flatnonzero((frequencies >= max(band[0], 1e-9)) & (frequencies <= band[1]))
        self._frequencies = frequencies[self._bins]
        self._window = np.hanning(2 * self.hop + 1)[:-1].astype(np.float32)
        self._scale = 2.0 / (2 * self.hop * float(np.sum(self._window**2)))
        kept = len(self._bins) * len(positions) * self.axis.count <= LARGEST_KEPT
        self._weights = [self._weight(f) for f in self._frequencies] if kept else None

    def power(self, frames: NDArray[np.float32]) -> FloatArray | None:
        """Return the mean power over frames, shape (n_frames, n_elements, n_samples)."""
        used: BoolArray = np.asarray(np.isfinite(frames).all(axis=(0, 2)))
        count = int(np.count_nonzero(used))
        if 2 * count <= used.size:
            return None
        windowed = np.where(used[:, None], frames, np.float32(0.0)) * self._window
        spectra = np.fft.rfft(windowed, axis=-1)[..., self._bins].astype(np.complex64)
        power = np.zeros(self.axis.count)
        for index, frequency in enumerate(self._frequencies):
            weight = self._weights[index] if self._weights else self._weight(frequency)
            beams = spectra[:, :, index] @ weight
            power += np.sum(beams.real**2 + beams.imag**2, axis=0)
        return power * (self._scale / (count**2 * len(frames)))

    def _weight(self, frequency: float) -> NDArray[np.complex64]:
        number = wavenumber(frequency, self._sound_speed)
        vectors = steering_vectors(self._positions, self.axis.angles, number, "array_centre")
        return np.asarray(vectors.conj(), np.complex64)
