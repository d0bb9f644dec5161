"""Two accounts of an encounter: the more probable one is told, and names are open until decided."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.filtering.kalman import KalmanState
from sonar_tracking.passive.bearings.encounters import Encounter, no_encounter
from sonar_tracking.passive.bearings.joint_states import each_target, uncorrelated, with_marginals

PASSING = KalmanState(np.array([0.1, -0.1, 0.01, -0.01]), 1e-4 * np.eye(4))
BACK = KalmanState(np.array([-0.1, 0.1, -0.01, 0.01]), 1e-4 * np.eye(4))
NEAR, APART = np.array(True), np.array(False)


def begun(log_odds: float, back: KalmanState = BACK) -> Encounter:
    encounter, _ = no_encounter(PASSING).settled(PASSING, NEAR)
    return encounter.with_account(back, np.array(log_odds))


def test_an_encounter_begins_with_both_accounts_the_same_and_passing_more_probable() -> None:
    encounter, passing = no_encounter(PASSING).settled(PASSING, NEAR)
    assert encounter.open and not encounter.turned_back
    assert np.array_equal(encounter.mean, passing.mean)
    told = encounter.told(passing)
    assert told.covariance == pytest.approx(PASSING.covariance)
    assert told.mean == pytest.approx(PASSING.mean)


@pytest.mark.parametrize(("log_odds", "expected"), [(2.0, BACK), (-2.0, PASSING)])
def test_the_more_probable_account_is_told_as_uncertain_as_both_are(
    log_odds: float, expected: KalmanState
) -> None:
    told = begun(log_odds).told(PASSING)
    other = 1.0 / (1.0 + np.exp(abs(log_odds)))
    assert np.array_equal(told.mean, expected.mean)
    # The other one is 0.2 rad away, with its own probability.
    assert told.covariance[0, 0] == pytest.approx(1e-4 + other * 0.2**2)


def test_names_stay_open_after_parting_until_one_account_is_improbable() -> None:
    undecided, _ = begun(1.0).settled(PASSING, APART)
    assert undecided.open
    decided, passing = begun(5.0).settled(PASSING, APART)
    assert not decided.open
    assert np.array_equal(passing.mean, BACK.mean)
    assert np.array_equal(decided.told(passing).covariance, BACK.covariance)
    other_way, passing = begun(-5.0).settled(PASSING, APART)
    assert not other_way.open and np.array_equal(passing.mean, PASSING.mean)


def test_accounts_that_say_the_same_are_one_however_probable() -> None:
    alike = replace(BACK, mean=PASSING.mean + 0.01)
    over, passing = begun(0.5, alike).settled(PASSING, APART)
    assert not over.open and np.array_equal(passing.mean, alike.mean)


def test_runs_in_one_array_have_encounters_of_their_own() -> None:
    both = KalmanState(np.stack([PASSING.mean] * 2), np.stack([PASSING.covariance] * 2))
    encounter, passing = no_encounter(both).settled(both, np.array([True, False]))
    assert encounter.open.tolist() == [True, False]
    back = KalmanState(np.stack([BACK.mean] * 2), np.stack([BACK.covariance] * 2))
    told = encounter.with_account(back, np.array([4.0, 4.0])).told(passing)
    assert np.array_equal(told.mean, np.stack([BACK.mean, PASSING.mean]))


def test_targets_that_are_left_keep_the_account_of_their_own() -> None:
    targets = KalmanState(np.array([[0.1, 0.0], [0.2, 0.0]]), np.stack([np.eye(2)] * 2))
    own, other = uncorrelated(targets), replace(targets, mean=targets.mean + 1.0)
    rows = np.array([True, False])
    kept = each_target(with_marginals(own, other, other, rows))
    np.testing.assert_array_equal(kept.mean, [[1.1, 1.0], [0.2, 0.0]])
