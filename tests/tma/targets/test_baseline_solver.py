"""Protects what the published methods are fed and what is made of their estimates.

A recorder stands in for the method: it remembers its measurements and claims to know the target.
"""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from sonar_tracking.errors import InputError
from sonar_tracking.tma.estimators.sensor_frame import TmaEstimate, TmaMeasurement
from sonar_tracking.tma.targets.array_sides import LEFT, RIGHT, SINGLE
from sonar_tracking.tma.targets.baseline_solver import BaselineSolver
from sonar_tracking.tma.targets.target_records import TargetObservation

SECOND = 1_000_000_000
SEEN = TargetObservation(
    stamp=SECOND,
    sensor_id="bow",
    position=(1.0, 2.0),
    velocity=(3.0, 4.0),
    azimuths=(0.5,),
    azimuth_variance=1e-4,
    sound_speed=1480.0,
    propagation_speed=1490.0,
)


class Recorder:
    """Remembers its measurements."""

    def __init__(self) -> None:
        self.fed: list[TmaMeasurement] = []

    def update(self, measurement: TmaMeasurement) -> TmaEstimate:
        self.fed.append(measurement)
        n = measurement.n_lines
        return TmaEstimate(
            stamp=measurement.stamp,
            mean=np.array([1000.0, 500.0, 1.0, 2.0]),
            covariance=np.eye(4),
            source_frequency=np.arange(100.0, 100.0 + n),
            source_frequency_deviation=np.arange(1.0, 1.0 + n),
            reborn=np.zeros(n, dtype=bool),
            manoeuvre=np.array(True),
            restarted=np.array(False),
        )


def recording(names_lines: bool = True) -> tuple[BaselineSolver, list[Recorder]]:
    """Return a solver and the recorders that it makes, one a side."""
    made: list[Recorder] = []

    def make(_: object) -> Recorder:
        made.append(Recorder())
        return made[-1]

    entry = SimpleNamespace(make=make, names_lines=names_lines)
    configuration: Any = SimpleNamespace(entry=entry, maximum_range=20e3, maximum_speed=20.0)
    return BaselineSolver(configuration), made


def test_one_azimuth_is_one_filter() -> None:
    solver, made = recording()
    (solution,) = solver.update(SEEN)
    (fed,) = made[0].fed
    assert (fed.stamp, fed.azimuth.tolist(), fed.azimuth_variance) == (SECOND, [0.5], 1e-4)
    assert (fed.position.tolist(), fed.velocity.tolist()) == ([1.0, 2.0], [3.0, 4.0])
    assert (fed.sound_speed, fed.propagation_speed) == (1480.0, 1490.0)
    assert (solution.side, solution.probability, solution.stamp) == (SINGLE, 1.0, SECOND)
    assert solution.mean.tolist() == [1000.0, 500.0, 1.0, 2.0]
    assert not solution.manoeuvre  # says a detector, which these methods have not
    assert not solution.observable and solution.observability == pytest.approx(0.0, abs=1e-6)


def test_two_azimuths_are_two_filters_that_nothing_weighs() -> None:
    solver, made = recording()
    left, right = solver.update(replace(SEEN, azimuths=(0.5, -0.5)))
    assert [(one.side, one.probability) for one in (left, right)] == [(LEFT, 0.5), (RIGHT, 0.5)]
    # Later the array has turned into a sensor with one side: both filters take its azimuth.
    assert len(solver.update(replace(SEEN, stamp=2 * SECOND, azimuths=(0.4,)))) == 2
    assert len(solver.update(replace(SEEN, stamp=3 * SECOND, azimuths=(0.3, -0.3)))) == 2
    fed = [[one.azimuth.tolist() for one in recorder.fed] for recorder in made]
    assert fed == [[[0.5], [0.4], [0.3]], [[-0.5], [0.4], [-0.3]]]


def test_without_an_azimuth_nothing_changes() -> None:
    solver, made = recording()
    assert solver.update(replace(SEEN, azimuths=())) == ()
    assert made == []
    assert len(solver.update(SEEN)) == 1
    assert solver.update(replace(SEEN, stamp=2 * SECOND, azimuths=())) == ()
    assert len(solver.update(replace(SEEN, stamp=2 * SECOND))) == 1
    assert len(made[0].fed) == 2


@pytest.mark.parametrize("stamp", [SECOND, SECOND - 1])
def test_one_station_in_order_of_time(stamp: int) -> None:
    solver, made = recording()
    solver.update(SEEN)
    with pytest.raises(InputError, match="bow is not later than the last one"):
        solver.update(replace(SEEN, stamp=stamp))
    with pytest.raises(InputError, match="line columns of unequal length"):
        solver.update(replace(SEEN, stamp=2 * SECOND, line_ids=(3,)))
    assert len(made[0].fed) == 1


def with_lines(stamp: int, *numbers: int) -> TargetObservation:
    return replace(
        SEEN,
        stamp=stamp,
        line_ids=numbers,
        frequencies=tuple(100.0 * number for number in numbers),
        frequency_deviations=tuple(0.1 * number for number in numbers),
    )


def test_a_line_keeps_its_column() -> None:
    solver, made = recording()
    solver.update(with_lines(1, 7, 5))
    solver.update(with_lines(2, 5))
    (solution,) = solver.update(with_lines(3, 9, 7))
    frequencies = np.array([one.frequency[:4] for one in made[0].fed])
    nan = np.nan
    expected = [[700.0, 500.0, nan, nan], [nan, 500.0, nan, nan], [700.0, nan, 900.0, nan]]
    np.testing.assert_array_equal(frequencies, expected)
    assert made[0].fed[2].frequency_deviation[[0, 2]].tolist() == pytest.approx([0.7, 0.9])
    assert made[0].fed[0].n_lines == 16
    assert solution.line_ids == (("bow", 7), ("bow", 5), ("bow", 9))
    assert solution.source_frequency.tolist() == [100.0, 101.0, 102.0]
    assert solution.source_frequency_deviation.tolist() == [1.0, 2.0, 3.0]


def test_sixteen_lines_are_followed() -> None:
    solver, made = recording()
    solver.update(with_lines(1, *range(1, 16)))
    (solution,) = solver.update(with_lines(2, 20, 21))
    assert np.flatnonzero(np.isfinite(made[0].fed[1].frequency)).tolist() == [15]
    assert made[0].fed[1].frequency[15] == 2000.0
    assert len(solution.line_ids) == len(solution.source_frequency) == 16
    assert solution.line_ids[15] == ("bow", 20)


def test_methods_that_fuse_lines_name_none() -> None:
    solver, _ = recording(names_lines=False)
    (solution,) = solver.update(with_lines(1, 7, 5))
    assert solution.line_ids == ()
    assert (len(solution.source_frequency), len(solution.source_frequency_deviation)) == (0, 0)
