"""Protects what is kept of a bank's first measurements, and when it is looked at again."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sonar_tracking.tma.estimators.bank_beginning import (
    CHECKED_AFTER,
    MISJUDGED,
    Beginning,
    nothing_measured,
)
from sonar_tracking.tma.estimators.sensor_frame import TmaMeasurement

NOTHING = nothing_measured((), 1)


def measured(stamp: int = 1, n_sides: int = 1) -> TmaMeasurement:
    return TmaMeasurement(
        stamp=stamp,
        position=np.zeros(2),
        velocity=np.zeros(2),
        azimuth=np.zeros(n_sides),
        azimuth_variance=np.array(1e-4),
        frequency=np.array([100.0]),
        frequency_deviation=np.array([0.1]),
    )


def after(count: int, beginning: Beginning = NOTHING) -> Beginning:
    for number in range(count):
        following = beginning.after(measured(number + 1))
        assert following is not None
        beginning = following
    return beginning


def test_runs_are_looked_at_after_so_many_measurements_and_no_more_after_the_last() -> None:
    due = [count for count in range(CHECKED_AFTER[-1] + 1) if after(count).due]
    assert due == list(CHECKED_AFTER)
    assert after(CHECKED_AFTER[-1]).after(measured()) is None


def test_only_variances_that_are_much_larger_than_believed_are_misjudged() -> None:
    due = after(CHECKED_AFTER[0])
    for factor, misjudged in (([1.0, 1.0], False), ([2.0, 2.0], False), ([4.0, 1.0], True)):
        assert due.misjudged(np.array(factor)) == misjudged
    assert due.misjudged(np.array([1.0, 4.0])), "of a line"
    believed = replace(due, believed=np.array([4.0, 4.0]))
    assert not believed.misjudged(np.array([MISJUDGED * 4.0, 4.0]))
    assert not after(CHECKED_AFTER[0] - 1).misjudged(np.array([9.0, 9.0]))


def test_a_run_that_begins_anew_counts_from_there() -> None:
    runs = after(5, nothing_measured((2,), 0))
    lost = np.array([False, True])
    begun = runs.restarted(lost, np.array([[3.0], [5.0]]))
    assert begun.first.tolist() == [0, 5]
    assert begun.believed.tolist() == [[1.0], [5.0]]
    later = after(CHECKED_AFTER[0] - 5, begun)
    assert later.due.tolist() == [True, False]


def test_measurements_of_another_number_of_sides_end_it() -> None:
    assert after(3).after(measured(4, n_sides=2)) is None


def test_lines_that_come_have_no_value_before_and_those_forgotten_none_any_more() -> None:
    beginning = replace(after(2), believed=np.array([2.0, 3.0])).with_lines(3, (0,))
    assert beginning.believed.tolist() == [2.0, 1.0, 1.0, 1.0]
    for one in beginning.measurements:
        assert one.n_lines == 3 and not one.heard.any()
    kept = after(2).with_lines(2, ())
    assert [one.heard.tolist() for one in kept.measurements] == [[True, False]] * 2
