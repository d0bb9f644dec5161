"""Protects the posterior bound."""

import numpy as np
import pytest

from sonar_tracking.evaluation.monte_carlo.batch_runner import RunBatch
from sonar_tracking.evaluation.studies.tma_frequency_fusion.runs import (
    SceneBatch,
    bound_of,
    scene_bound,
)
from sonar_tracking.evaluation.studies.tma_frequency_fusion.scenarios import scene_of_legs
from sonar_tracking.tma.performance.posterior_cramer_rao_bound import polar_bound

PATHS = RunBatch(0, tuple(np.random.SeedSequence(2).spawn(200)))


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("S1", (328, 156, 75, 79, 80)),
        ("S2", (876, 480, 301, 202, 145)),
        ("S3", (300, 206, 147, 108, 83)),
    ],
)
def test_the_scenarios_have_their_known_bounds(name: str, expected: tuple[float, ...]) -> None:
    bound = bound_of(SceneBatch(name, PATHS)).bound
    np.testing.assert_allclose(bound[199::50, 0], expected, rtol=0.05)


def test_doppler_adds_nothing_where_own_ship_turns() -> None:
    turning = scene_of_legs((90.0, 0.0, 90.0, 0.0), 1.0, acceleration=0.0)
    alone = RunBatch(0, PATHS.seeds[:1])
    with_lines = scene_bound(turning, alone)[-1, 0]
    turning.heard[:] = False
    assert with_lines == pytest.approx(58.15, rel=0.01)
    assert scene_bound(turning, alone)[-1, 0] == pytest.approx(58.17, rel=0.01)


def test_polar_bound_of_a_known_covariance() -> None:
    covariance = np.diag([100.0, 4.0, 0.09, 0.01])
    bound = polar_bound(covariance, np.array([1000.0, 0.0, 5.0, 0.0]), np.zeros(2))
    np.testing.assert_allclose(bound, [10.0, 2e-3, 0.02, 0.3])
