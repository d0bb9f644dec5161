"""Modes mixed and moved: the formulas of matrices, and compiled the bits of the coding in numpy."""

from __future__ import annotations

import shutil
import sysconfig
from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.active.tracks import mode_prediction
from sonar_tracking.active.tracks.acceleration_levels import AccelerationLevels
from sonar_tracking.active.tracks.mode_prediction import mixed_states, moved_states
from sonar_tracking.active.tracks.motion_modes import turn_matrices
from sonar_tracking.records.arrays import FloatArray

needs_it = pytest.mark.skipif(
    mode_prediction.COMPILED is None, reason="no compiler was there: in numpy alone"
)


@pytest.fixture(params=["compiled", "in numpy"])
def _ways(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Compute in both ways, where there are two."""
    if request.param == "in numpy":
        monkeypatch.setattr(mode_prediction, "COMPILED", None)
    elif mode_prediction.COMPILED is None:
        pytest.skip("no compiler was there: in numpy alone")


def states(n_tracks: int, n_modes: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return weights, means and covariances."""
    generator = np.random.default_rng(n_modes)
    weight = generator.random((n_tracks, n_modes, n_modes))
    weight /= weight.sum(axis=-1, keepdims=True)
    root = generator.normal(size=(n_tracks, n_modes, 4, 4)) * [[50.0], [50.0], [2.0], [2.0]]
    covariance = root @ root.swapaxes(-1, -2)
    mean = generator.normal(size=(n_tracks, n_modes, 4)) * [3000.0, 3000.0, 3.0, 3.0]
    return weight, mean, 0.5 * (covariance + covariance.swapaxes(-1, -2))


def matrices_of(kind: str, n_tracks: int, n_modes: int) -> FloatArray:
    if kind == "turns":
        return turn_matrices(np.random.default_rng(1).normal(size=(n_tracks, n_modes)), 10.0)
    if kind == "straight":
        return turn_matrices(np.zeros(1), 10.0)
    return AccelerationLevels(5.0).matrices(np.zeros((n_tracks, n_modes, 2)), 2.5)


KINDS = [("turns", 20, 3), ("turns", 7, 1), ("straight", 20, 1), ("straight", 9, 3)]
EVERY = [*KINDS, ("levels", 20, 5), ("levels", 0, 5), ("straight", 0, 1)]


@pytest.mark.usefixtures("_ways")
def test_mixed_modes_have_the_moments_of_the_mixture() -> None:
    weight, mean, covariance = states(6, 3)
    mixed, spread = mixed_states(weight, mean, covariance)
    for track in range(6):
        for mode in range(3):
            expected = weight[track, mode] @ mean[track]
            second = sum(
                w * (p + np.outer(m, m))
                for w, m, p in zip(weight[track, mode], mean[track], covariance[track], strict=True)
            )
            assert mixed[track, mode] == pytest.approx(expected, rel=1e-12)
            difference = second - np.outer(expected, expected)
            assert spread[track, mode] == pytest.approx(difference, rel=1e-9, abs=1e-6)


@pytest.mark.usefixtures("_ways")
@pytest.mark.parametrize(("kind", "n_tracks", "n_modes"), EVERY)
def test_moved_states_are_those_of_the_matrices(kind: str, n_tracks: int, n_modes: int) -> None:
    _, mean, covariance = states(n_tracks, n_modes)
    matrices = matrices_of(kind, n_tracks, n_modes)
    moved, spread = moved_states(matrices, mean, covariance)
    expected = matrices @ covariance @ matrices.swapaxes(-1, -2)
    assert moved == pytest.approx((matrices @ mean[..., None])[..., 0], rel=1e-12, abs=1e-9)
    assert spread == pytest.approx(expected, rel=1e-9, abs=1e-9)
    assert np.array_equal(spread, spread.swapaxes(-1, -2))


@needs_it
@pytest.mark.parametrize(("kind", "n_tracks", "n_modes"), EVERY)
def test_compiled_and_in_numpy_give_the_same_bits(
    kind: str, n_tracks: int, n_modes: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    weight, mean, covariance = states(n_tracks, n_modes)
    matrices = matrices_of(kind, n_tracks, n_modes)
    # As the tracker gives them: with the axes of the modes exchanged.
    weight = np.ascontiguousarray(weight.swapaxes(1, 2)).swapaxes(1, 2)
    compiled = mixed_states(weight, mean, covariance) + moved_states(matrices, mean, covariance)
    monkeypatch.setattr(mode_prediction, "COMPILED", None)
    plain = mixed_states(weight, mean, covariance) + moved_states(matrices, mean, covariance)
    for one, other in zip(compiled, plain, strict=True):
        assert one.shape == other.shape
        assert one.tobytes() == other.tobytes()


@pytest.mark.skipif(
    shutil.which("cc") is None or not Path(sysconfig.get_path("include"), "Python.h").is_file(),
    reason="no compiler is there, or no headers of Python",
)
def test_it_is_compiled_where_a_compiler_is() -> None:
    assert mode_prediction.COMPILED is not None


@needs_it
@pytest.mark.parametrize("wrong", [(2, 1), (1, 2), (1, 0), (-1, 1)])
def test_buffers_of_another_size_are_refused(wrong: tuple[int, int]) -> None:
    assert mode_prediction.COMPILED is not None
    one, four, sixteen = np.zeros(1), np.zeros(4), np.zeros(16)
    with pytest.raises(ValueError, match="shape"):
        mode_prediction.COMPILED.mix(one, four, sixteen, four.copy(), sixteen.copy(), wrong)
    with pytest.raises(ValueError, match="shape"):
        mode_prediction.COMPILED.move(sixteen, four, sixteen, four.copy(), sixteen.copy(), wrong)
