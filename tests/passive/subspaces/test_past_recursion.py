"""The compiled recursion of PAST and OPAST is the one in numpy, bit for bit."""

from __future__ import annotations

import shutil
import sysconfig
from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.evaluation.bench.bench_peers import textbook_past
from sonar_tracking.passive.subspaces import past_recursion
from sonar_tracking.passive.subspaces.past_recursion import lead_through
from sonar_tracking.records.arrays import ComplexArray
from tests.passive.crossing_scene import circular_noise

SHAPES = [((), 40, 15, 5), ((), 25, 3, 1), ((3,), 20, 17, 9), ((2, 2), 10, 8, 8), ((), 30, 64, 5)]


def start(
    batch: tuple[int, ...], n_elements: int, n_columns: int
) -> tuple[ComplexArray, ComplexArray]:
    basis = np.broadcast_to(
        np.eye(n_elements, n_columns, dtype=complex), (*batch, n_elements, n_columns)
    )
    inverse = np.broadcast_to(np.eye(n_columns, dtype=complex), (*batch, n_columns, n_columns))
    return basis, inverse


@pytest.mark.skipif(past_recursion.COMPILED is None, reason="no compiler was there: in numpy alone")
@pytest.mark.parametrize("orthonormal", [False, True])
@pytest.mark.parametrize(("batch", "n_snapshots", "n_elements", "n_columns"), SHAPES)
def test_compiled_and_in_numpy_give_the_same_bits(
    batch: tuple[int, ...],
    n_snapshots: int,
    n_elements: int,
    n_columns: int,
    orthonormal: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    generator = np.random.default_rng(n_elements)
    data = circular_noise(generator, *batch, n_snapshots, n_elements)
    data[..., :2, :] = 0.0  # silence leaves no signs of zero behind
    state = start(batch, n_elements, n_columns)
    before = [each.copy() for each in state]
    compiled = lead_through(data, *state, 0.97, orthonormal)
    monkeypatch.setattr(past_recursion, "COMPILED", None)
    plain = lead_through(data, *state, 0.97, orthonormal)
    for one, other in zip(compiled, plain, strict=True):
        assert one.shape == other.shape
        assert one.tobytes() == other.tobytes()
    for one, other in zip(state, before, strict=True):
        assert np.array_equal(one, other)  # what was given is as it was


@pytest.mark.skipif(
    shutil.which("cc") is None or not Path(sysconfig.get_path("include"), "Python.h").is_file(),
    reason="no compiler is there, or no headers of Python",
)
def test_it_is_compiled_where_a_compiler_is() -> None:
    assert past_recursion.COMPILED is not None


def test_in_numpy_it_is_the_recursion_of_the_textbook(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(past_recursion, "COMPILED", None)
    data = circular_noise(np.random.default_rng(3), 50, 15)
    basis, inverse = lead_through(data, *start((), 15, 4), 0.97, False)
    assert basis == pytest.approx(textbook_past(data, 4, 0.97), abs=1e-12)
    assert np.array_equal(inverse, inverse.conj().T)


def test_in_numpy_the_orthonormal_basis_stays_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(past_recursion, "COMPILED", None)
    data = circular_noise(np.random.default_rng(4), 50, 15)
    basis, _ = lead_through(data, *start((), 15, 4), 0.97, True)
    assert np.allclose(basis.conj().T @ basis, np.eye(4), atol=1e-13)


@pytest.mark.skipif(past_recursion.COMPILED is None, reason="no compiler was there: in numpy alone")
@pytest.mark.parametrize("wrong", [(1, 5, 3, 1), (1, 4, 3, 2), (2, 4, 3, 1), (-1, 4, -3, 1)])
def test_buffers_of_another_size_are_refused(wrong: tuple[int, int, int, int]) -> None:
    assert past_recursion.COMPILED is not None
    data, basis, inverse = (
        np.zeros((4, 3), complex),
        np.eye(3, 1, dtype=complex),
        np.ones((1, 1), complex),
    )
    with pytest.raises(ValueError, match="shape"):
        past_recursion.COMPILED.advance(data, basis, inverse, wrong, 0.97, False)
