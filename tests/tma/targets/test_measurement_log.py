"""Protects the log that observability is judged by: what is kept, and in which units."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.tma.estimators.sensor_frame import TmaMeasurement
from sonar_tracking.tma.targets import measurement_log
from sonar_tracking.tma.targets.measurement_log import MeasurementLog
from sonar_tracking.tma.targets.observability import (
    AZIMUTH,
    ELEVATION,
    HEIGHT,
    LINES,
    POSITION,
    TIME,
    VELOCITY,
    observability,
    root_of,
)

SECOND = 1_000_000_000


def measurement(number: int, **changes: object) -> TmaMeasurement:
    made = TmaMeasurement(
        stamp=(100 + number) * SECOND,
        position=np.array([10.0 * number, 5.0]),
        velocity=np.array([10.0, 1.0]),
        azimuth=np.array([0.4]),
        azimuth_variance=np.array(4e-4),
        frequency=np.array([300.0, np.nan]),
        frequency_deviation=np.array([0.5, 0.5]),
        elevation=np.array(0.1),
        elevation_variance=np.array(1e-4),
        height=-80.0,
        sound_speed=1480.0,
    )
    return replace(made, **changes)  # type: ignore[arg-type]


def test_a_measurement_is_logged_as_its_information() -> None:
    log = MeasurementLog(measurement(0), 20_000.0, 20.0)
    log.append(measurement(0))
    log.append(measurement(3, azimuth=np.array([np.nan]), elevation=np.array(np.nan), height=0.0))
    history = log.history()
    assert history.table[:, TIME].tolist() == [0.0, 3.0]
    assert history.table[:, POSITION].tolist() == [[0.0, 5.0], [30.0, 5.0]]
    assert history.table[:, VELOCITY].tolist() == [[10.0, 1.0]] * 2
    assert history.table[:, AZIMUTH] == pytest.approx([2500.0, 0.0])
    assert history.table[:, ELEVATION] == pytest.approx([1e4, 0.0])
    assert history.table[:, HEIGHT].tolist() == [-80.0, 0.0]
    assert history.table[:, LINES:].tolist() == [[4.0, 0.0], [4.0, 0.0]]
    assert history.sound_speed == 1480.0


def test_lines_that_come_later_have_columns_of_their_own() -> None:
    log = MeasurementLog(measurement(0), 20_000.0, 20.0)
    log.append(measurement(0))
    more = {"frequency": np.array([300.0, 200.0, 100.0]), "frequency_deviation": np.full(3, 0.1)}
    log.append(measurement(1, **more))
    log.append(measurement(2))
    expected = [[4.0, 0.0, 0.0], [100.0, 100.0, 100.0], [4.0, 0.0, 0.0]]
    assert log.history().table[:, LINES:] == pytest.approx(np.array(expected))
    log.forget_lines((0, 2))
    assert log.history().table[:, LINES:] == pytest.approx(
        np.array([[0.0, 0.0, 0.0], [0.0, 100.0, 0.0], [0.0, 0.0, 0.0]])
    )


@pytest.mark.parametrize("count", [64, 65, 100, 101, 150])
def test_the_first_and_the_newest_measurements_are_kept(
    count: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(measurement_log, "LOG_FRAMES", 100)
    log = MeasurementLog(measurement(0), 20_000.0, 20.0)
    for number in range(count):
        log.append(measurement(number))
    newest = range(max(1, count - 99), count)
    assert log.history().table[:, TIME] == pytest.approx([0.0, *map(float, newest)])
    assert log.history().table[:, POSITION.start].tolist() == [
        0.0,
        *(10.0 * number for number in newest),
    ]
    more = {"frequency": np.full(3, 200.0), "frequency_deviation": np.full(3, 0.1)}
    log.append(measurement(count, **more))
    assert log.history().table[-1, LINES:] == pytest.approx([100.0] * 3)
    assert log.history().table[0, LINES:] == pytest.approx([4.0, 0.0, 0.0])


def test_each_side_is_judged_from_its_own_prior() -> None:
    """The prior lies along the azimuth of its side, uniform in range, speed and across it."""
    first = measurement(0, azimuth=np.array([0.4, -1.0]))
    log = MeasurementLog(first, 8000.0, 12.0)
    for number in range(40):
        log.append(measurement(number))
    mean = np.array([2000.0, 1500.0, -3.0, 4.0, 300.0, 200.0])
    for side, azimuth in enumerate((0.4, -1.0)):
        sight = np.array([np.cos(azimuth), np.sin(azimuth)])
        across = np.array([-sight[1], sight[0]])
        prior = np.diag([0.0, 0.0, 48.0, 48.0])
        prior[:2, :2] = 8000.0**2 / 12.0 * np.outer(sight, sight)
        prior[:2, :2] += 4000.0**2 * 4e-4 * np.outer(across, across)
        expected = observability(mean[:4], mean[4:], log.history(), root_of(prior))
        assert 0.0 < expected < 1.0
        assert log.observability(mean, side) == pytest.approx(expected)
    single = MeasurementLog(measurement(0), 8000.0, 12.0)
    single.append(measurement(0))
    single.append(measurement(30))
    assert single.observability(mean, 1) == single.observability(mean, 0)
