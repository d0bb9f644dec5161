"""Protects which column belongs to which line: kept while it is heard, given up by the oldest."""

from __future__ import annotations

import numpy as np

from sonar_tracking.tma.estimators.error_models import ErrorEvidence, no_evidence
from sonar_tracking.tma.estimators.innovation_monitor import InnovationWindows
from sonar_tracking.tma.estimators.range_bank_state import RangeBankState
from sonar_tracking.tma.targets.line_columns import LineColumns, plan_columns, with_columns
from tests.tma.estimators.test_hypothesis_bank import random_bank


def lines(*numbers: int, sensor: str = "bow") -> tuple[tuple[str, int], ...]:
    return tuple((sensor, number) for number in numbers)


def test_lines_keep_their_columns_and_new_ones_come_behind() -> None:
    plan = plan_columns(LineColumns(), lines(7, 3), 10)
    assert (plan.column_of, plan.freed) == ((0, 1), ())
    plan = plan_columns(plan.columns, lines(3, 9), 20)
    assert (plan.column_of, plan.freed) == ((1, 2), ())
    assert plan.columns == LineColumns(lines(7, 3, 9), (10, 20, 20))
    # The same number of another sensor is another line.
    assert plan_columns(plan.columns, lines(3, sensor="stern"), 30).column_of == (3,)


def test_the_line_not_heard_for_longest_gives_up_its_column() -> None:
    columns = plan_columns(LineColumns(), lines(*range(16)), 10).columns
    for number, stamp in [(0, 20), (1, 15), (2, 30)]:
        columns = plan_columns(columns, lines(number), stamp).columns
    everyone = plan_columns(columns, lines(*range(3, 16)), 40).columns
    # Of 0, 1 and 2 the second is the oldest; lines of the frame itself are never given up.
    plan = plan_columns(everyone, lines(*range(3, 16), 99), 50)
    assert plan.freed == (1,)
    assert plan.column_of == (*range(3, 16), 1)
    assert plan.columns.lines[1] == ("bow", 99)
    assert plan.columns.heard[1] == 50
    two = plan_columns(everyone, lines(98, 99), 50)
    assert two.freed == (1, 0)
    assert two.column_of == (1, 0)


def state(n_lines: int = 2) -> RangeBankState:
    bank = random_bank(n_lines, batch=())
    generator = np.random.default_rng(3)
    windows = InnovationWindows(generator.normal(size=(n_lines, 20)), generator.normal(size=20))
    errors = no_evidence((), n_lines)
    errors = ErrorEvidence(generator.normal(size=errors.table.shape), errors.stamp + 9)
    return RangeBankState(1, bank, windows, errors, np.array(0), np.array(0.0))


def test_new_columns_are_empty_and_old_ones_stay() -> None:
    before = state()
    after = with_columns(before, 4, ())
    assert after.bank.mean.shape == (3, 8)
    np.testing.assert_array_equal(after.bank.mean[:, :6], before.bank.mean)
    assert not np.any(after.bank.mean[:, 6:])
    np.testing.assert_array_equal(after.bank.covariance[:, :6, :6], before.bank.covariance)
    assert not np.any(after.bank.covariance[:, 6:])
    assert not np.any(after.bank.covariance[:, :, 6:])
    assert after.bank.known.tolist() == [True, True, False, False]
    np.testing.assert_array_equal(after.windows.lines[:2], before.windows.lines)
    assert after.windows.lines.shape == (4, 20)
    assert not np.any(after.windows.lines[2:])
    np.testing.assert_array_equal(after.errors.table[:3], before.errors.table)
    np.testing.assert_array_equal(after.errors.table[3:], no_evidence((), 1).table[[1, 1]])
    assert after.errors.stamp.tolist() == [9, 9, 9, 0, 0]
    assert with_columns(before, 2, ()) is before


def test_a_column_that_is_given_up_forgets_its_line_and_no_other() -> None:
    before = state()
    copy = before.bank.covariance.copy()
    after = with_columns(before, 2, (1,))
    assert after.bank.known.tolist() == [True, False]
    kept = np.arange(5)
    np.testing.assert_array_equal(after.bank.mean[:, :5], before.bank.mean[:, :5])
    assert not np.any(after.bank.mean[:, 5])
    assert not np.any(after.bank.covariance[:, 5])
    assert not np.any(after.bank.covariance[:, :, 5])
    for component in range(3):
        block = np.ix_(kept, kept)
        np.testing.assert_array_equal(
            after.bank.covariance[component][block], copy[component][block]
        )
    np.testing.assert_array_equal(after.windows.lines[0], before.windows.lines[0])
    assert not np.any(after.windows.lines[1])
    np.testing.assert_array_equal(after.errors.table[:2], before.errors.table[:2])
    np.testing.assert_array_equal(after.errors.table[2], no_evidence((), 1).table[1])
    assert after.errors.stamp.tolist() == [9, 9, 0]
    np.testing.assert_array_equal(before.bank.covariance, copy)  # the state before is not changed
