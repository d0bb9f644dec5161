"""The pairs of least cost are those of scipy, of which ours is a copy for few costs."""

import sys
from typing import Any

import numpy as np
import pytest

from sonar_tracking.filtering import assignment
from sonar_tracking.filtering.assignment import least_cost_pairs


@pytest.fixture
def solver_of_scipy(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Return it, while its package seems not to be loaded."""
    from scipy.optimize import linear_sum_assignment

    monkeypatch.delitem(sys.modules, "scipy.optimize")
    monkeypatch.delitem(sys.modules, assignment.SOLVER, raising=False)
    return linear_sum_assignment


@pytest.mark.slow
def test_few_costs_give_the_pairs_of_scipy_whatever_is_equal_among_them(
    solver_of_scipy: Any,
) -> None:
    random = np.random.default_rng(1)
    for _ in range(1500):
        shape = tuple(random.integers(0, 8, 2))
        for costs in (
            random.normal(size=shape),
            random.integers(0, 4, shape).astype(float),
            np.minimum(3.0 * random.random(shape), 1.0) ** 2,
        ):
            expected = solver_of_scipy(costs)
            found = least_cost_pairs(costs)
            for ours, theirs in zip(found, expected, strict=True):
                np.testing.assert_array_equal(ours, theirs)


@pytest.mark.parametrize("unusable", [np.nan, np.inf])
def test_costs_that_are_no_numbers_are_refused(unusable: float, solver_of_scipy: Any) -> None:
    costs = np.full((2, 2), unusable)
    with pytest.raises(ValueError, match=r"infeasible|invalid"):
        solver_of_scipy(costs)
    with pytest.raises(ValueError, match="finite"):
        least_cost_pairs(costs)
