"""The threshold must be exceeded by noise as often as stated, whatever lines are about."""

import numpy as np
import pytest

from sonar_tracking.passive.background_normalisation import BackgroundNormaliser
from sonar_tracking.passive.beam_spectra import element_spectra

N_SAMPLES = 2000
FIRST, LAST = 3, 998


def noise_power(n_frames: int, seed: int) -> np.ndarray:
    generator = np.random.default_rng(seed)
    samples = generator.standard_normal(N_SAMPLES // 2 * (n_frames + 1))
    frames = np.stack([samples[k * 1000 : k * 1000 + N_SAMPLES] for k in range(n_frames)], axis=1)
    return np.asarray(np.abs(element_spectra(frames, FIRST, LAST)).T ** 2)


@pytest.mark.parametrize(
    ("probability", "half_width"), [(1e-2, 40), (1e-3, 40), (1e-3, 25), (1e-4, 40)]
)
def test_noise_exceeds_the_threshold_as_often_as_stated(
    probability: float, half_width: int
) -> None:
    """Half-overlapping Hann frames; 2000 of them have 2 million bins, the ends included."""
    power = noise_power(2000, seed=3)
    normaliser = BackgroundNormaliser(power.shape[1], half_width, probability)
    share = np.mean(normaliser.normalise(power) > normaliser.threshold)
    counting_error = np.sqrt(2.0 / (probability * power.size))
    assert share / probability == pytest.approx(1.0, abs=0.05 + 3.0 * counting_error)


def test_noise_has_mean_one_in_any_spectrum_that_is_smooth() -> None:
    power = noise_power(400, seed=4)
    normaliser = BackgroundNormaliser(power.shape[1], 40, 1e-3)
    assert np.mean(normaliser.normalise(power)) == pytest.approx(1.0, abs=0.03)
    slope = 1e3 * (np.arange(FIRST, LAST) / FIRST) ** -1.0
    assert np.mean(normaliser.normalise(power * slope)[:, 100:]) == pytest.approx(1.0, abs=0.05)


def test_a_strong_line_does_not_hide_its_neighbourhood() -> None:
    """Without the second pass 40 dB in one bin would raise the background by 20 dB around it."""
    power = noise_power(400, seed=5)
    power[:, 500] += 1e4
    normaliser = BackgroundNormaliser(power.shape[1], 40, 1e-3)
    level = np.mean(normaliser.normalise(power), axis=0)
    beside = level[np.r_[470:497, 504:531]]
    assert 10.0 * np.log10(np.mean(beside)) > -1.0
    assert level[500] == pytest.approx(1e4, rel=0.1)


def test_silence_stays_silent() -> None:
    normaliser = BackgroundNormaliser(200, 20, 1e-3)
    np.testing.assert_array_equal(normaliser.normalise(np.zeros((2, 200))), 0.0)
