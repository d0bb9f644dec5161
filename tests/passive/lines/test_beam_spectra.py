"""Protects the units of spectra and the delays of beams, against sums written out."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.passive.lines.beam_spectra import (
    beam_powers,
    element_spectra,
    strongest_power,
)

SOUND_SPEED = 1500.0


def test_white_noise_of_variance_one_has_power_one_and_a_tone_its_own() -> None:
    generator = np.random.default_rng(1)
    noise = np.abs(element_spectra(generator.standard_normal((512, 400)), 10, 240)) ** 2
    assert np.mean(noise) == pytest.approx(1.0, abs=0.02)
    tone = 3.0 * np.cos(2.0 * np.pi * 50.0 * np.arange(512) / 512)
    power = np.abs(element_spectra(tone[:, None], 45, 56)[:, 0]) ** 2
    # (A / 2)^2 times the squared sum of the window over the sum of its squares, 2 / 3 of 512.
    assert power[5] == pytest.approx(2.25 * 512.0 * 2.0 / 3.0)
    assert power[[4, 6]] == pytest.approx(np.full(2, power[5] / 4.0))
    assert power[[0, 1, 2, 3, 7, 8, 9, 10]] == pytest.approx(np.zeros(8), abs=1e-20)


@pytest.mark.parametrize("n_bins", [0, 1, 2, 37, 400])
def test_every_bin_is_turned_back_by_its_own_frequency(n_bins: int) -> None:
    """Products of two factors are as good as an exponential for each bin and element."""
    generator = np.random.default_rng(n_bins)
    positions = 1.8 * generator.standard_normal((7, 3))
    spectra = generator.standard_normal((n_bins, 7)) + 1j * generator.standard_normal((n_bins, 7))
    frequencies = np.asarray(40.0 + 0.25 * np.arange(n_bins), dtype=np.float64)
    angles = np.array([-2.0, 0.3])
    found = beam_powers(spectra, frequencies, positions, SOUND_SPEED, angles)
    lead = np.sin(angles)[:, None] * positions[:, 0] + np.cos(angles)[:, None] * positions[:, 1]
    turn = np.exp(-2j * np.pi * frequencies[:, None] * lead[:, None, :] / SOUND_SPEED)
    assert found == pytest.approx(np.abs((turn * spectra).mean(axis=-1)) ** 2, rel=1e-10, abs=1e-13)


def test_a_beam_is_the_mean_of_the_elements_delayed() -> None:
    generator = np.random.default_rng(2)
    positions = generator.normal(size=(5, 3))
    frequencies = np.array([100.0, 250.0, 300.0])
    spectra = generator.normal(size=(3, 5, 2)).view(np.complex128)[..., 0]
    angles = np.array([-2.0, 0.3, 1.1])
    powers = beam_powers(spectra, frequencies, positions, SOUND_SPEED, angles)
    for beam, angle in enumerate(angles):
        for row, frequency in enumerate(frequencies):
            total = 0.0 + 0.0j
            for element in range(5):
                lead = positions[element, 0] * np.sin(angle) + positions[element, 1] * np.cos(angle)
                phase = -2.0 * np.pi * frequency * lead / SOUND_SPEED
                total += spectra[row, element] * np.exp(1j * phase) / 5.0
            assert powers[beam, row] == pytest.approx(abs(total) ** 2)


@pytest.mark.parametrize("shape", ["line", "circle"])
@pytest.mark.parametrize("angle", [-1.3, -0.2, 0.0, 0.05, 0.9, 1.5])
def test_the_strongest_direction_is_found_wherever_it_is(shape: str, angle: float) -> None:
    """Between two of the directions that are tried a beam loses less than 1 dB."""
    around = 2.0 * np.pi * np.arange(12) / 12
    positions = np.zeros((12, 3))
    if shape == "line":
        positions[:, 0] = 2.5 * np.arange(12)
    else:
        positions[:, :2] = 4.0 * np.stack([np.cos(around), np.sin(around)], axis=1)
        angle += np.pi  # astern, where a line would hear the mirror image
    frequency = 290.0
    lead = positions[:, 0] * np.sin(angle) + positions[:, 1] * np.cos(angle)
    wave = 3.0 * np.exp(2j * np.pi * frequency * lead / SOUND_SPEED)
    found = strongest_power(wave, frequency, positions, SOUND_SPEED)
    assert 10.0**-0.1 * 9.0 < found <= 9.0 * (1.0 + 1e-9)
