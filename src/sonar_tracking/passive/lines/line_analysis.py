"""From one frame of element time series to the peaks each beam hears of its own direction."""

from __future__ import annotations

import numpy as np

from sonar_tracking.errors import Notice, Severity
from sonar_tracking.geometry import has_grating_lobes, wavenumber
from sonar_tracking.passive.lines.background_normalisation import GAP_BINS, BackgroundNormaliser
from sonar_tracking.passive.lines.beam_spectra import beam_powers, element_spectra, strongest_power
from sonar_tracking.passive.lines.line_tracker_configuration import LineTrackerConfiguration
from sonar_tracking.passive.lines.line_tracks import HeardLine
from sonar_tracking.passive.lines.sample_frames import SampleFrame
from sonar_tracking.passive.lines.spectral_peaks import find_peaks
from sonar_tracking.records.arrays import BoolArray, ComplexArray, FloatArray, IdArray
from sonar_tracking.records.lines import Beams, LofarRows
from sonar_tracking.records.samples import ArraySamples

DEFAULT_BAND = 0.8
"""Highest frequency analysed, as a share of half the sample rate."""


class LineAnalysis:
    """Beams, spectra and peaks of one array: all that does not change during a run.

    Parameters
    ----------
    configuration : LineTrackerConfiguration
        Frames, band, threshold, own ship.
    samples : ArraySamples
        First block of the run: array and sample rate.
    """

    def __init__(self, configuration: LineTrackerConfiguration, samples: ArraySamples) -> None:
        self._configuration = configuration
        self._positions = samples.element_positions
        self._sound_speed = samples.sound_speed
        n_samples = 2 * max(1, round(0.5 * configuration.frame_length * samples.sample_rate))
        self.frame_length = n_samples / samples.sample_rate
        self.bin_width = 1.0 / self.frame_length
        nyquist = n_samples // 2
        highest = configuration.maximum_frequency * self.frame_length or DEFAULT_BAND * nyquist
        half_width = max(2, round(configuration.background_half_width * self.frame_length))
        # The window of the lowest and highest bins analysed reaches over the ends of the band.
        reach = half_width + GAP_BINS
        lowest = int(np.ceil(configuration.minimum_frequency * self.frame_length))
        self.first_bin = max(GAP_BINS, lowest - reach)
        self.last_bin = max(self.first_bin + 3, min(nyquist - 2, int(highest) + reach + 1))
        bins = np.arange(self.first_bin, self.last_bin)
        self._frequencies = np.asarray(bins * self.bin_width, np.float64)
        self.inside = (bins >= lowest) & (bins <= highest)
        self.normaliser = BackgroundNormaliser(
            self._frequencies, half_width, configuration.false_alarm_probability
        )

    def notices(self) -> tuple[Notice, ...]:
        """Return what a user should know of the array."""
        highest = float(self._frequencies[self.inside][-1]) if self.inside.any() else 0.0
        if not has_grating_lobes(self._positions, wavenumber(highest, self._sound_speed)):
            return ()
        return (
            Notice(
                Severity.WARN,
                "maximum_frequency",
                f"Lines are looked for up to {highest:g} Hz, where the elements are more than half "
                "a wavelength apart, so that beams hear other directions too; set "
                "maximum_frequency lower.",
            ),
        )

    def spectra(self, frame: FloatArray) -> ComplexArray:
        """Return the spectra of the elements.

        Parameters
        ----------
        frame : ndarray, shape (n_samples, n_elements)
            Time series, linear amplitude.

        Returns
        -------
        ndarray, shape (n_bins, n_elements), complex
            Linear amplitude; white noise of variance 1 has the power 1.
        """
        return element_spectra(frame, self.first_bin, self.last_bin)

    def beam_powers(self, spectra: ComplexArray, used: BoolArray, angles: FloatArray) -> FloatArray:
        """Return the power spectra of beams.

        Parameters
        ----------
        spectra : ndarray, shape (n_bins, n_elements), complex
            Of the elements, linear amplitude.
        used : ndarray of bool, shape (n_elements,)
            Elements to use.
        angles : ndarray, shape (n_beams,)
            Arrival angles, rad.

        Returns
        -------
        ndarray, shape (n_beams, n_bins)
            Linear.
        """
        positions = self._positions[used]
        return beam_powers(
            spectra[:, used], self._frequencies, positions, self._sound_speed, angles
        )

    def hear(
        self,
        spectra: ComplexArray,
        used: BoolArray,
        power: FloatArray,
        normalised: FloatArray,
        track_ids: IdArray,
    ) -> list[tuple[HeardLine, float]]:
        """Return what each beam hears of its own direction, with the linear power in the beam.

        Parameters
        ----------
        spectra : ndarray, shape (n_bins, n_elements), complex
            Of the elements, linear amplitude.
        used : ndarray of bool, shape (n_elements,)
            Elements in use.
        power, normalised : ndarray, shape (n_beams, n_bins)
            Linear power of the beams, and over its background.
        track_ids : ndarray of uint64, shape (n_beams,)
            Bearing track of each beam.
        """
        margin = 10.0 ** (self._configuration.ownership_margin_db / 10.0)
        found = []
        for beam, track_id in enumerate(track_ids):
            peaks = find_peaks(normalised[beam], self.normaliser.threshold, power[beam])
            frequency = (self.first_bin + peaks.position) * self.bin_width
            for index, peak in enumerate(peaks.bin):
                level = float(power[beam, peak])
                if not self.inside[peak] or self._is_own_ship(float(frequency[index])):
                    continue
                if level * margin < self._strongest_power(spectra, used, int(peak)):
                    continue
                line = HeardLine(
                    track_id=int(track_id),
                    frequency=float(frequency[index]),
                    variance=float(peaks.variance[index]) * self.bin_width**2,
                    signal_to_noise_ratio=float(peaks.signal_to_noise_ratio[index]),
                )
                found.append((line, level))
        return found

    def rows(self, frame: SampleFrame, beams: Beams, normalised: FloatArray) -> LofarRows:
        """Return the rows of the LOFAR picture: the normalised spectra in decibel.

        Parameters
        ----------
        frame : SampleFrame
            The frame.
        beams : Beams
            Bearing track of each beam.
        normalised : ndarray, shape (n_beams, n_bins)
            Linear power over background.
        """
        inside = normalised[:, self.inside]
        level = 10.0 * np.log10(np.maximum(inside, 1e-10))
        first = float(self._frequencies[self.inside][0]) if self.inside.any() else np.nan
        return LofarRows(
            stamp=frame.stamp,
            track_id=beams.track_id,
            first_frequency=first,
            bin_width=self.bin_width,
            level_db=level.astype(np.float32),
            frame_id=frame.sensor.frame_id,
        )

    def _strongest_power(self, spectra: ComplexArray, used: BoolArray, peak: int) -> float:
        positions = self._positions[used]
        return strongest_power(
            spectra[peak, used], self._frequencies[peak], positions, self._sound_speed
        )

    def _is_own_ship(self, frequency: float) -> bool:
        configuration = self._configuration
        return any(
            abs(frequency - own) <= configuration.own_ship_tolerance
            for own in configuration.own_ship_frequencies
        )
