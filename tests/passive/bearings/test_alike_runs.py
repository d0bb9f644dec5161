"""Runs are alike whatever the numbers of their states are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sonar_tracking.passive.bearings.alike_runs import (
    kind_of,
    kind_of_estimates,
    rows_of,
    stacked,
    stacked_estimates,
)
from sonar_tracking.passive.bearings.encounters import Encounter
from tests.passive.estimate_scene import estimates_of

UNIT = np.eye(15, dtype=complex)


def _encounter(log_odds: float) -> Encounter:
    return Encounter(np.zeros(4), np.eye(4), np.array(log_odds), np.array(True))


def test_runs_that_were_followed_together_stay_alike_when_their_numbers_differ() -> None:
    together = stacked([_encounter(-3.0), _encounter(1.0)])
    first, second = rows_of(together, 2)
    assert float(second.log_odds) == 1.0
    assert kind_of(first) == kind_of(second) == kind_of(_encounter(0.0))


def test_columns_that_are_not_measured_in_tell_no_runs_apart() -> None:
    two, three = (replace(estimates_of(UNIT, basis=np.eye(15, n)[None]), rank=1) for n in (2, 3))
    assert kind_of_estimates(two, True) == kind_of_estimates(three, True)
    assert kind_of_estimates(two, False) != kind_of_estimates(three, False)
    unknown = [replace(each, rank=-1) for each in (two, three)]
    assert kind_of_estimates(unknown[0], True) != kind_of_estimates(unknown[1], True)
    together = stacked_estimates([two, three])
    assert together.basis.shape == (2, 1, 15, 2)
