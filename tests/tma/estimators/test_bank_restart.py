"""Protects the baselines: what is summed, and what each policy restarts."""

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.evaluation.studies.tma_frequency_fusion.scenarios import scenario
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.simulation.sensors.tma_scene import TmaRuns, simulate_runs
from sonar_tracking.tma.estimators.bank_restart import COVARIANCE, FULL, NEVER, SOURCE_FREQUENCY
from sonar_tracking.tma.estimators.chan_summed_lines import ChanSummedLines, sum_of_lines
from sonar_tracking.tma.estimators.jauffret_stacked_lines import JauffretStackedLines
from sonar_tracking.tma.estimators.single_filter_configuration import SingleFilterConfiguration

N_RUNS = 20


@pytest.fixture(scope="module")
def runs() -> TmaRuns:
    return simulate_runs(scenario("S1"), np.random.SeedSequence(3).spawn(N_RUNS))


def range_deviation(runs: TmaRuns, estimator: JauffretStackedLines | ChanSummedLines) -> FloatArray:
    estimates = [estimator.update(frame) for frame in runs.frames()]
    return np.array([np.sqrt(np.trace(one.covariance[0, :2, :2])) for one in estimates])


def test_the_sum_is_that_of_the_lines_present(runs: TmaRuns) -> None:
    frame = next(runs.frames())
    frame = replace(
        frame,
        frequency=np.array([200.0, np.nan, 300.0]),
        frequency_deviation=np.array([1.0, 1.0, 2.0]),
    )
    summed = sum_of_lines(frame)
    assert summed.frequency.tolist() == [500.0]
    assert summed.frequency_deviation == pytest.approx(np.sqrt(5.0))
    silent = sum_of_lines(replace(frame, frequency=np.full(3, np.nan)))
    assert not silent.heard.any()


@pytest.mark.parametrize(("policy", "restarts"), [(NEVER, False), (FULL, True), (COVARIANCE, True)])
def test_a_line_that_appears_restarts_only_by_policy(
    runs: TmaRuns, policy: str, restarts: bool
) -> None:
    deviation = range_deviation(
        runs, JauffretStackedLines(SingleFilterConfiguration(restart=policy))
    )
    # Frame 200 is the last in which a line appears; 235 the last in which one goes.
    assert (deviation[200] > 4000.0) == restarts
    assert deviation[235] <= deviation[234] * 1.1


def test_forgetting_source_frequencies_only_does_no_harm(runs: TmaRuns) -> None:
    kept = range_deviation(runs, JauffretStackedLines())
    forgot = range_deviation(
        runs, JauffretStackedLines(SingleFilterConfiguration(restart=SOURCE_FREQUENCY))
    )
    assert forgot[-1] < 1.1 * kept[-1]


def test_the_sum_restarts_at_any_change(runs: TmaRuns) -> None:
    deviation = range_deviation(runs, ChanSummedLines())
    assert deviation[234] < 3000.0
    assert deviation[235] > 4000.0
