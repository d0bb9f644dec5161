"""Protects: what was true at an instant is told again as it was, until there is more truth."""

from __future__ import annotations

import numpy as np

from sonar_tracking.evaluation.metrics.bearing_truth import BearingTruth
from sonar_tracking.evaluation.monte_carlo.run_synthesis import block_truth
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario


def test_an_instant_asked_for_twice_is_the_same_until_truth_goes_on() -> None:
    samples = block_truth(load_scenario("doa_fusion"))[:3]
    truth = BearingTruth(samples[:2])
    later = samples[2].stamp - 1
    extrapolated = truth.at(later)
    again = truth.at(later)
    assert extrapolated is not None and again is not None
    assert np.array_equal(extrapolated.angle, again.angle)
    truth.add(samples[2])
    interpolated, known = truth.at(later), BearingTruth(samples).at(later)
    assert interpolated is not None and known is not None
    assert np.array_equal(interpolated.angle, known.angle)
    assert not np.array_equal(interpolated.angle, extrapolated.angle)
