"""What a long recording is thinned to must stand for all of it, its end included."""

from __future__ import annotations

import itertools

import pytest

from sonar_tracking.display.thinned_lists import Thinned


@pytest.mark.parametrize("count", [0, 1, 9, 10, 11, 12, 100, 1001])
def test_entries_are_evenly_chosen_and_the_last_is_among_them(count: int) -> None:
    thinned: Thinned[int] = Thinned(10)
    for value in range(count):
        thinned.append(value)
    kept = list(thinned)
    assert len(kept) == len(thinned) <= 11
    assert kept == list(range(count)) if count <= 10 else len(kept) >= 5
    if kept:
        assert (kept[0], kept[-1]) == (0, count - 1)
        steps = [after - before for before, after in itertools.pairwise(kept)]
        assert len(set(steps[:-1])) <= 1
