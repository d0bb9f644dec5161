"""What a solution says of the range, by hand."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.tma.targets.target_records import TargetSolution


def test_range_and_its_deviation_are_those_along_the_line_of_sight() -> None:
    solution = TargetSolution(
        stamp=0,
        side="single",
        probability=1.0,
        mean=np.array([13.0, 24.0, 0.0, 0.0]),
        covariance=np.diag([25.0, 100.0, 1.0, 1.0]),
        observability=1.0,
        observable=True,
        line_ids=(),
        source_frequency=np.zeros(0),
        source_frequency_deviation=np.zeros(0),
        manoeuvre=False,
    )
    distance, deviation = solution.range_from((10.0, 20.0))
    # Along (0.6, 0.8): 0.36 * 25 + 0.64 * 100 = 73.
    assert distance == pytest.approx(5.0)
    assert deviation == pytest.approx(np.sqrt(73.0))
