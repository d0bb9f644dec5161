"""What was heard is kept by target, in bounded memory."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.display.page import hearing_log
from sonar_tracking.display.page.hearing_log import HearingLog
from sonar_tracking.display.page.own_ship_log import OwnShipLog
from sonar_tracking.display.page.page_configuration import PageConfiguration
from sonar_tracking.display.page.track_frames import StationPlaces
from sonar_tracking.records.lines import FrequencyLines
from sonar_tracking.tma.targets.station_view import StationView
from tests.display.page.page_scene import bearings, lines, own_ship


def station() -> StationView:
    log = OwnShipLog()
    log.add(own_ship(0))
    heard = bearings(0)
    view = StationPlaces(PageConfiguration(), log).view(heard.sensor, heard.stamp)
    assert view is not None
    return view


def several(second: int, numbers: list[int]) -> FrequencyLines:
    """Return lines of one bearing track."""
    one, all_of_them = lines(second), np.ones(len(numbers))
    return FrequencyLines(
        stamp=one.stamp,
        track_id=np.ones(len(numbers), np.uint64),
        arrival_angle=0.5 * all_of_them,
        arrival_angle_variance=1e-4 * all_of_them,
        line_id=np.array(numbers, np.uint64),
        frequency=120.25 * all_of_them,
        standard_deviation=0.1 * all_of_them,
        signal_to_noise_ratio=10.0 * all_of_them,
        integration_time=4.0 * all_of_them,
    )


def test_each_target_has_what_was_measured_of_it() -> None:
    log, view = HearingLog(), station()
    for second in range(5):
        heard = bearings(second)
        known = replace(heard, arrival_angle=np.where(second == 3, [np.nan, 0.1], [0.5, 0.1]))
        log.add_bearings(known, view)
    log.add_bearings(bearings(2), view)  # late: it is there already
    first, second_track = (log.bearings(view.sensor_id, number) for number in (1, 2))
    assert first is not None and second_track is not None
    assert len(first.stamps) == 4 and len(second_track.stamps) == 5
    assert np.all(first.value == 0.5)
    assert log.bearings(view.sensor_id, 3) is None
    assert log.sensors_of(2) == [view.sensor_id]


def test_lines_heard_most_often_come_first() -> None:
    log, view = HearingLog(), station()
    for second in range(9):
        log.add_lines(several(second, [7] if second % 3 else [7, 8, 8]), view)
    assert log.lines_of(view.sensor_id, 1) == [7, 8]
    heard = log.line(view.sensor_id, 1, 8)
    assert heard is not None and len(heard.stamps) == 3  # one a list


def test_memory_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(hearing_log, "KEPT", 10)
    monkeypatch.setattr(hearing_log, "MOST_ROWS", 30)
    log, view = HearingLog(), station()
    for second in range(200):
        log.add_lines(several(second, [4, 100 + second]), view)
    kept = log.line(view.sensor_id, 1, 4)
    assert kept is not None and 10 <= len(kept.stamps) <= 20
    assert log.line(view.sensor_id, 1, 100) is None
    assert log.line(view.sensor_id, 1, 299) is not None
    assert len(log.lines_of(view.sensor_id, 1)) == hearing_log.MOST_LINES
    assert len(log._heard) <= 30 and sum(map(len, log._lines.values())) <= 30
