"""Frequencies of lines: without bias, with a variance that is what it says."""

import numpy as np
import pytest

from sonar_tracking.passive.lines.beam_spectra import element_spectra
from sonar_tracking.passive.lines.spectral_peaks import SpectralPeaks, find_peaks, hann_transform

N_SAMPLES = 512
THRESHOLD = np.full(200, 8.0)


def spectra(position: np.ndarray, snr: float, generator: np.random.Generator | None) -> np.ndarray:
    """Return power spectra of one tone each, in bins, at a signal-to-noise ratio on its top."""
    steps = np.arange(N_SAMPLES)[:, None] / N_SAMPLES
    amplitude = 4.0 * np.sqrt(0.375 * snr / N_SAMPLES)
    phase = 1.0 if generator is None else generator.uniform(0.0, 2.0 * np.pi, len(position))
    samples = amplitude * np.cos(2.0 * np.pi * position * steps + phase)
    if generator is not None:
        samples = samples + generator.standard_normal(samples.shape)
    return np.asarray(np.abs(element_spectra(samples, 0, 200)).T ** 2)


def strongest(peaks: SpectralPeaks) -> tuple[float, float, float]:
    top = int(np.argmax(peaks.signal_to_noise_ratio))
    return peaks.position[top], peaks.variance[top], peaks.signal_to_noise_ratio[top]


def test_without_noise_the_frequency_is_exact() -> None:
    positions = 100.0 + np.linspace(-0.5, 0.5, 21)
    found = [
        strongest(find_peaks(power, THRESHOLD, power))[0] for power in spectra(positions, 1e8, None)
    ]
    np.testing.assert_allclose(found, positions, atol=2e-4)


@pytest.mark.slow
@pytest.mark.parametrize("snr_db", [6.0, 8.0, 10.0, 12.0, 15.0, 20.0, 30.0, 45.0])
def test_the_variance_is_what_it_says(snr_db: float) -> None:
    """Mean squared error over claimed variance, from just above the threshold on."""
    generator = np.random.default_rng(6)
    positions = 100.0 + generator.uniform(-0.5, 0.5, 3000)
    power = spectra(positions, 10.0 ** (snr_db / 10.0), generator)
    near = [find_peaks(each, THRESHOLD, each) for each in power]
    found = [
        (strongest(peaks), position)
        for peaks, position in zip(near, positions, strict=True)
        if len(peaks.bin)
    ]
    error = np.array([peak[0] - position for peak, position in found])
    variance = np.array([peak[1] for peak, _ in found])
    line = np.abs(error) < 1.5  # noise elsewhere may stand out more than a weak line
    assert np.mean(line) > (0.7 if snr_db <= 10.0 else 0.99)
    ratio = np.mean(error[line] ** 2 / variance[line])
    # At 6 dB only the luckiest third passes the threshold.
    tolerance = 0.5 if snr_db < 8.0 else 0.2 if snr_db <= 12.0 else 0.1
    assert ratio == pytest.approx(1.0, abs=tolerance)
    assert abs(np.mean(error[line])) < 4.0 * np.sqrt(np.mean(variance) / len(error))


def test_the_variance_is_near_the_cramer_rao_bound() -> None:
    """The bound is 6 / (4 pi^2 1.5 snr) bins^2; a Hann frame needs 2.6 to 3.7 times as much."""
    generator = np.random.default_rng(7)
    positions = 100.0 + generator.uniform(-0.5, 0.5, 500)
    bound = 6.0 / (4.0 * np.pi**2 * 1.5 * 1e3)
    claimed = [
        strongest(find_peaks(each, THRESHOLD, each))[1]
        for each in spectra(positions, 1e3, generator)
    ]
    assert 2.3 < np.mean(claimed) / bound < 3.9


def test_the_level_is_that_of_the_line_between_two_bins_too() -> None:
    for position in (100.0, 100.25, 100.5):
        power = spectra(np.array([position]), 1e4, None)[0]
        assert strongest(find_peaks(power, THRESHOLD, power))[2] == pytest.approx(1e4, rel=1e-2)


def test_sidelobes_of_a_strong_line_are_no_lines() -> None:
    power = spectra(np.array([100.3]), 1e7, None)[0] + 1.0
    assert len(find_peaks(power, THRESHOLD, power).bin) == 1


def test_a_weak_line_beside_a_strong_one_is_found() -> None:
    power = spectra(np.array([100.3]), 1e4, None)[0] + spectra(np.array([106.0]), 30.0, None)[0]
    np.testing.assert_allclose(
        find_peaks(power, THRESHOLD, power).position, [100.3, 106.0], atol=0.05
    )


def test_nothing_above_the_threshold_is_no_line() -> None:
    assert len(find_peaks(np.ones(200), THRESHOLD, np.ones(200)).bin) == 0


def tones(*lines: tuple[float, float]) -> np.ndarray:
    """Return noise of power 1 and tones at (bin, ratio) as a Hann frame has them, without phase."""
    power = np.ones(200)
    for position, ratio in lines:
        power += ratio * hann_transform(np.arange(200.0) - position) ** 2
    return power


