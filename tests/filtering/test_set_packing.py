"""Protects the choice of disjoint sets: the best of all, and a search that ends."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from sonar_tracking.filtering import set_packing
from sonar_tracking.filtering.set_packing import best_packing

Sets = list[frozenset[int]]


def drawn(seed: int, count: int = 11, n_members: int = 8) -> tuple[Sets, list[float]]:
    generator = np.random.default_rng(seed)
    sizes = generator.integers(1, 4, count)
    members = [frozenset(generator.permutation(n_members)[:size].tolist()) for size in sizes]
    return members, generator.normal(2.0, 3.0, count).tolist()


def by_trying_all(members: Sets, values: list[float]) -> float:
    best = 0.0
    for size in range(1, len(members) + 1):
        for chosen in combinations(range(len(members)), size):
            union = frozenset().union(*(members[row] for row in chosen))
            if len(union) == sum(len(members[row]) for row in chosen):
                best = max(best, sum(values[row] for row in chosen))
    return best


@pytest.mark.parametrize("seed", range(12))
def test_it_is_the_best_of_all(seed: int) -> None:
    members, values = drawn(seed)
    found = best_packing(members, values)
    assert found is not None
    value, chosen = found
    assert value == pytest.approx(by_trying_all(members, values))
    assert value == pytest.approx(sum(values[row] for row in chosen))
    union = frozenset().union(*(members[row] for row in chosen))
    assert len(union) == sum(len(members[row]) for row in chosen)


def test_only_more_than_enough_is_looked_for() -> None:
    members, values = drawn(3)
    found = best_packing(members, values)
    assert found is not None
    value, chosen = found
    assert best_packing(members, values, value - 0.01) == (pytest.approx(value), chosen)
    assert best_packing(members, values, value + 0.01) == (value + 0.01, ())


def test_nothing_is_chosen_of_nothing() -> None:
    assert best_packing([], []) == (0.0, ())
    assert best_packing([frozenset({0}), frozenset()], [-1.0, 2.0]) == (0.0, ())


def test_too_many_possibilities_are_said_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(set_packing, "MOST_NODES", 20)
    members, values = drawn(1, 60, 30)
    assert best_packing(members, values) is None
