"""The threshold must be exceeded by noise as often as stated, whatever lines are about."""

import numpy as np
import pytest

from sonar_tracking.passive.lines.background_normalisation import BackgroundNormaliser
from sonar_tracking.passive.lines.beam_spectra import element_spectra

N_SAMPLES = 2000
FIRST, LAST = 3, 998
BINS = np.arange(FIRST, LAST, dtype=np.float64)


def noise_power(n_frames: int, seed: int) -> np.ndarray:
    generator = np.random.default_rng(seed)
    samples = generator.standard_normal(N_SAMPLES // 2 * (n_frames + 1))
    frames = np.stack([samples[k * 1000 : k * 1000 + N_SAMPLES] for k in range(n_frames)], axis=1)
    return np.asarray(np.abs(element_spectra(frames, FIRST, LAST)).T ** 2)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("probability", "half_width"), [(1e-2, 40), (1e-3, 40), (1e-3, 15), (1e-4, 40)]
)
def test_noise_exceeds_the_threshold_as_often_as_stated(
    probability: float, half_width: int
) -> None:
    """Half-overlapping Hann frames; 2000 of them have 2 million bins, the ends included."""
    power = noise_power(2000, seed=3)
    normaliser = BackgroundNormaliser(BINS, half_width, probability)
    share = np.mean(normaliser.normalise(power) > normaliser.threshold)
    counting_error = np.sqrt(2.0 / (probability * power.size))
    assert share / probability == pytest.approx(1.0, abs=0.05 + 3.0 * counting_error)


def test_noise_has_mean_one_in_any_spectrum_that_is_smooth() -> None:
    power = noise_power(400, seed=4)
    normaliser = BackgroundNormaliser(BINS, 40, 1e-3)
    assert np.mean(normaliser.normalise(power)) == pytest.approx(1.0, abs=0.03)
    slope = 1e3 * (np.arange(FIRST, LAST) / FIRST) ** -1.0
    assert np.mean(normaliser.normalise(power * slope)[:, 100:]) == pytest.approx(1.0, abs=0.05)


def test_a_strong_line_does_not_hide_its_neighbourhood() -> None:
    """Without the second pass 40 dB in one bin would raise the background by 20 dB around it."""
    power = noise_power(400, seed=5)
    power[:, 500] += 1e4
    normaliser = BackgroundNormaliser(BINS, 40, 1e-3)
    level = np.mean(normaliser.normalise(power), axis=0)
    beside = level[np.r_[470:497, 504:531]]
    assert 10.0 * np.log10(np.mean(beside)) > -1.0
    assert level[500] == pytest.approx(1e4, rel=0.1)


def test_silence_stays_silent() -> None:
    normaliser = BackgroundNormaliser(BINS[:200], 20, 1e-3)
    np.testing.assert_array_equal(normaliser.normalise(np.zeros((2, 200))), 0.0)


@pytest.mark.slow
@pytest.mark.parametrize("slope", [-2.0, -1.0, 1.0])
def test_a_steep_background_changes_no_false_alarm(slope: float) -> None:
    """Noise as 1/f^2 falls by 12 dB over one window at the low end; every octave is judged."""
    power = noise_power(2000, seed=6) * BINS**slope
    normaliser = BackgroundNormaliser(BINS, 40, 1e-3)
    above = normaliser.normalise(power) > normaliser.threshold
    assert np.mean(above) == pytest.approx(1e-3, rel=0.05 + 3.0 * np.sqrt(2.0 / 2000.0))
    for first in (20, 60, 180, 500):
        octave = above[:, first : 2 * first]
        error = 3.0 * np.sqrt(2.0 / (1e-3 * octave.size))
        assert np.mean(octave) == pytest.approx(1e-3, rel=0.15 + error)


@pytest.mark.slow
def test_a_background_that_bends_changes_no_false_alarm() -> None:
    """Ambient noise that falls as 1/f^2 onto the white noise of the amplifiers."""
    power = noise_power(1000, seed=7) * (1.0 + (200.0 / BINS) ** 2)
    normaliser = BackgroundNormaliser(BINS, 40, 1e-3)
    share = np.mean(normaliser.normalise(power) > normaliser.threshold)
    assert share == pytest.approx(1e-3, rel=0.05 + 3.0 * np.sqrt(2.0 / 1000.0))


