"""Protects: a bank that has believed too much begins anew, the others go on as they are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.evaluation.studies.tma_frequency_fusion.scenarios import scenario
from sonar_tracking.simulation.sensors.tma_scene import TmaRuns, simulate_runs
from sonar_tracking.tma.estimators.bank_beginning import CHECKED_AFTER
from sonar_tracking.tma.estimators.bank_replay import judge_beginning
from sonar_tracking.tma.estimators.range_bank import RangeBank, update_range_banks
from sonar_tracking.tma.estimators.range_bank_configuration import RangeBankConfiguration
from sonar_tracking.tma.estimators.range_bank_state import RangeBankState
from sonar_tracking.tma.estimators.sensor_frame import TmaMeasurement

pytestmark = pytest.mark.slow

FIRST = CHECKED_AFTER[0]

BELIEVING = RangeBankConfiguration(learn_errors=False)


def believe(state: RangeBankState | None, measurement: TmaMeasurement) -> RangeBankState:
    return update_range_banks([state], [measurement], BELIEVING)[0].state


def one_told_wrong_and_one_right() -> TmaRuns:
    """Return two runs whose bearings are told to be exact; those of the second are."""
    scene = scenario("S1")
    bad, good = (
        simulate_runs(replace(scene, azimuth_deviation=deviation), [np.random.SeedSequence(2)])
        for deviation in np.radians([0.5, 0.1])
    )
    return TmaRuns(
        replace(scene, azimuth_deviation=float(np.radians(0.1))),
        np.concatenate([bad.truth, good.truth]),
        np.concatenate([bad.azimuth, good.azimuth]),
        np.concatenate([bad.frequency, good.frequency]),
    )


def followed(runs: TmaRuns, count: int) -> tuple[RangeBankState, list[TmaMeasurement]]:
    bank, frames = RangeBank(), list(runs.frames())[:count]
    for measurement in frames:
        bank.update(measurement)
    assert bank.state is not None
    return bank.state, frames


def test_the_bank_that_believed_too_much_takes_everything_in_again() -> None:
    runs = one_told_wrong_and_one_right()
    state, frames = followed(runs, FIRST)
    judged = judge_beginning(state, frames[-1].stamp + 10**9, believe)
    assert judged.beginning is not None
    factor, right = judged.beginning.believed
    assert factor[0] > 4.0 and right.tolist() == [1.0] * len(right)
    np.testing.assert_array_equal(judged.bank.mean[1], state.bank.mean[1])
    np.testing.assert_array_equal(judged.errors.table, state.errors.table)

    again: RangeBankState | None = None
    for one in frames:
        again = believe(
            again,
            replace(
                one,
                azimuth_variance=one.azimuth_variance * factor[0],
                frequency_deviation=one.frequency_deviation * np.sqrt(factor[1:]),
            ),
        )
    assert again is not None
    np.testing.assert_allclose(judged.bank.mean[0], again.bank.mean[0], rtol=1e-9)
    np.testing.assert_allclose(judged.bank.log_weight[0], again.bank.log_weight[0], rtol=1e-9)


def test_a_bank_that_believed_what_is_right_stays_as_it_is() -> None:
    runs = simulate_runs(scenario("S1"), np.random.SeedSequence(3).spawn(4))
    for count in CHECKED_AFTER[:2]:
        state, frames = followed(runs, count)
        assert judge_beginning(state, frames[-1].stamp + 10**9, believe) is state


def test_a_run_alone_is_judged_as_it_is_among_others() -> None:
    runs = one_told_wrong_and_one_right()
    alone = TmaRuns(runs.scene, runs.truth[:1], runs.azimuth[:1], runs.frequency[:1])
    together, _ = followed(runs, FIRST + 3)
    single, _ = followed(alone, FIRST + 3)
    np.testing.assert_array_equal(together.bank.mean[0], single.bank.mean[0])
    assert single.beginning is not None and single.beginning.believed[0, 0] > 4.0


def test_first_measurements_are_forgotten_after_the_last_look() -> None:
    state, _ = followed(one_told_wrong_and_one_right(), CHECKED_AFTER[-1] + 1)
    assert state.beginning is None
