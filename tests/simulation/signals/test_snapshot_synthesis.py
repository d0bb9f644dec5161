"""The core of the synthesis: batches, long blocks, shapes."""

import numpy as np
import pytest

from sonar_tracking.geometry import line_array, steering_vectors
from sonar_tracking.simulation.signals import snapshot_synthesis
from sonar_tracking.simulation.signals.snapshot_synthesis import (
    circular_gaussian,
    synthesize_snapshots,
)

POSITIONS = line_array(6, 0.5)
WAVENUMBER = 2.0 * np.pi
ANGLES = np.linspace(-0.9, 0.9, 21).reshape(7, 3)


def noise_and_signals(*batch: int) -> tuple[np.ndarray, np.ndarray]:
    generator = np.random.default_rng(1)
    return circular_gaussian(generator, (*batch, 7, 6)), circular_gaussian(
        generator, (*batch, 7, 3)
    )


def test_sum_of_sources_at_each_snapshot() -> None:
    noise, signals = noise_and_signals()
    data = synthesize_snapshots(POSITIONS, WAVENUMBER, ANGLES, signals, noise)
    for index in range(7):
        steering = steering_vectors(POSITIONS, ANGLES[index], WAVENUMBER)
        np.testing.assert_allclose(data[index], steering @ signals[index] + noise[index])


def test_batch_of_runs_equals_its_runs() -> None:
    noise, signals = noise_and_signals(4)
    batch = synthesize_snapshots(POSITIONS, WAVENUMBER, ANGLES, signals, noise)
    for run in range(4):
        single = synthesize_snapshots(POSITIONS, WAVENUMBER, ANGLES, signals[run], noise[run])
        np.testing.assert_allclose(batch[run], single, rtol=0, atol=1e-14)


def test_parts_of_a_long_block_join(monkeypatch: pytest.MonkeyPatch) -> None:
    noise, signals = noise_and_signals()
    whole = synthesize_snapshots(POSITIONS, WAVENUMBER, ANGLES, signals, noise)
    monkeypatch.setattr(snapshot_synthesis, "ENTRIES_AT_ONCE", 2 * 6 * 3)
    parts = synthesize_snapshots(POSITIONS, WAVENUMBER, ANGLES, signals, noise)
    np.testing.assert_array_equal(parts, whole)


def test_input_is_left_alone() -> None:
    noise, signals = noise_and_signals()
    before = noise.copy()
    synthesize_snapshots(POSITIONS, WAVENUMBER, ANGLES, signals, noise)
    np.testing.assert_array_equal(noise, before)


def test_wrong_shape_names_both() -> None:
    noise, signals = noise_and_signals()
    with pytest.raises(ValueError, match=r"\(7, 2\).*\(7, 3\)"):
        synthesize_snapshots(POSITIONS, WAVENUMBER, ANGLES, signals[:, :2], noise)


def test_no_sources_leave_the_noise() -> None:
    noise, signals = noise_and_signals()
    data = synthesize_snapshots(POSITIONS, WAVENUMBER, ANGLES[:, :0], signals[:, :0], noise)
    np.testing.assert_array_equal(data, noise)