@pytest.mark.parametrize("level_db", [20.0, 40.0, 60.0])
def test_a_strong_line_with_its_skirts_changes_little_beside_it(level_db: float) -> None:
    """Between two bins, over the noise of one: the background around stays within 0.8 dB."""
    generator = np.random.default_rng(8)
    steps = np.arange(N_SAMPLES)[:, None] / N_SAMPLES
    amplitude = np.sqrt(1.5 * 10.0 ** (0.1 * level_db) / N_SAMPLES) * 2.0
    phases = generator.uniform(0.0, 2.0 * np.pi, 600)
    samples = amplitude * np.cos(2.0 * np.pi * 500.4 * steps + phases)
    samples += generator.standard_normal(samples.shape)
    power = np.abs(element_spectra(samples, FIRST, LAST)).T ** 2
    normaliser = BackgroundNormaliser(BINS, 40, 1e-3)
    level = np.mean(normaliser.normalise(power), axis=0)
    beside = level[np.r_[457:482, 512:537]]
    assert 10.0 * np.log10(np.mean(beside)) == pytest.approx(0.0, abs=0.8)


def test_the_threshold_is_that_of_the_determinant() -> None:
    """Against the determinant itself, for a window of 12 bins on one side."""
    normaliser = BackgroundNormaliser(np.arange(1.0, 40.0), 12, 1e-4)
    lags = np.abs(np.subtract.outer(np.arange(12), np.arange(12)))
    correlation = np.where(lags < 3, np.array([1.0, 2 / 3, 1 / 6])[np.minimum(lags, 2)], 0.0)
    # Powers correlate with the squares, but their joint law is that of the amplitudes.
    determinant = np.linalg.det(np.eye(12) + normaliser.threshold[0] / 12 * correlation)
    assert 1.0 / determinant == pytest.approx(1e-4, rel=1e-3)


def test_the_background_of_a_bin_is_from_the_third_bin_on_and_from_no_other() -> None:
    """Three to fourteen bins away on either side; the trend of all moves them by a little."""
    normaliser = BackgroundNormaliser(BINS, 12, 1e-3)
    flat = np.ones(len(BINS))
    raised = flat.copy()
    raised[300] = 3.0
    changed = np.abs(normaliser.normalise(raised) / normaliser.normalise(flat) - 1.0) > 0.02
    expected = {*range(300 - 14, 300 - 2), 300, *range(300 + 3, 300 + 15)}
    assert set(np.flatnonzero(changed)) == expected


def test_at_the_ends_one_side_serves_alone() -> None:
    normaliser = BackgroundNormaliser(BINS, 12, 1e-3)
    flat = np.ones(len(BINS))
    level = normaliser.normalise(flat)
    # Equal powers are their mean, but noise would have been clipped to B where P > 8 B: its mean,
    # for P of mean 1 and B of as many independent bins as n / (1 + 2 (4/9 + 1/36)).
    for index, count in [(0, 12), (-1, 12), (500, 24)]:
        shape = count / (1.0 + 2.0 * (4.0 / 9.0 + 1.0 / 36.0))
        above = 1.0 + 8.0 / shape
        clipped = 1.0 - above**-shape - 7.0 * above ** -(shape + 1.0)
        assert level[index] == pytest.approx(clipped, rel=1e-9)


def test_the_threshold_of_two_windows_is_that_of_both_determinants() -> None:
    normaliser = BackgroundNormaliser(np.arange(1.0, 100.0), 12, 1e-3)
    lags = np.abs(np.subtract.outer(np.arange(12), np.arange(12)))
    correlation = np.where(lags < 3, np.array([1.0, 2 / 3, 1 / 6])[np.minimum(lags, 2)], 0.0)
    determinant = np.linalg.det(np.eye(12) + normaliser.threshold[50] / 24 * correlation)
    assert determinant**-2 == pytest.approx(1e-3, rel=1e-3)
    ends, middle = normaliser.threshold[[0, -1]], normaliser.threshold[50]
    assert ends[0] == pytest.approx(ends[1])
    assert np.all(ends > middle), "fewer bins know the background less"


@pytest.mark.parametrize(("level", "counted"), [(7.9, True), (8.2, False)])
def test_what_stands_out_by_more_than_eight_is_no_background(level: float, counted: bool) -> None:
    normaliser = BackgroundNormaliser(np.arange(1000.0, 1400.0), 40, 1e-3)
    power = np.ones(400)
    plain = normaliser.normalise(power)[195]
    power[200] = level
    changed = normaliser.normalise(power)[195]
    share = (level - 1.0) / 80.0 if counted else 0.0
    # What counts raises the mean of 80 bins, and by it the level at which the next is clipped.
    assert plain / changed - 1.0 == pytest.approx(share, abs=0.01)
