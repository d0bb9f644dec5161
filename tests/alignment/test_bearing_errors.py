"""Protects what is learnt of an array: how large its errors are, how long they last."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.alignment.bearing_errors import LARGEST_SCALE, BearingErrors
from sonar_tracking.records.arrays import FloatArray

TOLD = 1e-4


def learnt(errors: FloatArray) -> float:
    """Return the scale after errors of two bearing tracks; predictions are exact."""
    known = BearingErrors()
    for pair in errors:
        known.learn([("array", 1), ("array", 2)], pair, np.zeros(2), np.full(2, TOLD))
    return known.scale


def white(count: int) -> FloatArray:
    return 1e-2 * np.random.default_rng(2).standard_normal((count, 2))


def test_errors_as_told_change_nothing() -> None:
    assert learnt(white(300)) < 1.25


@pytest.mark.parametrize("factor", [2.0, 4.0])
def test_larger_errors_are_found(factor: float) -> None:
    assert learnt(factor * white(400)) == pytest.approx(factor**2, rel=0.4)


def test_errors_that_last_count_as_fewer() -> None:
    """Correlation .8 from one to the next: nine of them tell as much as one, by hand."""
    errors = white(400)
    for row in range(1, len(errors)):
        errors[row] = 0.8 * errors[row - 1] + 0.6 * errors[row]
    assert 4.0 < learnt(errors) < 12.0


def test_bearings_of_something_else_tell_nothing() -> None:
    errors = white(200)
    errors[::3] = 1.0
    assert learnt(errors) < 1.4


def test_the_scale_has_a_limit() -> None:
    known = BearingErrors()
    for step in range(400):
        size = 1e-2 * min(1.02**step, 1e3) * (-1) ** (step // 20)
        known.learn([("array", 1)], np.array([size]), np.zeros(1), np.array([TOLD]))
    assert known.scale <= LARGEST_SCALE
