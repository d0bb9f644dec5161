"""A right solution must stack its dots on zero, and a wrong one must not."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from sonar_tracking.display.page.own_ship_legs import own_ship_legs
from sonar_tracking.display.page.stacked_dots import (
    SOUND_SPEED,
    Hearing,
    bearing_dots,
    frequency_dots,
)
from sonar_tracking.motion import Trajectory, Turn, emission_times
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.time import NANOSECONDS

BEGIN = 1_767_225_600 * NANOSECONDS
TIMES = np.arange(0.0, 600.0, 4.0)
OWN = Trajectory((0.0, 0.0), np.pi / 2.0, 4.0, [Turn(200.0, 0.3, 0.01)])
TARGET = Trajectory((3000.0, 4000.0), -0.4, 6.0)
LINE = 300.0


def heard(cone: bool, frequency: bool = False) -> Hearing:
    """Return what own ship hears of the target, without noise."""
    own = OWN.state(TIMES)
    emitted = TARGET.state(emission_times(TARGET, own.position, TIMES, SOUND_SPEED))
    offset = emitted.position - own.position
    azimuth = np.arctan2(offset[:, 1], offset[:, 0])
    value = np.arcsin(np.cos(azimuth - own.azimuth)) if cone else azimuth - own.azimuth
    if frequency:
        unit = offset / np.hypot(*offset.T)[:, None]
        value = LINE * (SOUND_SPEED + np.sum(unit * own.velocity, axis=1))
        value /= SOUND_SPEED + np.sum(unit * emitted.velocity, axis=1)
    return Hearing(
        stamps=BEGIN + np.rint(TIMES * NANOSECONDS).astype(np.int64),
        position=own.position,
        velocity=own.velocity,
        axis_azimuth=own.azimuth,
        value=value,
        deviation=np.full(len(TIMES), 0.01),
        cone=cone,
    )


def solution(stretch: float = 1.0) -> tuple[FloatArray, int]:
    """Return the target's state at the end; stretched: farther away, on the bearings of one leg."""
    now = TARGET.state(TIMES[-1])
    own = OWN.state(TIMES[-1])
    position = own.position + stretch * (now.position - own.position)
    velocity = own.velocity + stretch * (now.velocity - own.velocity)
    return np.concatenate([position, velocity]), BEGIN + round(TIMES[-1]) * NANOSECONDS


@pytest.mark.parametrize("cone", [True, False])
def test_the_true_solution_stacks_on_zero(cone: bool) -> None:
    dots = bearing_dots(*solution(), heard(cone), "array")
    np.testing.assert_allclose(dots.residual, 0.0, atol=1e-6)
    lines = frequency_dots(*solution(), LINE, heard(cone, frequency=True), "line 1")
    np.testing.assert_allclose(lines.residual, 0.0, atol=1e-6)
    assert lines.frequency == LINE and np.isnan(dots.frequency)


def test_a_wrong_range_shows_before_the_turn_of_own_ship_and_not_after_it() -> None:
    dots = bearing_dots(*solution(stretch=1.5), heard(cone=False), "array")
    leg = TIMES > 360.0
    assert np.abs(dots.residual[leg]).max() < np.radians(0.3)
    assert np.abs(dots.residual[TIMES < 200.0]).max() > np.radians(3.0)


def test_residuals_of_azimuths_do_not_jump_by_a_turn() -> None:
    turned = heard(cone=False)
    values = turned.value + 2.0 * np.pi
    dots = bearing_dots(*solution(), Hearing(**{**vars(turned), "value": values}), "array")
    np.testing.assert_allclose(dots.residual, 0.0, atol=1e-6)


def test_another_line_is_left_out() -> None:
    other = heard(cone=True, frequency=True)
    values = np.where(TIMES < 100.0, 2.0 * LINE, other.value)
    dots = frequency_dots(*solution(), LINE, Hearing(**{**vars(other), "value": values}), "line 1")
    assert len(dots.stamps) == np.count_nonzero(TIMES >= 100.0)


def test_legs_and_turns_follow_on_one_another() -> None:
    own = OWN.state(TIMES)
    states = [
        OwnShipState(BEGIN + round(t) * NANOSECONDS, (0.0, 0.0), float(yaw), (4.0, 0.0), 0.0)
        for t, yaw in zip(TIMES, own.azimuth, strict=True)
    ]
    legs = own_ship_legs(states)
    assert [leg.turning for leg in legs] == [False, True, False]
    assert [leg.course_deg for leg in legs] == pytest.approx([0.0, 72.8, 72.8], abs=0.1)
    assert (legs[1].begin - BEGIN) / NANOSECONDS == pytest.approx(200.0, abs=5.0)
    assert (legs[1].end - BEGIN) / NANOSECONDS == pytest.approx(327.0, abs=5.0)
    assert all(a.end == b.begin for a, b in itertools.pairwise(legs))
    assert own_ship_legs(states[:1]) == []


def test_a_line_of_unknown_frequency_is_placed_where_most_dots_fit() -> None:
    lines = frequency_dots(*solution(), np.nan, heard(cone=True, frequency=True), "line 1")
    np.testing.assert_allclose(lines.residual, 0.0, atol=1e-6)
    assert lines.frequency == pytest.approx(LINE)
    wrong = frequency_dots(*solution(1.5), np.nan, heard(cone=True, frequency=True), "line 1")
    assert np.ptp(wrong.residual) > 0.1
