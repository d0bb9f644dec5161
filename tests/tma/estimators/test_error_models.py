"""Protects what is learnt of errors: their size and how long they last, and nothing from motion."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.tma.estimators import error_models
from sonar_tracking.tma.estimators.error_models import (
    ErrorEvidence,
    azimuth_evidence,
    learn_errors,
    no_evidence,
    variance_factor,
    with_azimuth_evidence,
    with_lines,
)

SECOND = 1_000_000_000
N_ROWS = 40


def factors_after(errors: FloatArray, interval: float = 1.0) -> FloatArray:
    """Return the factors that errors, in told deviations, shape (n_frames, n_rows), lead to."""
    evidence = no_evidence((errors.shape[1],), 0)
    stamp = SECOND
    for one in errors:
        everything = np.ones((len(one), 1), dtype=bool)
        evidence = learn_errors(evidence, one[:, None], np.zeros((len(one), 1)), everything, stamp)
        stamp += round(interval * SECOND)
    return variance_factor(evidence, stamp)[:, 0]


def white(n_frames: int = 150) -> FloatArray:
    return np.random.default_rng(1).standard_normal((n_frames, N_ROWS))


def lasting(tau: float, n_frames: int = 150) -> FloatArray:
    phi = np.exp(-1.0 / tau)
    errors = white(n_frames)
    for frame in range(1, n_frames):
        errors[frame] = phi * errors[frame - 1] + np.sqrt(1.0 - phi**2) * errors[frame]
    return errors


def test_errors_as_told_leave_the_variance_as_told() -> None:
    factors = factors_after(white())
    assert np.median(factors) == pytest.approx(1.0, abs=0.01)
    assert np.mean(factors > 1.5) < 0.05


@pytest.mark.parametrize("times", [2.0, 4.0])
def test_larger_errors_are_found(times: float) -> None:
    factors = factors_after(times * white())
    assert np.median(factors) == pytest.approx(times**2, rel=0.3)
    assert np.min(factors) > 0.4 * times**2


@pytest.mark.parametrize("times", [0.5, 0.1, 0.0])
def test_smaller_errors_count_as_told(times: float) -> None:
    """Values that hardly scatter must not pass for ones whose errors last."""
    assert np.max(factors_after(times * white())) < 1.1


@pytest.mark.parametrize("tau", [3.0, 10.0])
def test_lasting_errors_count_by_their_density_at_frequency_zero(tau: float) -> None:
    expected = (1.0 + np.exp(-1.0 / tau)) / (1.0 - np.exp(-1.0 / tau))
    assert np.median(factors_after(lasting(tau))) == pytest.approx(expected, rel=0.4)


def test_rarer_values_are_less_alike() -> None:
    """One in ten of values that last 10 s: each tells nearly as much as it says."""
    factors = factors_after(lasting(10.0, 1500)[::10], 10.0)
    assert 1.0 <= np.median(factors) < 4.0


def test_a_few_wild_values_are_no_larger_errors() -> None:
    errors = white()
    errors[::30] = 50.0
    assert np.median(factors_after(errors)) < 1.5


def test_a_vague_prediction_tells_nothing() -> None:
    evidence = no_evidence((), 0)
    nothing = np.zeros(1, dtype=bool)
    after = learn_errors(evidence, np.full(1, 9.0), np.zeros(1), nothing, SECOND)
    np.testing.assert_array_equal(after.table, evidence.table)
    assert after.stamp.tolist() == [0]


def test_evidence_on_the_azimuths_of_each_station_is_its_own() -> None:
    here = ErrorEvidence(no_evidence((), 2).table + 1.0, np.array([5, 6, 7]))
    there = no_evidence((), 0)
    swapped = with_azimuth_evidence(here, there)
    np.testing.assert_array_equal(azimuth_evidence(swapped).table, there.table)
    np.testing.assert_array_equal(swapped.table[1:], here.table[1:])
    assert swapped.stamp.tolist() == [0, 6, 7]
    assert with_lines(here, 3, (0,)).stamp.tolist() == [5, 0, 7, 0]


@pytest.mark.skipif(error_models.COMPILED is None, reason="no compiler was there")
def test_compiled_models_give_the_bits_of_numpy(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rows with and without a value, at steady and unsteady times, some of them wild."""
    generator = np.random.default_rng(4)
    evidence, stamp = no_evidence((5,), 3), 1
    for _ in range(50):
        innovation, own = 2.0 * generator.standard_normal((5, 4)), generator.random((5, 4))
        telling, stamp = generator.random((5, 4)) < 0.8, stamp + int(generator.integers(1, 3) * 1e9)
        compiled = learn_errors(evidence, innovation, own, telling, stamp)
        with monkeypatch.context() as without:
            without.setattr(error_models, "COMPILED", None)
            plain = learn_errors(evidence, innovation, own, telling, stamp)
        np.testing.assert_array_equal(compiled.table, plain.table)
        np.testing.assert_array_equal(compiled.stamp, plain.stamp)
        evidence = compiled
