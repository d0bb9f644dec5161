"""Protects what messages of lines and azimuths carry: nothing lost, nothing unequal, no mix-up."""

import numpy as np
import pytest

from sonar_tracking.errors import InputError
from sonar_tracking.graph.message_writing.array_writing import bearing_tracks_to_message
from sonar_tracking.graph.message_writing.line_writing import frequency_lines_to_message
from sonar_tracking.message_reading.array_reading import (
    bearing_tracks_from_message,
    directions_from_message,
)
from sonar_tracking.message_reading.line_reading import LINE_REALS, frequency_lines_from_message
from sonar_tracking.records.bearings import AngleKind, BearingTracks, Sensor
from sonar_tracking.records.lines import FrequencyLines

STAMP = 1_767_225_600 * 10**9
STATION = Sensor("buoy", "map", (1.0, 2.0, 0.0), (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0))


def lines(count: int = 2) -> FrequencyLines:
    return FrequencyLines(
        stamp=STAMP,
        track_id=np.arange(count, dtype=np.uint64),
        line_id=np.arange(count, dtype=np.uint64) + 7,
        next_stamp=STAMP + 10**9,
        sensor=STATION,
        **{name: np.arange(1.0, count + 1.0) + n for n, name in enumerate(LINE_REALS)},
    )


def azimuths() -> BearingTracks:
    one = np.array([0.5])
    return BearingTracks(
        stamp=STAMP,
        id=np.array([3], np.uint64),
        status=np.array([1], np.uint8),
        arrival_angle=one,
        arrival_angle_rate=one,
        covariance=np.eye(2)[None],
        measurement=one,
        measurement_variance=one,
        innovation=one,
        signal_to_noise_ratio=one,
        existence_probability=one,
        ambiguous=np.array([False]),
        sensor=STATION,
        angle_kind=AngleKind.AZIMUTH,
        elevation=np.array([-0.1]),
        elevation_variance=np.array([0.01]),
    )


def test_lines_come_back_as_they_went() -> None:
    sent = lines()
    back = frequency_lines_from_message(frequency_lines_to_message(sent))
    for name in (*LINE_REALS, "track_id", "line_id"):
        assert getattr(back, name).tolist() == getattr(sent, name).tolist()
    assert (back.stamp, back.next_stamp, back.sensor) == (sent.stamp, sent.next_stamp, STATION)


def test_columns_not_reported_are_unknown_and_unequal_ones_refused() -> None:
    message = frequency_lines_to_message(lines())
    message.arrival_angle = []
    message.track_id = []
    back = frequency_lines_from_message(message)
    assert np.isnan(back.arrival_angle).all() and back.track_id.tolist() == [0, 0]
    message.frequency = [1.0]
    with pytest.raises(InputError, match="frequency has 1"):
        frequency_lines_from_message(message)


def test_azimuths_are_read_where_they_are_asked_for_only() -> None:
    message = bearing_tracks_to_message(azimuths())
    back = directions_from_message(message)
    assert back.angle_kind is AngleKind.AZIMUTH
    assert (back.elevation[0], back.elevation_variance[0]) == (-0.1, 0.01)
    with pytest.raises(InputError, match="angle_kind is 1"):
        bearing_tracks_from_message(message)
    message.angle_kind = 2
    with pytest.raises(InputError, match="angle_kind is 2"):
        directions_from_message(message)
