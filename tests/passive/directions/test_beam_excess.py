"""Power in beams: a source brings what it should, coloured noise and tracked sources nothing."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.geometry import line_array, steering_vectors, wavenumber
from sonar_tracking.passive.directions.beam_excess import BeamExcess, beam_excess, beam_grid
from sonar_tracking.records.arrays import ComplexArray, FloatArray
from sonar_tracking.records.bearings import SubspaceEstimates

POSITIONS = line_array(15, 0.5)
NUMBER = wavenumber(1500.0, 1500.0)
NONE = np.empty(0)


def estimates_of(noise: ComplexArray | None = None) -> SubspaceEstimates:
    return SubspaceEstimates(
        stamp=0,
        method="covariance",
        basis=np.empty((0, 15, 0), dtype=np.complex128),
        time_offsets=np.empty(0),
        element_positions=POSITIONS,
        sample_period=0.005,
        center_frequency=1500.0,
        bandwidth=100.0,
        sound_speed=1500.0,
        effective_snapshots=100.0,
        noise_covariance=noise,
    )


def waves(*sources: tuple[float, float]) -> ComplexArray:
    """Return the covariance of sources of some power from some angles, rad."""
    total = np.zeros((15, 15), dtype=np.complex128)
    for power, angle in sources:
        vector = steering_vectors(POSITIONS, np.array([angle]), NUMBER)
        total += power * vector @ vector.conj().T
    return total


def correlated(correlation: float) -> ComplexArray:
    lags = np.abs(np.subtract.outer(np.arange(15), np.arange(15)))
    return (correlation**lags).astype(np.complex128)


def beams_of(
    covariance: ComplexArray, tracked: FloatArray = NONE, noise: ComplexArray | None = None
) -> BeamExcess:
    beams = beam_excess(estimates_of(noise), covariance, 100, tracked)
    assert beams is not None
    return beams


def angles() -> FloatArray:
    grid = beam_grid(POSITIONS, NUMBER)
    assert grid is not None
    return grid.angles


def test_a_source_brings_its_power_into_its_beam_and_nowhere_more() -> None:
    angle = float(angles()[30])
    beams = beams_of(np.eye(15) + waves((0.01, angle)))
    # 15 x 0.01, but for what it adds to the noise that it is compared with.
    assert beams.excess[30] == pytest.approx(0.15, rel=0.07)
    assert np.argmax(beams.excess) == 30
    assert beams.received < 0.02


def test_noise_correlated_between_near_elements_brings_next_to_nothing() -> None:
    assert beams_of(correlated(0.3)).excess.max() < 0.02
    # Without leaving lags out, broadside would show most of a source of -12 dB.
    vector = steering_vectors(POSITIONS, np.zeros(1), NUMBER)[:, 0]
    assert (vector.conj() @ correlated(0.3) @ vector).real / 15 > 1.7


def test_channels_of_unequal_noise_bring_nothing() -> None:
    noise = np.diag(np.linspace(0.5, 1.5, 15)).astype(np.complex128)
    assert np.abs(beams_of(noise).excess).max() < 1e-9


def test_tracked_sources_bring_nothing_even_while_they_move() -> None:
    path = np.radians(np.linspace(9.0, 11.0, 21))
    covariance = np.eye(15) + waves(*((100.0 / 21, angle) for angle in path))
    beams = beams_of(covariance, np.radians([9.0, 10.0, 11.0]))
    assert np.abs(beams.excess[beams.free]).max() < 0.05
    near = np.abs(np.sin(angles()) - np.sin(np.radians(10.0))) < 0.03
    assert not beams.free[near].any() and beams.free.mean() > 0.8
    assert beams.received == pytest.approx(100.0, rel=0.05)


def test_a_faint_source_beside_a_strong_one_keeps_its_power() -> None:
    angle = float(angles()[70])
    covariance = np.eye(15) + waves((100.0, np.radians(-20.0)), (0.02, angle))
    beams = beams_of(covariance, np.radians([-21.0, -20.0, -19.0]))
    assert beams.excess[70] == pytest.approx(0.3, rel=0.15)


def test_told_noise_is_whitened_and_the_source_in_it_seen() -> None:
    noise = correlated(0.6)
    silent = beams_of(noise, noise=noise)
    assert np.abs(silent.excess).max() < 1e-9
    assert silent.whitened and not beams_of(noise).whitened
    angle = float(angles()[80])
    seen = beams_of(noise + waves((0.01, angle)), noise=noise)
    assert abs(int(np.argmax(seen.excess)) - 80) <= 1 and seen.excess.max() > 0.2


def test_nothing_is_told_of_other_arrays_and_of_crowded_ones() -> None:
    assert beam_grid(line_array(4, 0.5), NUMBER) is None
    uneven = POSITIONS.copy()
    uneven[3, 0] += 0.2
    assert beam_grid(uneven, NUMBER) is None
    covariance = np.eye(15, dtype=np.complex128)
    many = np.radians(np.linspace(-60.0, 60.0, 10))
    assert beam_excess(estimates_of(), covariance, 100, many) is None
    assert beam_excess(estimates_of(), np.zeros_like(covariance), 100, NONE) is None
