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
from sonar_tracking.tma.estimators.sensor_frame import TmaMeasurement
from sonar_tracking.tma.performance.posterior_cramer_rao_bound import polar_bound, posterior_bound

PATHS = RunBatch(0, tuple(np.random.SeedSequence(2).spawn(200)))


@pytest.mark.slow
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


@pytest.mark.parametrize("turn", [0.7, 2.5, -1.9])
def test_the_polar_bound_turns_with_the_scene(turn: float) -> None:
    """Range, azimuth, course and speed do not know where north is."""
    generator = np.random.default_rng(1)
    root = generator.normal(size=(4, 4))
    covariance = root @ root.T
    state, position = np.array([800.0, 500.0, 5.0, -2.0]), np.array([100.0, -50.0])
    expected = polar_bound(covariance, state, position)
    rotation = np.kron(np.eye(2), [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    turned = polar_bound(
        rotation @ covariance @ rotation.T, rotation @ state, rotation[:2, :2] @ position
    )
    np.testing.assert_allclose(turned, expected)


def bound_frame(stamp: int, position: list[float], heard: bool) -> TmaMeasurement:
    return TmaMeasurement(
        stamp=stamp,
        position=np.array(position),
        velocity=np.array([4.0, 1.0]),
        azimuth=np.array([0.0]),
        azimuth_variance=np.array(1e-4),
        frequency=np.array([300.0 if heard else np.nan]),
        frequency_deviation=np.array([0.1]),
    )


def test_the_recursion_is_that_of_information_and_process_noise() -> None:
    """P <- (P^-1 + J)^-1 after P <- F P F' + Q, with J averaged over the paths."""
    generator = np.random.default_rng(2)
    paths = np.array([3000.0, 1500.0, -3.0, 4.0]) + generator.normal(size=(5, 4, 4)) * [
        50.0,
        50.0,
        1.0,
        1.0,
    ]
    sources = np.array([300.0])
    prior = np.diag([4e6, 1e6, 100.0, 100.0])
    frames = [bound_frame(k * 10_000_000_000, [40.0 * k, 10.0 * k], heard=k != 1) for k in range(4)]
    bounds = list(posterior_bound(paths, sources, frames, prior, 0.05))
    covariance: np.ndarray = np.zeros((5, 5))
    covariance[:4, :4] = prior
    covariance[4, 4] = (300.0 / 6.0) ** 2
    motion = np.eye(5)
    motion[0, 2] = motion[1, 3] = 10.0
    noise = np.zeros((5, 5))
    noise[:4, :4] = 0.05**2 * np.kron([[1000.0 / 3.0, 50.0], [50.0, 10.0]], np.eye(2))
    for k, bound in enumerate(bounds):
        if k:
            covariance = motion @ covariance @ motion.T + noise
        information = np.zeros((5, 5))
        for path in paths[:, k]:
            rows = slopes(np.append(path, sources), frames[k])
            weight = [1e4, 100.0 if k != 1 else 0.0]
            information += (rows.T * weight) @ rows / len(paths)
        covariance = np.asarray(np.linalg.inv(np.linalg.inv(covariance) + information))
        deviation = np.sqrt(np.diag(covariance))
        scale = np.outer(deviation, deviation)
        np.testing.assert_allclose(bound / scale, covariance / scale, atol=1e-5)


def slopes(state: np.ndarray, frame: TmaMeasurement) -> np.ndarray:
    """Return the derivatives of azimuth and received frequency, by differences."""

    def predicted(at: np.ndarray) -> np.ndarray:
        offset = at[:2] - frame.position
        rate = offset @ (at[2:4] - frame.velocity) / np.hypot(*offset)
        return np.array([np.arctan2(offset[1], offset[0]), at[4] * (1.0 - rate / 1500.0)])

    steps = np.diag([1e-2, 1e-2, 1e-4, 1e-4, 1e-3])
    return np.stack(
        [(predicted(state + s) - predicted(state - s)) / (2.0 * s.sum()) for s in steps], axis=1
    )
