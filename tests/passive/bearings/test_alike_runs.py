"""Runs are alike whatever the numbers of their states are."""

from __future__ import annotations

import numpy as np

from sonar_tracking.passive.bearings.alike_runs import kind_of, rows_of, stacked
from sonar_tracking.passive.bearings.encounters import Encounter


def _encounter(log_odds: float) -> Encounter:
    return Encounter(np.zeros(4), np.eye(4), np.array(log_odds), np.array(True))


def test_runs_that_were_followed_together_stay_alike_when_their_numbers_differ() -> None:
    together = stacked([_encounter(-3.0), _encounter(1.0)])
    first, second = rows_of(together, 2)
    assert float(second.log_odds) == 1.0
    assert kind_of(first) == kind_of(second) == kind_of(_encounter(0.0))
