"""The broadband sound of a source can be read at any instant without changing what it is."""

import numpy as np
import pytest

from sonar_tracking.simulation.signals import broadband_waveform
from sonar_tracking.simulation.signals.broadband_waveform import BroadbandWaveform

RATE = 1000.0

needs_it = pytest.mark.skipif(
    broadband_waveform.COMPILED is None, reason="no compiler was there: in numpy alone"
)


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


@needs_it
@pytest.mark.parametrize("shape", [(), (1,), (3,), (7, 5), (64, 3)])
def test_compiled_and_in_numpy_give_the_same_bits(
    shape: tuple[int, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Between the points of the grid, on them, and before the beginning of time."""
    times = np.random.default_rng(len(shape)).uniform(-0.5, 2.0, shape)
    times = np.where(times < 0.5, np.round(times * RATE) / RATE, times)
    compiled = waveform().at(times)
    monkeypatch.setattr(broadband_waveform, "COMPILED", None)
    plain = waveform().at(times)
    assert compiled.shape == plain.shape == shape
    np.testing.assert_array_equal(compiled, plain)


@needs_it
@pytest.mark.parametrize("step", [14.9, 48.1, np.nan, np.inf, -1e300])
def test_instants_outside_of_the_grid_are_refused(step: float) -> None:
    assert broadband_waveform.COMPILED is not None
    grid, table, out = np.zeros(64), np.zeros((5, 32)), np.empty(2)
    broadband_waveform.COMPILED.interpolate(grid, table, np.array([15.0, 47.9]), out, (0, 4, 32))
    with pytest.raises(ValueError, match="outside"):
        broadband_waveform.COMPILED.interpolate(
            grid, table, np.array([20.0, step]), out, (0, 4, 32)
        )
    with pytest.raises(ValueError, match="shape"):
        broadband_waveform.COMPILED.interpolate(grid, table, np.zeros(3), out, (0, 4, 32))
