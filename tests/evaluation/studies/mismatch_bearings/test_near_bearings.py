"""Protects: bearings near each other with default parameters, at reduced size and fixed seeds."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

from sonar_tracking.evaluation.studies.mismatch_bearings.conditions import CONDITIONS
from sonar_tracking.evaluation.studies.mismatch_bearings.runs import DEFAULTS, runs_under

pytestmark = pytest.mark.slow


def by_default(name: str, count: int) -> list[Mapping[str, float]]:
    seeds = np.random.SeedSequence(5).spawn(count)
    runs = runs_under(CONDITIONS[name], seeds, compared=False)
    return [run.metrics[DEFAULTS] for run in runs]


def mean(runs: list[Mapping[str, float]], metric: str) -> float:
    return float(np.mean([run[metric] for run in runs]))


@pytest.mark.parametrize("name", ["pair 3 deg apart, 0 dB", "pair 3 deg apart, 0 and 6 dB"])
def test_a_pair_within_half_a_beamwidth_becomes_two_tracks(name: str) -> None:
    runs = by_default(name, 4)
    assert mean(runs, "count_right_percent") > 85.0
    assert mean(runs, "nees_per_dimension") < 3.0
    assert mean(runs, "false_tracks") == 0.0


@pytest.mark.parametrize("name", ["stay 2 deg apart, turn back", "pass through, 0.3 deg/s"])
def test_names_are_right_whether_two_turn_back_or_pass(name: str) -> None:
    assert mean(by_default(name, 4), "right_names_percent") >= 75.0


def test_one_source_that_weaves_fast_is_not_taken_for_two() -> None:
    runs = by_default("weaving, 20 dB", 3)
    assert mean(runs, "count_right_percent") > 90.0 and mean(runs, "false_tracks") == 0.0
