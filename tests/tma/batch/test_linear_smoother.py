"""Protects the linear smoother: it is the least-squares solution of all equations at once."""

import numpy as np
import pytest

from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.tma.batch import linear_recursion
from sonar_tracking.tma.batch.linear_smoother import LinearSystem, smooth_linear

SIZE, N_TIMES, ROWS = 3, 6, 2


def system(freedom: float = 4.0) -> LinearSystem:
    """Return a system in which some rows have no weight."""
    generator = np.random.default_rng(1)
    weight = generator.uniform(0.5, 2.0, (N_TIMES, ROWS))
    weight[2] = 0.0
    weight[4, 1] = 0.0
    return LinearSystem(
        start=KalmanState(generator.standard_normal(SIZE), np.diag([1.0, 2.0, 3.0])),
        transition=np.eye(SIZE) + 0.2 * generator.standard_normal((N_TIMES, SIZE, SIZE)),
        noise=np.tile(np.diag([0.3, 0.2, 0.1]), (N_TIMES, 1, 1)),
        matrix=generator.standard_normal((N_TIMES, ROWS, SIZE)),
        measured=generator.standard_normal((N_TIMES, ROWS)),
        weight=weight,
        variance=1.0 / np.where(weight > 0.0, weight, 1.0),
        degrees_of_freedom=freedom,
    )


def test_means_and_covariances_are_those_of_least_squares() -> None:
    """All states are unknowns; start, motions and measurements are equations with weights."""
    one = system()
    information = np.zeros((N_TIMES * SIZE, N_TIMES * SIZE))
    gradient = np.zeros(N_TIMES * SIZE)
    first = one.transition[0] @ one.start.covariance @ one.transition[0].T + one.noise[0]
    information[:SIZE, :SIZE] += np.linalg.inv(first)
    gradient[:SIZE] += np.linalg.solve(first, one.transition[0] @ one.start.mean)
    for index in range(N_TIMES):
        here = slice(index * SIZE, (index + 1) * SIZE)
        weighted = one.matrix[index].T * one.weight[index]
        information[here, here] += weighted @ one.matrix[index]
        gradient[here] += weighted @ one.measured[index]
        if index:
            both = slice((index - 1) * SIZE, (index + 1) * SIZE)
            change = np.hstack([-one.transition[index], np.eye(SIZE)])
            information[both, both] += change.T @ np.linalg.solve(one.noise[index], change)
    covariance = np.linalg.inv(information)
    mean = (covariance @ gradient).reshape(N_TIMES, SIZE)
    smoothed = smooth_linear(one)
    np.testing.assert_allclose(smoothed.mean, mean, rtol=1e-9)
    for index in range(N_TIMES):
        here = slice(index * SIZE, (index + 1) * SIZE)
        np.testing.assert_allclose(smoothed.covariance[index], covariance[here, here], rtol=1e-9)
        if index:
            before = slice((index - 1) * SIZE, index * SIZE)
            crossed = covariance[before, here]
            np.testing.assert_allclose(smoothed.crossed[index - 1], crossed, rtol=1e-8, atol=1e-12)


def test_a_system_that_explains_the_data_is_the_more_likely_one() -> None:
    """Student's t tends to the normal density: -ln sd - z^2 / 2 at 3 m and 2 m deviation."""
    still = LinearSystem(
        start=KalmanState(np.zeros(1), np.array([[1.0]])),
        transition=np.ones((1, 1, 1)),
        noise=np.zeros((1, 1, 1)),
        matrix=np.ones((1, 1, 1)),
        measured=np.array([[3.0]]),
        weight=np.array([[0.1]]),
        variance=np.array([[3.0]]),
        degrees_of_freedom=1e9,
    )
    expected = -np.log(2.0) - 0.5 * 1.5**2
    assert smooth_linear(still).log_likelihood == pytest.approx(expected, rel=1e-6)
    generator = np.random.default_rng(2)
    one = system()
    far = LinearSystem(**{**vars(one), "measured": 20.0 * generator.standard_normal((N_TIMES, 2))})
    assert smooth_linear(far).log_likelihood < smooth_linear(one).log_likelihood


def test_the_instant_without_a_covariance_is_named() -> None:
    one = system()
    noise = one.noise.copy()
    noise[3] = np.diag([-50.0, 0.2, 0.1])
    with pytest.raises(np.linalg.LinAlgError, match="instant 3"):
        smooth_linear(LinearSystem(**{**vars(one), "noise": noise}))


@pytest.mark.skipif(linear_recursion.COMPILED is None, reason="no compiler was there")
def test_compiled_recursions_give_the_bits_of_numpy(monkeypatch: pytest.MonkeyPatch) -> None:
    compiled = smooth_linear(system())
    monkeypatch.setattr(linear_recursion, "COMPILED", None)
    plain = smooth_linear(system())
    for name in ("mean", "covariance", "crossed", "log_likelihood"):
        assert np.array_equal(getattr(compiled, name), getattr(plain, name)), name
