"""The broadband sound of a source can be read at any instant without changing what it is."""

import numpy as np

from sonar_tracking.simulation.signals.broadband_waveform import BroadbandWaveform

RATE = 1000.0


def waveform() -> BroadbandWaveform:
    return BroadbandWaveform(np.random.default_rng(5), RATE)


def test_a_delay_turns_the_phase_and_keeps_the_level() -> None:
    """Up to 0.85 of half the rate a reading 0.37 samples later is the same sound, advanced."""
    times = np.arange(4096) / RATE
    delay = 0.37 / RATE
    window = np.hanning(len(times))
    early, late = (
        np.fft.rfft(window * waveform().at(times + offset + 1.0)) for offset in (0.0, delay)
    )
    frequency = np.fft.rfftfreq(len(times), 1.0 / RATE)
    ratio = late / early * np.exp(-2j * np.pi * frequency * delay)
    low = frequency < 0.425 * RATE
    # Where a bin of the noise is nearly empty its neighbours leak in, hence the median.
    assert np.median(np.abs(ratio[low] - 1.0)) < 1e-3
    assert np.quantile(np.abs(ratio[low] - 1.0), 0.99) < 1e-2


def test_the_power_is_one_whatever_the_instants() -> None:
    times = np.asarray(2.0 + 1.0007 * np.arange(50_000) / RATE, np.float64)
    assert abs(np.var(waveform().at(times)) - 1.0) < 5.0 * np.sqrt(2.0 / 50_000) + 0.02


def test_blocks_do_not_change_the_sound() -> None:
    times = 3.0 + np.arange(1000)[:, None] * 0.999 / RATE + np.array([0.0, 0.01])
    whole = waveform().at(times)
    source = waveform()
    parts = np.concatenate([source.at(part) for part in np.array_split(times, 7)])
    np.testing.assert_array_equal(parts, whole)
