"""Spatial smoothing compiled has the bits of the coding in numpy."""

from __future__ import annotations

import shutil
import sysconfig
from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.passive.sources import spatial_smoothing
from sonar_tracking.passive.sources.spatial_smoothing import forward_backward_smoothed

needs_it = pytest.mark.skipif(
    spatial_smoothing.COMPILED is None, reason="no compiler was there: in numpy alone"
)


@needs_it
@pytest.mark.parametrize(
    ("batch", "n_elements", "n_smoothed"),
    [((), 15, 10), ((3,), 8, 8), ((2, 2), 9, 2), ((4,), 64, 43), ((0,), 5, 3), ((2,), 1, 1)],
)
def test_compiled_and_in_numpy_give_the_same_bits(
    batch: tuple[int, ...], n_elements: int, n_smoothed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    generator = np.random.default_rng(n_elements)
    shape = (*batch, n_elements, n_elements + 3)
    snapshots = generator.normal(size=shape) + 1j * generator.normal(size=shape)
    covariance = snapshots @ snapshots.conj().swapaxes(-1, -2)
    covariance[..., n_elements // 2, :] = covariance[..., :, n_elements // 2] = 0.0  # silent
    compiled = forward_backward_smoothed(covariance, n_smoothed)
    monkeypatch.setattr(spatial_smoothing, "COMPILED", None)
    plain = forward_backward_smoothed(covariance, n_smoothed)
    assert compiled.shape == plain.shape == (*batch, n_smoothed, n_smoothed)
    assert np.array_equal(compiled, plain)  # a zero may have either sign


@pytest.mark.skipif(
    shutil.which("cc") is None or not Path(sysconfig.get_path("include"), "Python.h").is_file(),
    reason="no compiler is there, or no headers of Python",
)
def test_it_is_compiled_where_a_compiler_is() -> None:
    assert spatial_smoothing.COMPILED is not None


@needs_it
@pytest.mark.parametrize("wrong", [(2, 2, 1), (1, 2, 3), (1, 2, 0), (1, 3, 1), (-1, 2, 1)])
def test_buffers_of_another_size_are_refused(wrong: tuple[int, int, int]) -> None:
    assert spatial_smoothing.COMPILED is not None
    covariance, smoothed = np.zeros((2, 2), complex), np.zeros((1, 1), complex)
    with pytest.raises(ValueError, match="shape"):
        spatial_smoothing.COMPILED.smooth(covariance, smoothed, wrong)
