"""Protects the rule for lists whose common past is not known: never more sure than is true."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.fusion.inverse_covariance_intersection import inverse_covariance_intersection


def test_an_estimate_with_itself_is_itself() -> None:
    """All is in common: (2/a - 1/a)^-1 = a."""
    own = KalmanState(np.array([1.0, 2.0]), np.diag([4.0, 9.0]))
    fused = inverse_covariance_intersection(own, own)
    np.testing.assert_allclose(fused.covariance, own.covariance)
    np.testing.assert_allclose(fused.mean, own.mean)


def test_orthogonal_knowledge_is_all_used() -> None:
    """One knows x, the other y: by hand, with w = 1/2, 1/1 + 1/100 - 2/101 = 0.990."""
    first = KalmanState(np.zeros(2), np.diag([1.0, 100.0]))
    second = KalmanState(np.ones(2), np.diag([100.0, 1.0]))
    fused = inverse_covariance_intersection(first, second)
    expected = 1.0 / (1.0 + 0.01 - 2.0 / 101.0)
    np.testing.assert_allclose(np.diagonal(fused.covariance), expected, rtol=1e-6)
    assert fused.mean[0] == pytest.approx(1.0 - fused.mean[1], abs=1e-9)


@pytest.mark.parametrize("share", [0.0, 0.3, 0.7, 0.95])
def test_it_never_claims_more_than_is_true(share: float) -> None:
    """Whatever information both have in common, the claimed covariance covers the real one."""
    generator = np.random.default_rng(3)
    for _ in range(20):
        base = generator.standard_normal((2, 2))
        common = np.linalg.inv(base @ base.T + 0.1 * np.eye(2)) * share
        own = [np.diag(generator.uniform(0.05, 3.0, 2)) for _ in range(2)]
        a, b = (np.asarray(np.linalg.inv(common + each)) for each in own)
        fused = inverse_covariance_intersection(
            KalmanState(np.zeros(2), a), KalmanState(np.array([1.0, 0.0]), b)
        )
        # The mean is K a + L b: its columns tell the gains.
        gain = np.empty((2, 2))
        for axis in (0, 1):
            unit = np.eye(2)[axis]
            gain[:, axis] = inverse_covariance_intersection(
                KalmanState(unit, a), KalmanState(np.zeros(2), b)
            ).mean
        other = np.eye(2) - gain
        between = a @ common @ b
        real = gain @ a @ gain.T + other @ b @ other.T
        real += gain @ between @ other.T + other @ between.T @ gain.T
        assert np.min(np.linalg.eigvalsh(fused.covariance - real)) > -1e-9
