"""Snapshots must have the phase of the wave at their instant, and nothing from outside the band."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.passive.lines.demodulation import Demodulator, design_band

RATE = 48_000.0


def snapshots(samples: np.ndarray, pieces: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """Return the instants and snapshots of one channel in the band of 100 Hz around 5 kHz."""
    band = design_band(RATE, 5000.0, 100.0)
    demodulator = Demodulator(band, RATE)
    first = demodulator.next_centre
    parts = [demodulator.update(part) for part in np.array_split(samples[:, None], pieces)]
    data = np.concatenate(parts)[:, 0]
    return (first + band.decimation * np.arange(len(data))) / RATE, data


def test_a_sine_gives_its_amplitude_and_its_phase_at_the_instant_of_the_snapshot() -> None:
    time = np.arange(48_000) / RATE
    for frequency in (5000.0, 5010.0, 4991.0):
        instants, data = snapshots(3.0 * np.cos(2 * np.pi * frequency * time + 0.4))
        expected = 3.0 * np.exp(1j * (2 * np.pi * (frequency - 5000.0) * instants + 0.4))
        np.testing.assert_allclose(data, expected, atol=0.01)


def test_a_modulation_appears_without_delay() -> None:
    time = np.arange(96_000) / RATE
    envelope = 1.0 + 0.5 * np.cos(2 * np.pi * 3.0 * time)
    instants, data = snapshots(envelope * np.cos(2 * np.pi * 5000.0 * time))
    np.testing.assert_allclose(data.real, 1 + 0.5 * np.cos(2 * np.pi * 3.0 * instants), atol=5e-3)


def test_the_stop_band_and_the_image_are_60_db_down() -> None:
    time = np.arange(48_000) / RATE
    for frequency in (0.0, 1000.0, 4900.0, 5080.0, 5200.0, 12_345.0, 23_000.0):
        _, data = snapshots(np.cos(2 * np.pi * frequency * time))
        assert np.abs(data).max() < 2e-3, frequency


def test_pieces_of_any_length_give_the_same_snapshots() -> None:
    samples = np.random.default_rng(3).normal(size=20_000)
    _, whole = snapshots(samples)
    _, pieces = snapshots(samples, 37)
    assert len(whole) > 30
    np.testing.assert_allclose(pieces, whole, atol=1e-12)


def test_snapshots_of_white_noise_are_almost_independent() -> None:
    _, data = snapshots(np.random.default_rng(4).normal(size=480_000))
    correlation = np.vdot(data[:-1], data[1:]) / np.vdot(data, data)
    assert abs(correlation) < 0.25


def test_a_band_as_thin_as_a_hair_is_refused_before_its_filter_is_made() -> None:
    with pytest.raises(ConfigurationError, match=r"takes a filter of .* give a bandwidth above"):
        design_band(4e9, 1000.0, 10.0)


def test_a_band_that_does_not_fit_is_refused() -> None:
    for frequency, width, reason in (
        (23_950.0, 100.0, "below 23925 Hz"),
        (30_000.0, 100.0, "half the sample rate"),
        (50.0, 100.0, "below zero"),
        (5000.0, 0.0, "above zero"),
    ):
        with pytest.raises(ConfigurationError, match=reason):
            design_band(RATE, frequency, width)


def test_a_band_and_its_transition_must_fit_between_zero_and_half_the_sample_rate() -> None:
    """Half of the band and a quarter of it for the filter to fall: 75 Hz of 100."""
    for frequency in (75.1, 23_924.9):
        design_band(RATE, frequency, 100.0)
    for frequency in (75.0, 23_925.0):
        with pytest.raises(ConfigurationError):
            design_band(RATE, frequency, 100.0)
    with pytest.raises(ConfigurationError, match="must be above zero"):
        design_band(RATE, 5000.0, float("nan"))


@pytest.mark.parametrize(("width", "decimation"), [(100.0, 480), (100.1, 479), (48_000 / 7.5, 7)])
def test_snapshots_are_as_many_as_the_band_is_wide_or_a_few_more(
    width: float, decimation: int
) -> None:
    band = design_band(RATE, 8000.0, width)
    assert band.decimation == decimation
    assert (band.frequency, band.bandwidth) == (8000.0, width)
    assert band.reach == (len(band.taps) - 1) // 2
    assert np.sum(band.taps) == pytest.approx(1.0)


def test_a_carrier_that_turns_half_a_cycle_more_between_snapshots_keeps_its_phase() -> None:
    """5050 Hz goes through 50.5 cycles in the 480 samples of a step."""
    band = design_band(RATE, 5050.0, 100.0)
    samples = 3.0 * np.cos(2 * np.pi * 5050.0 * np.arange(9600) / RATE + 0.4)
    data = Demodulator(band, RATE).update(samples[:, None])
    assert len(data) > 4
    np.testing.assert_allclose(data[:, 0], 3.0 * np.exp(0.4j), atol=0.01)
