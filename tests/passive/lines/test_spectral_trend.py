"""Protects the trend of a spectrum: exact for what it models, unmoved by lines and by units."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.passive.lines.spectral_trend import SpectralTrend

FREQUENCIES = np.linspace(10.0, 400.0, 781)
LOGARITHM = np.log(FREQUENCIES)


@pytest.mark.parametrize("power", [3.0, 2.0, -2.0])
def test_powers_of_frequency_and_their_bends_are_met_exactly(power: float) -> None:
    spectrum = 7.0 * FREQUENCIES**power * np.exp(0.1 * (LOGARITHM - 3.0) ** 2)
    np.testing.assert_allclose(SpectralTrend(FREQUENCIES).of(spectrum), spectrum, rtol=1e-9)


def test_the_fit_is_a_parabola_of_the_logarithms_made_twice() -> None:
    """The second time what lies more than 1.5 above the first counts as if 1.5 above."""
    generator = np.random.default_rng(1)
    spectra = generator.exponential(size=(3, 781)) * FREQUENCIES**-1.5
    spectra[:, 300] *= 1e6
    trend = SpectralTrend(FREQUENCIES).of(spectra)
    for row, spectrum in enumerate(spectra):
        values = np.log(spectrum)
        first = np.polyval(np.polyfit(LOGARITHM, values, 2), LOGARITHM)
        clipped = np.minimum(values, first + 1.5)
        second = np.polyval(np.polyfit(LOGARITHM, clipped, 2), LOGARITHM)
        np.testing.assert_allclose(trend[row], np.exp(second), rtol=1e-6)


def test_a_trend_has_the_unit_of_its_spectrum() -> None:
    spectrum = np.random.default_rng(2).exponential(size=781)
    trend = SpectralTrend(FREQUENCIES)
    for unit in (1e-20, 1e20):
        np.testing.assert_allclose(trend.of(unit * spectrum), unit * trend.of(spectrum), rtol=1e-9)
    # The unit of the frequencies does not count at all.
    other = SpectralTrend(1e3 * FREQUENCIES).of(spectrum)
    np.testing.assert_allclose(other, trend.of(spectrum), rtol=1e-9)


def test_silence_and_dead_bins_leave_a_positive_trend() -> None:
    spectra = np.ones((2, 781))
    spectra[0] = 0.0
    spectra[1, ::7] = 0.0
    trend = SpectralTrend(FREQUENCIES).of(spectra)
    np.testing.assert_array_equal(trend[0], 1.0)
    # A dead bin counts as 120 dB below the strongest.
    values = np.log(np.where(spectra[1] > 0.0, 1.0, 1e-12))
    first = np.polyval(np.polyfit(LOGARITHM, values, 2), LOGARITHM)
    second = np.polyfit(LOGARITHM, np.minimum(values, first + 1.5), 2)
    np.testing.assert_allclose(trend[1], np.exp(np.polyval(second, LOGARITHM)), rtol=1e-6)


@pytest.mark.parametrize("count", [1, 2, 3])
def test_few_bins_are_their_own_trend(count: int) -> None:
    spectrum = np.array([3.0, 2.0, 5.0])[:count]
    trend = SpectralTrend(np.array([1.0, 2.0, 3.0])[:count]).of(spectrum)
    np.testing.assert_allclose(trend, spectrum)


def test_a_narrow_band_far_from_zero_is_met_as_well() -> None:
    """One hertz at 10 kHz: its logarithms differ in their fifth digit alone."""
    frequencies = np.linspace(10_000.0, 10_001.0, 101)
    along = 1e4 * np.log(frequencies / 10_000.0)
    spectrum = np.exp(2.0 + along - 3.0 * along**2)
    np.testing.assert_allclose(SpectralTrend(frequencies).of(spectrum), spectrum, rtol=2e-8)
