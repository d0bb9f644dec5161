"""Energy must be the same on all time scales, and each row must say what it stands for."""

from __future__ import annotations

import itertools
import math
import warnings
from collections.abc import Iterable

import numpy as np
import pytest

from sonar_tracking.display.waterfalls.beam_rows import BeamAxis, BeamRow
from sonar_tracking.display.waterfalls.waterfall_cascade import ScaledRow, WaterfallCascade
from sonar_tracking.records.time import NANOSECONDS, nanoseconds

AXIS = BeamAxis(-1.0, 0.5, 5, sine=True)
BEGIN = 1_767_225_600 * NANOSECONDS


def part(begin: float, duration: float, power: float, azimuth: float = 0.0) -> BeamRow:
    stamp = BEGIN + nanoseconds(begin)
    end = stamp + nanoseconds(duration)
    return BeamRow(stamp, end, AXIS, np.full(5, power), duration, axis_azimuth=azimuth)


def cascaded(parts: Iterable[BeamRow]) -> dict[float, list[BeamRow]]:
    cascade = WaterfallCascade()
    rows: list[ScaledRow] = []
    for each in parts:
        rows += cascade.add(each)
    rows += cascade.flush()
    return {scale: [r.row for r in rows if r.scale == scale] for scale in cascade.scales}


def energy(rows: Iterable[BeamRow]) -> float:
    return sum(float(row.power[0]) * row.integrated for row in rows)


def test_power_is_the_mean_of_power_and_not_of_decibels() -> None:
    rows = cascaded(part(0.5 * k, 0.5, 100.0 if k == 3 else 0.0) for k in range(10))
    # One second of two parts, one of them 100; five seconds of ten.
    assert [float(row.power[0]) for row in rows[1.0]] == [0.0, 50.0, 0.0, 0.0, 0.0]
    assert [float(row.power[0]) for row in rows[5.0]] == [10.0]
    assert rows[1.0][1].level_db[0] == pytest.approx(16.9897, abs=1e-4)
    assert rows[5.0][0].level_db[0] == pytest.approx(10.0, abs=1e-4)


def test_parts_weigh_by_their_duration() -> None:
    rows = cascaded([part(0.0, 0.25, 8.0), part(0.25, 0.75, 4.0)])
    assert float(rows[1.0][0].power[0]) == pytest.approx(0.25 * 8.0 + 0.75 * 4.0)


def test_energy_is_the_same_on_all_scales_with_parts_that_fit_none() -> None:
    generator = np.random.default_rng(1)
    parts = [part(0.312 * k, 0.312, power) for k, power in enumerate(generator.exponential(1, 320))]
    rows = cascaded(parts)
    for scale in (1.0, 5.0, 20.0):
        assert energy(rows[scale]) == pytest.approx(energy(parts))
        spans = [(row.begin, row.end) for row in rows[scale]]
        assert all(a[1] == b[0] for a, b in itertools.pairwise(spans))
    starts = {row.begin for row in rows[1.0]}
    assert {row.begin for row in rows[5.0]} <= starts
    assert len(rows[20.0]) == 5


def test_a_gap_stays_a_gap_on_all_scales() -> None:
    rows = cascaded([part(k, 1.0, 1.0) for k in (0, 1, 2, 7, 8, 9, 10)])
    for scale in (1.0, 5.0, 20.0):
        assert not [r for r in rows[scale] if r.begin < BEGIN + 3 * NANOSECONDS < r.end]
    assert [row.integrated for row in rows[20.0]] == [3.0, 4.0]
    assert [float(row.power[0]) for row in rows[20.0]] == [1.0, 1.0]


def test_a_change_of_rate_keeps_the_time_of_each_row() -> None:
    slow = [part(4.0 * k, 4.0, 1.0) for k in range(3)]
    rows = cascaded([*slow, *[part(12.0 + k, 1.0, 1.0) for k in range(8)]])
    assert [row.integrated for row in rows[1.0]] == [4.0] * 3 + [1.0] * 8
    assert energy(rows[20.0]) == pytest.approx(20.0)


def test_a_turn_ends_rows_so_that_each_has_one_direction() -> None:
    rate = math.radians(0.5)
    rows = cascaded(part(k, 1.0, 1.0, rate * k) for k in range(20))
    assert len(rows[1.0]) == 20
    assert all(row.integrated <= 5.0 for row in rows[20.0])
    # The direction of a row is that of its middle.
    for row in rows[20.0]:
        first = (row.begin - BEGIN) / NANOSECONDS
        expected = rate * (first + 0.5 * (row.integrated - 1.0))
        assert row.axis_azimuth == pytest.approx(expected, abs=1e-6)


def test_directions_have_their_mean_across_the_half_circle() -> None:
    rows = cascaded([part(0.0, 0.5, 1.0, math.pi - 0.01), part(0.5, 0.5, 1.0, -math.pi + 0.01)])
    assert abs(rows[1.0][0].axis_azimuth) == pytest.approx(math.pi)


def test_an_unknown_direction_is_unknown_and_splits_nothing() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rows = cascaded(part(0.5 * k, 0.5, 1.0, math.nan) for k in range(4))
    assert len(rows[1.0]) == 2 and math.isnan(rows[1.0][0].axis_azimuth)


def test_time_going_back_begins_anew() -> None:
    cascade = WaterfallCascade()
    assert cascade.add(part(100.0, 0.5, 1.0)) == []
    completed = cascade.add(part(0.0, 0.5, 2.0))
    assert [each.scale for each in completed] == [1.0, 5.0, 20.0]
    assert all(float(each.row.power[0]) == 1.0 for each in completed)


def test_what_has_come_of_a_long_row_is_its_mean_so_far() -> None:
    cascade = WaterfallCascade()
    for k in range(7):
        cascade.add(part(k, 1.0, float(k)))
    cascade.add(part(7.0, 0.5, 100.0))
    pending = {each.scale: each for each in cascade.pending()}
    assert not pending[5.0].complete
    assert float(pending[5.0].row.power[0]) == pytest.approx((5.0 + 6.0 + 50.0) / 2.5)
    assert float(pending[20.0].row.power[0]) == pytest.approx((21.0 + 50.0) / 7.5)
    assert pending[20.0].row.begin == BEGIN
