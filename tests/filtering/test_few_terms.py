"""Protects: sums of a few terms are those of numpy, bit for bit, whatever the axis."""

import numpy as np
import pytest

from sonar_tracking.filtering.few_terms import sum_of_few


@pytest.mark.parametrize(
    ("shape", "axis"),
    [
        ((500, 3), 1),
        ((500, 4, 4), 1),
        ((500, 4, 4), -1),
        ((9, 3, 2, 2), 1),
        ((7, 1, 4), 1),
        ((0, 3), 1),
    ],
)
def test_the_sums_are_those_of_numpy(shape: tuple[int, ...], axis: int) -> None:
    values = np.random.default_rng(1).normal(size=shape)
    before = values.copy()
    np.testing.assert_array_equal(sum_of_few(values, axis), values.sum(axis=axis))
    np.testing.assert_array_equal(values, before)
