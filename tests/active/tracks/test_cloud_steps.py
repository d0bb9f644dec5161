"""Steps of particles and moments of clouds: compiled they have the bits of the coding in numpy."""

from __future__ import annotations

import shutil
import sysconfig
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from sonar_tracking.active.tracks import cloud_steps
from sonar_tracking.active.tracks.cloud_steps import (
    begun_turns,
    cloud_moments,
    finished_turns,
    spread_particles,
)
from sonar_tracking.active.tracks.motion_modes import TURN_DIRECTIONS, turn_matrices
from sonar_tracking.records.arrays import FloatArray, IntArray

SHAPES = [(3, 200), (1, 50), (0, 100), (70,), (0,)]

needs_it = pytest.mark.skipif(
    cloud_steps.COMPILED is None, reason="no compiler was there: in numpy alone"
)


@pytest.fixture(params=["compiled", "in numpy"])
def _ways(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Compute in both ways, where there are two."""
    if request.param == "in numpy":
        monkeypatch.setattr(cloud_steps, "COMPILED", None)
    elif cloud_steps.COMPILED is None:
        pytest.skip("no compiler was there: in numpy alone")


def particles(shape: tuple[int, ...]) -> tuple[FloatArray, IntArray, IntArray]:
    """Return states, modes and how many on the next modes are; one particle is at rest."""
    generator = np.random.default_rng(len(shape))
    state = generator.normal(size=(*shape, 4)) * [3000.0, 3000.0, 2.0, 2.0]
    state[..., :1, 2:] = 0.0
    return state, generator.integers(0, 3, shape), generator.integers(0, 3, shape)


@pytest.mark.usefixtures("_ways")
def test_particles_turn_as_the_matrices_of_turns_say() -> None:
    state, mode, other = particles((2, 40))
    after, half = begun_turns(state, mode, other, 0.01, 10.0)
    assert np.array_equal(after, (mode + other) % 3)
    speed = np.maximum(np.hypot(state[..., 2], state[..., 3]), 0.3)
    rates = TURN_DIRECTIONS[after] * 0.01 / speed
    assert half == pytest.approx(5.0 * rates, rel=1e-14)
    noise = np.random.default_rng(3).normal(size=(2, 40, 2))
    moved = finished_turns(state, half, noise, 0.02, 10.0)
    expected = (turn_matrices(rates, 10.0) @ state[..., None])[..., 0]
    expected[..., :2] += 5.0 * 0.02 * noise
    expected[..., 2:] += 0.02 * noise
    assert moved == pytest.approx(expected, rel=1e-12, abs=1e-9)


@pytest.mark.usefixtures("_ways")
def test_moments_are_those_of_the_weighted_particles() -> None:
    state, _, _ = particles((2, 300))
    share = np.random.default_rng(4).random((2, 300))
    share /= share.sum(axis=1, keepdims=True)
    mean, covariance = cloud_moments(share, state)
    for cloud in range(2):
        assert mean[cloud] == pytest.approx(share[cloud] @ state[cloud], rel=1e-12)
        expected = np.cov(state[cloud].T, aweights=share[cloud], ddof=0)
        assert covariance[cloud] == pytest.approx(expected, rel=1e-10, abs=1e-6)


@pytest.mark.usefixtures("_ways")
def test_particles_are_spread_by_the_kernel_about_where_they_are_drawn_to() -> None:
    state, _, _ = particles((2, 30))
    generator = np.random.default_rng(5)
    drawn, noise = generator.integers(0, 30, (2, 30)), generator.normal(size=(2, 30, 4))
    mean, kernel = generator.normal(size=(2, 4)), generator.normal(size=(2, 4, 4))
    spread = spread_particles(state, drawn, noise, (mean, kernel), 0.9)
    for cloud in range(2):
        expected = 0.9 * state[cloud][drawn[cloud]] + 0.1 * mean[cloud]
        expected = expected + noise[cloud] @ kernel[cloud].T
        assert spread[cloud] == pytest.approx(expected, rel=1e-12, abs=1e-9)


def outcomes(shape: tuple[int, ...]) -> list[NDArray[Any]]:
    """Return all that is computed of some particles."""
    state, mode, other = particles(shape)
    generator = np.random.default_rng(7)
    after, half = begun_turns(state, mode, other, 0.01, 10.0)
    moved = finished_turns(state, half, generator.normal(size=(*shape, 2)), 0.02, 10.0)
    share = generator.random(shape)
    found: list[NDArray[Any]] = [after, half, moved, *cloud_moments(share, moved)]
    if len(shape) == 2:
        drawn = generator.integers(0, shape[1], shape)
        noise, mean = generator.normal(size=(*shape, 4)), generator.normal(size=(shape[0], 4))
        kernel = generator.normal(size=(shape[0], 4, 4)).swapaxes(1, 2)
        found.append(spread_particles(moved, drawn, noise, (mean, kernel), 0.9))
    return found


@needs_it
@pytest.mark.parametrize("shape", SHAPES)
def test_compiled_and_in_numpy_give_the_same_bits(
    shape: tuple[int, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    compiled = outcomes(shape)
    monkeypatch.setattr(cloud_steps, "COMPILED", None)
    for one, other in zip(compiled, outcomes(shape), strict=True):
        assert one.shape == other.shape
        assert one.tobytes() == other.tobytes()


@pytest.mark.skipif(
    shutil.which("cc") is None or not Path(sysconfig.get_path("include"), "Python.h").is_file(),
    reason="no compiler is there, or no headers of Python",
)
def test_it_is_compiled_where_a_compiler_is() -> None:
    assert cloud_steps.COMPILED is not None


def columns(*sizes: int) -> tuple[FloatArray, ...]:
    return tuple(np.zeros(size) for size in sizes)


@needs_it
def test_what_does_not_fit_is_refused() -> None:
    module = cloud_steps.COMPILED
    assert module is not None
    row, far = np.zeros(1, dtype=np.int64), np.full(1, 3)
    state, lateral, half = columns(4, 3, 1)
    finish, moments = columns(4, 1, 1, 1, 2, 4), columns(1, 4, 4, 16)
    refused: list[tuple[Callable[[], object], str]] = [
        (lambda: module.begin((state, row, row, lateral, row, half), 2, 0.3, 1.0), "shape"),
        (lambda: module.begin((state, far, row, lateral, row, half), 1, 0.3, 1.0), "modes"),
        (lambda: module.finish(finish, 2, 1.0, 1.0), "shape"),
        (lambda: module.finish(finish[:5], 1, 1.0, 1.0), "number"),
        (lambda: module.moments(moments, 1, 2), "shape"),
        (lambda: module.spread((state, far, *columns(4, 4, 16, 4)), 1, 1, 0.9), "not there"),
        (lambda: module.spread((state, row, *columns(4, 4, 16, 4)), 1, 2, 0.9), "shape"),
    ]
    for call, text in refused:
        with pytest.raises(ValueError, match=text):
            call()
