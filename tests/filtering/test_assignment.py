"""The pairs of least cost are those of scipy, of which ours is a copy for few costs."""

import sys

import numpy as np
import pytest
from scipy.optimize import linear_sum_assignment

from sonar_tracking.filtering.assignment import least_cost_pairs


@pytest.fixture
def without_scipy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(sys.modules, "scipy.optimize")


@pytest.mark.usefixtures("without_scipy")
def test_few_costs_give_the_pairs_of_scipy_whatever_is_equal_among_them() -> None:
    random = np.random.default_rng(1)
    for _ in range(1500):
        shape = tuple(random.integers(0, 8, 2))
        for costs in (
            random.normal(size=shape),
            random.integers(0, 4, shape).astype(float),
            np.minimum(3.0 * random.random(shape), 1.0) ** 2,
        ):
            expected = linear_sum_assignment(costs)
            found = least_cost_pairs(costs)
            for ours, theirs in zip(found, expected, strict=True):
                np.testing.assert_array_equal(ours, theirs)


@pytest.mark.parametrize("unusable", [np.nan, np.inf])
def test_costs_that_are_no_numbers_are_refused(
    unusable: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    costs = np.full((2, 2), unusable)
    with pytest.raises(ValueError, match=r"infeasible|invalid"):
        linear_sum_assignment(costs)
    monkeypatch.delitem(sys.modules, "scipy.optimize")
    with pytest.raises(ValueError, match="finite"):
        least_cost_pairs(costs)
