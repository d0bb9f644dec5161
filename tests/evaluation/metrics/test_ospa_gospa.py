"""OSPA and GOSPA against values worked out by hand."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sonar_tracking.evaluation.metrics.ospa_gospa import assign, gospa, ospa


def distances(truths: list[float], estimates: list[float]) -> np.ndarray:
    return np.abs(np.subtract.outer(np.array(truths, float), np.array(estimates, float)))


def both(truths: list[float], estimates: list[float], cutoff: float = 5.0) -> tuple[float, float]:
    assignment = assign(distances(truths, estimates), cutoff, 2.0)
    return ospa(assignment, cutoff, 2.0), gospa(assignment, cutoff, 2.0)


@pytest.mark.parametrize(
    ("truths", "estimates", "ospa_squared", "gospa_squared"),
    [
        ([], [], 0.0, 0.0),
        ([1.0], [], 25.0, 12.5),
        ([], [1.0, 2.0], 25.0, 25.0),
        ([0.0, 10.0], [1.0, 12.0], (1 + 4) / 2, 1 + 4),
        ([0.0, 10.0, 30.0], [1.0, 12.0], (1 + 4 + 25) / 3, 1 + 4 + 12.5),
        ([0.0], [7.0], 25.0, 25.0),  # beyond the cut-off: one missed and one false
        ([0.0], [5.0], 25.0, 25.0),  # at the cut-off: the same
        ([0.0, 4.0], [3.9, -3.0], (0.01 + 9) / 2, 0.01 + 9),
    ],
)
def test_hand_values(
    truths: list[float], estimates: list[float], ospa_squared: float, gospa_squared: float
) -> None:
    measured_ospa, measured_gospa = both(truths, estimates)
    assert measured_ospa**2 == pytest.approx(ospa_squared)
    assert measured_gospa**2 == pytest.approx(gospa_squared)


points = st.lists(st.floats(-20.0, 20.0), max_size=5)


@pytest.mark.slow
@given(points, points, points)
@settings(max_examples=100, deadline=None)
def test_both_are_metrics(a: list[float], b: list[float], c: list[float]) -> None:
    for measure in (0, 1):
        ab, ba = both(a, b)[measure], both(b, a)[measure]
        assert ab == pytest.approx(ba)
        assert both(a, c)[measure] <= ab + both(b, c)[measure] + 1e-9
        assert both(a, a)[measure] == 0.0
