"""LOFAR rows: calibrated power spectral density of beams, frame after frame.

A frame under a Hann window is steered in the frequency domain, without approximation for any
bandwidth (:mod:`sonar_tracking.passive.lines.beam_spectra`), and its power is given as a one-sided
density,

    S(f) = 2 |B(f)|^2 / (f_s sum w^2),

in decibel of the squared unit of the samples per hertz. White noise of variance s has the density
2 s / f_s at every frequency; a tone of amplitude A the peak A^2 / 2 over 1.5 bins, the noise
bandwidth of the window. Frames overlap by half, and a row stands for the half around its middle.

References
----------
Harris (1978), On the use of windows for harmonic analysis with the discrete Fourier transform.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sonar_tracking.display.waterfalls.beam_rows import LEAST_POWER
from sonar_tracking.errors import InputError
from sonar_tracking.passive.lines.beam_spectra import beam_powers, element_spectra
from sonar_tracking.passive.lines.sample_frames import SampleFrame, SampleFramer
from sonar_tracking.passive.lines.usable_elements import usable_elements
from sonar_tracking.records.arrays import ComplexArray, FloatArray
from sonar_tracking.records.bearings import AngleKind, BearingTracks
from sonar_tracking.records.samples import ArraySamples
from sonar_tracking.records.time import NANOSECONDS

FRAME_LENGTH = 2.0
"""s: half a hertz between bins."""

MOST_COLUMNS = 4096
"""Of more bins the mean density of neighbours is given."""

MOST_BEAMS = 12
"""Beams formed in one frame."""


@dataclass(frozen=True)
class LofarRow:
    """Spectrum of one beam over one span.

    Attributes
    ----------
    begin, end : int
        Span, ns.
    sensor_id : str
        Of the array.
    track_id : int
        Bearing track the beam follows; 0 = a direction that does not move with one.
    angle : float
        Arrival angle of the beam, rad.
    first_frequency, bin_width : float
        Of the columns, Hz.
    level_db : ndarray of float32, shape (n_columns,)
        Power spectral density, dB of the squared unit of the samples per Hz.
    """

    begin: int
    end: int
    sensor_id: str
    track_id: int
    angle: float
    first_frequency: float
    bin_width: float
    level_db: NDArray[np.float32]


class LofarBeams:
    """Forms the beams of one array towards its bearing tracks, and towards directions asked for."""

    def __init__(self) -> None:
        self.directions: tuple[float, ...] = ()
        """Arrival angles listened at besides the tracks, rad."""
        self._framer = SampleFramer(FRAME_LENGTH)
        self._tracks: BearingTracks | None = None

    def take_tracks(self, tracks: BearingTracks) -> None:
        """Follow the established bearing tracks of the array from now on; azimuths are no cone."""
        if tracks.angle_kind == AngleKind.CONE:
            self._tracks = tracks

    def rows(self, block: ArraySamples) -> list[LofarRow]:
        """Take a block and return the rows of the frames it completes, one a beam.

        Parameters
        ----------
        block : ArraySamples
            The next block; one that does not fit those before begins anew.
        """
        try:
            frames = self._framer.frames(block)
        except InputError:
            self._framer = SampleFramer(FRAME_LENGTH)
            frames = ()
        return [row for frame in frames for row in self._frame_rows(frame, block)]

    def _frame_rows(self, frame: SampleFrame, block: ArraySamples) -> list[LofarRow]:
        ids, angles = self._beams(frame.stamp)
        if frame.samples is None or not len(ids):
            return []
        length = len(frame.samples)
        width = block.sample_rate / length
        spectra = element_spectra(frame.samples, 1, length // 2)
        columns = _density(spectra, width, angles, block)
        merged = -(-columns.shape[1] // MOST_COLUMNS)
        half = round(0.25 * length / block.sample_rate * NANOSECONDS)
        return [
            LofarRow(
                begin=frame.stamp - half,
                end=frame.stamp + half,
                sensor_id=block.sensor.sensor_id,
                track_id=track_id,
                angle=float(angle),
                first_frequency=width * (1.0 + 0.5 * (merged - 1)),
                bin_width=width * merged,
                level_db=_merged_db(density, merged),
            )
            for track_id, angle, density in zip(ids, angles, columns, strict=True)
        ]

    def _beams(self, stamp: int) -> tuple[list[int], FloatArray]:
        """Return tracks and arrival angles at an instant, the directions asked for at the end."""
        ids: list[int] = []
        angles: list[float] = []
        if self._tracks is not None:
            elapsed = (stamp - self._tracks.stamp) / NANOSECONDS
            heard = self._tracks.established & np.isfinite(self._tracks.arrival_angle)
            for row in np.flatnonzero(heard)[:MOST_BEAMS]:
                rate = np.nan_to_num(self._tracks.arrival_angle_rate[row])
                ids.append(int(self._tracks.id[row]))
                angles.append(float(self._tracks.arrival_angle[row] + elapsed * rate))
        ids += [0] * len(self.directions)
        return ids, np.array([*angles, *self.directions])


def _density(
    spectra: ComplexArray, width: float, angles: FloatArray, block: ArraySamples
) -> FloatArray:
    """Return the one-sided densities of beams, shape (n_beams, n_bins), linear per Hz."""
    used = usable_elements(spectra)
    frequencies = np.asarray(width * np.arange(1, len(spectra) + 1), np.float64)
    positions = block.element_positions[used]
    power = beam_powers(spectra[:, used], frequencies, positions, block.sound_speed, angles)
    return power * (2.0 / block.sample_rate)


def _merged_db(density: FloatArray, merged: int) -> NDArray[np.float32]:
    count = len(density) // merged
    mean = density[: count * merged].reshape(count, merged).mean(axis=1)
    return np.asarray(10.0 * np.log10(np.maximum(mean, LEAST_POWER)), np.float32)
