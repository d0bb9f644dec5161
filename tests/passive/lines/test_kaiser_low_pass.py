"""The filter is the one of scipy.signal to the last bit: recordings replay as before."""

from __future__ import annotations

import numpy as np

from sonar_tracking.passive.lines.kaiser_low_pass import kaiser_low_pass


def test_the_taps_are_those_of_scipy() -> None:
    from scipy.signal import firwin, kaiserord  # which no other test should wait for

    generator = np.random.default_rng(1)
    for _ in range(200):
        rate = float(generator.choice([1000.0, 4000.0, 44_100.0, 48_000.0]))
        cutoff = generator.uniform(1e-3, 0.05) * rate
        transition = generator.uniform(0.2, 1.0) * cutoff
        n_taps, shape = kaiserord(60.0, transition / (rate / 2))
        taps = firwin(n_taps | 1, cutoff, window=("kaiser", shape), fs=rate)
        assert kaiser_low_pass(rate, cutoff, transition, 60.0).tobytes() == taps.tobytes()


def test_it_passes_what_is_below_and_stops_what_is_above() -> None:
    taps = kaiser_low_pass(1000.0, 50.0, 20.0, 60.0)
    assert len(taps) % 2 == 1
    np.testing.assert_array_equal(taps, taps[::-1])
    times = np.arange(len(taps)) - len(taps) // 2

    def gain(frequency: float) -> float:
        return float(np.sum(taps * np.cos(2 * np.pi * frequency / 1000.0 * times)))

    assert abs(gain(0.0) - 1.0) < 1e-12
    assert abs(gain(40.0) - 1.0) < 1.5e-3
    assert abs(gain(50.0) - 0.5) < 1e-2
    for frequency in np.linspace(60.0, 500.0, 100):
        assert abs(gain(frequency)) < 1.5e-3