def test_the_transform_is_that_of_the_window() -> None:
    """Against the sum over a long window, its poles at one bin included."""
    count = 4096
    steps = np.arange(count) - count / 2
    window = 0.5 + 0.5 * np.cos(2.0 * np.pi * steps / count)
    offsets = np.array([-3.5, -1.0, -0.3, 0.0, 0.5, 1.0, 1.0 + 1e-9, 2.0, 2.5])
    expected = [np.sum(window * np.cos(2.0 * np.pi * x * steps / count)) for x in offsets]
    np.testing.assert_allclose(hann_transform(offsets), np.array(expected) * 2.0 / count, atol=1e-6)


@pytest.mark.parametrize(("offset", "kappa"), [(0.0, 0.37), (0.5, 0.26), (-0.5, 0.26)])
def test_the_variance_is_kappa_over_the_ratio(offset: float, kappa: float) -> None:
    power = tones((100.0 + offset, 1e8))
    assert strongest(find_peaks(power, THRESHOLD, power))[1] * 1e8 == pytest.approx(
        kappa, abs=0.006
    )


@pytest.mark.parametrize("ratio", [9.0, 20.0, 100.0])
def test_a_weak_line_is_known_worse_by_the_fitted_factor(ratio: float) -> None:
    strong, weak = tones((100.0, 1e8)), tones((100.0, ratio))
    kappa = strongest(find_peaks(strong, THRESHOLD, strong))[1] * 1e8
    position, variance, found = strongest(find_peaks(weak, THRESHOLD, weak))
    assert (position, found) == (pytest.approx(100.0), pytest.approx(ratio))
    factor = 1.0 + 1.0 / ratio + 10.0 / ratio**2 + 600.0 / ratio**3
    assert variance == pytest.approx(kappa / ratio * factor, rel=1e-5)


def test_a_bin_hardly_above_the_noise_is_taken_for_a_ratio_of_a_half() -> None:
    power = np.ones(200)
    power[100] = 1.3
    (peak,) = find_peaks(power, np.full(200, 1.2), power).signal_to_noise_ratio
    assert peak == 0.5


def test_the_shape_of_a_line_is_that_of_its_power_and_its_level_that_over_the_background() -> None:
    """The background beside a strong line is raised by the line itself."""
    power = tones((100.3, 1e6))
    background = np.ones(200)
    background[101:] = 3.0
    position, _, ratio = strongest(find_peaks(power / background, THRESHOLD, power))
    assert position == pytest.approx(100.3, abs=1e-3)
    assert ratio == pytest.approx(1e6, rel=1e-3)


def test_each_bin_has_its_threshold_and_the_ends_have_no_neighbours() -> None:
    power = tones((50.0, 20.0), (150.0, 20.0))
    threshold = np.full(200, 8.0)
    threshold[100:] = 21.0
    assert find_peaks(power, threshold, power).bin.tolist() == [50]
    threshold[100:] = 20.99
    assert find_peaks(power, threshold, power).bin.tolist() == [50, 150]
    ends = np.ones(200)
    ends[[0, 199]] = 100.0
    assert len(find_peaks(ends, THRESHOLD, ends).bin) == 0
    ends[[1, 198]] = 101.0
    assert find_peaks(ends, THRESHOLD, ends).bin.tolist() == [1, 198]


def test_two_equal_bins_are_one_line_halfway_between() -> None:
    power = np.ones(200)
    power[100:102] = 50.0
    peaks = find_peaks(power, THRESHOLD, power)
    assert peaks.bin.tolist() == [101]
    assert peaks.position == pytest.approx([100.5], abs=1e-6)


@pytest.mark.parametrize(("weak", "found"), [(85.0, False), (100.0, True)])
def test_a_line_must_stand_6_db_above_the_sidelobes_of_a_stronger_one(
    weak: float, found: bool
) -> None:
    """Six bins away their envelope is (6 pi (36 - 1))^-2 = 2.30e-6: 92 of 1e7, with the margin."""
    for aside in (106.0, 94.0):
        power = tones((100.0, 1e7), (aside, weak))
        bins = find_peaks(power, THRESHOLD, power).bin.tolist()
        assert (int(aside) in bins) == found
        assert 100 in bins


def test_within_the_main_lobe_of_a_line_there_is_no_weaker_one() -> None:
    for second, expected in [(50.0, [100, 102]), (49.0, [100])]:
        power = np.ones(200)
        power[[100, 102]] = [50.0, second]
        assert find_peaks(power, THRESHOLD, power).bin.tolist() == expected
    power = np.ones(200)
    power[[100, 103]] = [1000.0, 20.0]  # beyond it: 4 (3 pi 8)^-2 1000 = 0.7
    assert find_peaks(power, THRESHOLD, power).bin.tolist() == [100, 103]


def test_two_peaks_below_the_noise_are_no_skirts() -> None:
    """With a low threshold a line may be weaker than the noise: no peak is its own skirt."""
    power = np.ones(200)
    power[[50, 120]] = 1.6
    assert find_peaks(power, np.full(200, 1.5), power).bin.tolist() == [50, 120]
