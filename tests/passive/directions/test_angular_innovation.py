"""Angular innovation and its fusion: sign, size, phase reference, variance."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sonar_tracking.geometry import steering_vectors
from sonar_tracking.passive.directions.angular_innovation import angular_innovations
from sonar_tracking.passive.directions.measurement_fusion import (
    correlated_variance_ratio,
    forgetting_factor_of,
    fused_measurement,
    independent_variance_ratio,
    mean_age,
)
from sonar_tracking.passive.subspaces.past import Past
from tests.passive.crossing_scene import POSITIONS, SAMPLE_PERIOD, WAVENUMBER, snapshots_of


def innovation_deg(true_deg: float, predicted_deg: float, reference: str) -> float:
    """Return the innovation of one noise-free target, deg."""
    basis = steering_vectors(POSITIONS, np.deg2rad([true_deg]), WAVENUMBER)[None]
    predicted = np.deg2rad([predicted_deg])
    return float(
        np.rad2deg(angular_innovations(basis, POSITIONS, predicted, WAVENUMBER, reference))[0, 0]
    )


@pytest.mark.parametrize("reference", ["first_element", "array_centre"])
def test_innovation_points_to_the_target(reference: str) -> None:
    # The sign printed in the paper is the other one, and diverges.
    assert innovation_deg(0.1, 0.0, reference) == pytest.approx(0.100, abs=1e-3)
    assert innovation_deg(-0.1, 0.0, reference) == pytest.approx(-0.100, abs=1e-3)
    assert innovation_deg(20.05, 20.0, reference) == pytest.approx(0.050, abs=1e-3)


@pytest.mark.parametrize(
    ("reference", "innovations"),
    [
        ("first_element", [0.88, 1.24, 1.15, 0.86, 0.54]),
        ("array_centre", [1.01, 2.07, 3.14, 3.79, 3.25]),
    ],
)
def test_first_element_as_reference_shrinks_large_innovations(
    reference: str, innovations: list[float]
) -> None:
    # Noise-free, one target at broadside, predicted 1 to 5 deg beside it.
    for offset, expected in enumerate(innovations, start=1):
        assert innovation_deg(0.0, -offset, reference) == pytest.approx(expected, abs=0.006)


@given(st.integers(0, 2**32 - 1), st.floats(0.0, 6.28), st.floats(0.01, 100.0))
@settings(max_examples=20, deadline=None)
def test_only_the_span_of_the_basis_matters(seed: int, phase: float, scale: float) -> None:
    generator = np.random.default_rng(seed)
    basis = generator.standard_normal((1, 15, 3)) + 1j * generator.standard_normal((1, 15, 3))
    mixing = np.eye(3) + 0.3 * generator.standard_normal((3, 3))
    other = scale * np.exp(1j * phase) * basis @ mixing
    predicted = np.array([0.1, -0.4])
    first = angular_innovations(basis, POSITIONS, predicted, WAVENUMBER)
    second = angular_innovations(other, POSITIONS, predicted, WAVENUMBER)
    assert np.allclose(first, second, rtol=1e-6, atol=1e-9)


def test_mirrored_scene_gives_mirrored_innovations() -> None:
    generator = np.random.default_rng(1)
    basis = generator.standard_normal((2, 15, 3)) + 1j * generator.standard_normal((2, 15, 3))
    predicted = np.array([0.1, -0.4])
    right = angular_innovations(basis, POSITIONS, predicted, WAVENUMBER, "array_centre")
    mirrored = basis[:, ::-1]
    left = angular_innovations(mirrored, POSITIONS, -predicted, WAVENUMBER, "array_centre")
    assert np.allclose(right, -left)


def test_batch_is_many_single_calls() -> None:
    generator = np.random.default_rng(2)
    shape = (4, 7, 15, 3)
    basis = generator.standard_normal(shape) + 1j * generator.standard_normal(shape)
    predicted = generator.uniform(-1.0, 1.0, (4, 2))
    together = angular_innovations(basis, POSITIONS, predicted, WAVENUMBER)
    assert together.shape == (4, 7, 2)
    for run in range(4):
        alone = angular_innovations(basis[run], POSITIONS, predicted[run], WAVENUMBER)
        assert np.allclose(together[run], alone, atol=1e-12)


def test_endfire_and_a_target_inside_the_subspace_stay_finite() -> None:
    # At endfire u vanishes; with a and a' both in the subspace nothing is left to measure with.
    generator = np.random.default_rng(3)
    basis = generator.standard_normal((1, 15, 3)) + 1j * generator.standard_normal((1, 15, 3))
    assert np.isfinite(angular_innovations(basis, POSITIONS, np.array([np.pi / 2]), 1.0)).all()
    pair = steering_vectors(POSITIONS, np.array([0.2, 0.2 + 1e-7]), WAVENUMBER)[None]
    inside = angular_innovations(pair, POSITIONS, np.array([0.2]), WAVENUMBER)
    assert np.isfinite(inside).all()


def test_fused_measurement_is_the_plain_mean() -> None:
    measured = np.arange(14.0).reshape(7, 2)
    assert np.array_equal(fused_measurement(measured), [6.0, 7.0])
    assert independent_variance_ratio(7) == pytest.approx(1.0 / 7.0)


def test_correlated_ratio_has_its_closed_forms() -> None:
    offsets = np.arange(-3, 4) * SAMPLE_PERIOD
    # Far apart they are independent; one alone is itself.
    assert correlated_variance_ratio(1e6 * offsets, SAMPLE_PERIOD, 0.9) == pytest.approx(1 / 7)
    assert correlated_variance_ratio(offsets[:1], SAMPLE_PERIOD, 0.9) == 1.0
    # The sheet's figures, (1/49) sum beta^|i-j|.
    for beta, ratio in [(0.86, 0.730), (0.90, 0.798), (0.95, 0.893), (0.99, 0.977)]:
        assert correlated_variance_ratio(offsets, SAMPLE_PERIOD, beta) == pytest.approx(
            ratio, abs=6e-4
        )
    # L snapshots between the updates act as beta^L.
    assert correlated_variance_ratio(20 * offsets, SAMPLE_PERIOD, 0.99) == pytest.approx(
        correlated_variance_ratio(offsets, SAMPLE_PERIOD, 0.99**20)
    )


def test_window_statistics() -> None:
    assert forgetting_factor_of((1 + 0.86) / (1 - 0.86)) == pytest.approx(0.86)
    weights = 0.9 ** np.arange(2000)
    assert mean_age(0.9) == pytest.approx((weights * np.arange(2000)).sum() / weights.sum())


@pytest.mark.parametrize("beta", [0.86, 0.95])
def test_claimed_variance_of_the_fusion_is_the_measured_one(beta: float) -> None:
    # Five separated static sources, 7 adjacent subspaces: R / P would be five times too small.
    generator = np.random.default_rng(4)
    angles = np.deg2rad([-50.0, -25.0, 0.0, 25.0, 50.0])
    runs, method = 60, Past(beta)
    state = method.start(15, 5, (runs,))
    collected = []
    for _ in range(8):
        data = snapshots_of(generator, np.broadcast_to(angles, (200, 5)), -3.0, (runs,))
        state = method.update(state, data[:, :193])
        bases = []
        for number in range(193, 200):
            state = method.update(state, data[:, number : number + 1])
            bases.append(state.basis)
        predicted = np.broadcast_to(angles, (runs, 5))
        stacked = np.stack(bases, axis=-3)
        collected.append(angular_innovations(stacked, POSITIONS, predicted, WAVENUMBER))
    innovations = np.array(collected[1:]).reshape(-1, 7, 5)
    single = innovations[:, 3].var(axis=0).mean()
    fused = fused_measurement(innovations).var(axis=0).mean()
    claimed = correlated_variance_ratio(np.arange(7) * SAMPLE_PERIOD, SAMPLE_PERIOD, beta)
    assert fused / single == pytest.approx(claimed, rel=0.15)
    assert fused / single > 4.0 * independent_variance_ratio(7)


def test_independent_subspaces_divide_the_variance_by_their_number() -> None:
    assert independent_variance_ratio(4) == 0.25
    assert correlated_variance_ratio([-0.01, 0.0, 0.01], 0.005, 0.5) == pytest.approx(
        (3.0 + 4.0 * 0.25 + 2.0 * 0.0625) / 9.0
    )
    assert forgetting_factor_of(1.9 / 0.1) == pytest.approx(0.9)
    assert mean_age(0.9) == pytest.approx(9.0)


def test_the_floor_at_endfire_is_a_share_of_what_the_array_gives_at_broadside() -> None:
    """Two elements 2 m apart, 1 rad/m, a source at broadside, c = cos(prediction) = 1e-8.

    y = (e^(2j) - 1) / 2 (-1, 1) and u = j 2 c e^(2j) / 2 (-1, 1), so that Re(u^H y) = c sin 2.
    |u|^2 = 2 c^2 is below the floor 1e-12 (2 m x 1 rad/m)^2.
    """
    positions = np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0]])
    basis = np.full((1, 2, 1), np.sqrt(0.5), dtype=complex)
    predicted = np.array([0.5 * np.pi - 1e-8])
    expected = -1e-8 * np.sin(2.0) / 4e-12
    for unit in (1.0, 10.0):
        found = angular_innovations(basis, unit * positions, predicted, 1.0 / unit)
        assert found[0] == pytest.approx([expected], rel=1e-6)
