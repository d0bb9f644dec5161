"""What goes to the page must be what the arrays gave, and only what somebody has selected."""

from __future__ import annotations

import json
import struct
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sonar_tracking.display.page.own_ship_log import OwnShipLog
from sonar_tracking.display.page.page_configuration import PageConfiguration
from sonar_tracking.display.page.page_frames import Frame
from sonar_tracking.display.page.track_frames import StationPlaces
from sonar_tracking.display.page.waterfall_frames import MOST_DOTS, WaterfallFrames
from sonar_tracking.errors import InputError
from sonar_tracking.geometry import line_array, steering_vectors, wavenumber
from sonar_tracking.records.bearings import ArraySnapshots, BearingTracks, Sensor
from sonar_tracking.records.lines import FrequencyLines
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.positions import PositionTracks, TrackSource
from sonar_tracking.records.samples import ArraySamples
from sonar_tracking.records.time import NANOSECONDS
from tests.display.test_bearing_time_record import tracks as bearing_tracks

BEGIN = 1_767_225_600 * NANOSECONDS
POSITIONS = line_array(8, 0.5)
SENSOR = Sensor(
    position=(0.0, 0.0, 0.0), orientation=(0.0, 0.0, 0.6, 0.8), velocity=(4.0, 0.0, 0.0)
)
AXIS = 2.0 * np.arcsin(0.6)
HEARD = "/passive/bearing_tracks"


def waterfalls() -> WaterfallFrames:
    log = OwnShipLog()
    log.add(OwnShipState(BEGIN, (0.0, 0.0), 0.7, (4.0, 0.0), 0.0))
    return WaterfallFrames(log, StationPlaces(PageConfiguration(), log), 600.0)


def decoded(frame: Frame) -> tuple[dict[str, Any], np.ndarray]:
    assert isinstance(frame.data, bytes)
    (length,) = struct.unpack_from("<I", frame.data)
    assert (4 + length) % 4 == 0
    header = json.loads(frame.data[4 : 4 + length])
    return header, np.frombuffer(frame.data, "<f4", offset=4 + length)


def snapshots(second: float) -> ArraySnapshots:
    vector = steering_vectors(POSITIONS, [0.4], wavenumber(1000.0, 1500.0))
    return ArraySnapshots(
        stamp=BEGIN + round(second * NANOSECONDS),
        data=np.tile(np.sqrt(10.0) * vector.T, (5, 1)),
        element_positions=POSITIONS,
        sample_period=0.1,
        center_frequency=1000.0,
        bandwidth=10.0,
        sound_speed=1500.0,
        sensor=SENSOR,
    )


def samples(second: int) -> ArraySamples:
    noise = np.random.default_rng(second).normal(size=(2000, 8))
    stamp = BEGIN + second * NANOSECONDS
    return ArraySamples(stamp, noise, POSITIONS, 2000.0, 1500.0, sensor=SENSOR)


def heard(second: int) -> BearingTracks:
    angles = np.array([0.2, -0.4])
    return replace(
        bearing_tracks(0),
        stamp=BEGIN + second * NANOSECONDS,
        arrival_angle=angles,
        measurement=angles,
        measurement_variance=np.full(2, 1e-4),
        sensor=SENSOR,
    )


def frequency_lines(second: int) -> FrequencyLines:
    """Return a line that a source at rest of 301 Hz has on the sensor, which nears it at 4 m/s."""
    offset = np.array([3000.0, 2000.0])
    factor = 1.0 + 4.0 * offset[0] / np.hypot(*offset) / 1500.0
    return FrequencyLines(
        stamp=BEGIN + second * NANOSECONDS,
        track_id=np.array([4, 9], np.uint64),
        arrival_angle=np.zeros(2),
        arrival_angle_variance=np.ones(2),
        line_id=np.array([1, 2], np.uint64),
        frequency=np.array([301.0 * factor, 500.0]),
        standard_deviation=np.full(2, 0.05),
        signal_to_noise_ratio=np.ones(2),
        integration_time=np.ones(2),
        sensor=SENSOR,
    )


def take_bearings(frames: WaterfallFrames, second: int, topic: str = HEARD) -> None:
    tracks = heard(second)
    frames.bearings(topic, tracks, frames._places.view(tracks.sensor, tracks.stamp))


def solution(second: int) -> PositionTracks:
    return PositionTracks(
        stamp=BEGIN + second * NANOSECONDS,
        id=np.array([7], np.uint64),
        status=np.array([1], np.uint8),
        source=np.array([TrackSource.FUSED], np.uint8),
        state=np.array([[3000.0, 2000.0, 0.0, 0.0]]),
        contributor_track=np.array([0], np.uint32),
        contributor_source=np.array([TrackSource.TMA], np.uint8),
        contributor_id=np.array([4], np.uint64),
        contributor_sensor=("array",),
    )


def test_rows_say_when_where_and_how_loud() -> None:
    frames = waterfalls()
    made = [frame for k in range(10) for frame in frames.snapshots("/a/s", snapshots(0.5 * k))]
    complete = [decoded(frame) for frame in made if frame.kind == "waterfall"]
    assert [header["scale"] for header, _ in complete] == [1.0, 1.0, 1.0, 1.0, 1.0, 5.0]
    header, row = complete[-1]
    assert (header["t0"], header["t1"]) == (BEGIN / NANOSECONDS, BEGIN / NANOSECONDS + 5.0)
    assert header["axis_azimuth"] == pytest.approx(AXIS)
    assert header["heading"] == pytest.approx(0.7)
    axis = header["angles"]
    assert (axis["of"], axis["count"]) == ("sine", len(row))
    sine = axis["first"] + axis["step"] * int(np.argmax(row))
    assert sine == pytest.approx(np.sin(0.4), abs=axis["step"])
    assert row.max() == pytest.approx(10.0, abs=0.1)
    opened = [decoded(frame)[0] for frame in made if frame.kind == "waterfall_open"]
    assert {header["scale"] for header in opened} == {5.0, 20.0}


def test_spectra_go_to_who_selects_them_with_their_past() -> None:
    frames = waterfalls()
    take_bearings(frames, 0)
    assert {frame.kind for frame in frames.samples("/a/x", samples(0))} <= {"waterfall"}
    list(frames.samples("/a/x", samples(1)))
    past = list(frames.select({"view": "lofar", "sensor": "array", "track": 4}))
    header, row = decoded(past[0])
    assert (header["track"], header["frequency"]["count"]) == (4, len(row))
    assert header["angle"] == pytest.approx(0.2)
    live = [frame for frame in frames.samples("/a/x", samples(2)) if frame.kind == "lofar"]
    assert [decoded(frame)[0]["track"] for frame in live] == [4]
    list(frames.select({"view": "lofar", "sensor": "array", "beam": 0.33333}))
    live = [frame for frame in frames.samples("/a/x", samples(3)) if frame.kind == "lofar"]
    assert [decoded(frame)[0].get("beam") for frame in live] == [None, 0.3333]


def test_truth_is_not_heard_and_the_first_list_of_a_sensor_counts() -> None:
    frames = waterfalls()
    take_bearings(frames, 0, "/truth/bearing_tracks")
    take_bearings(frames, 1)
    take_bearings(frames, 2, "/other/bearing_tracks")
    found = frames._log.bearings("array", 4)
    assert found is not None and list(found.stamps) == [BEGIN + NANOSECONDS]


def test_dots_are_sent_for_the_selected_track_and_now_and_then() -> None:
    frames = waterfalls()
    for second in range(2 * MOST_DOTS):
        take_bearings(frames, second)
    assert list(frames.tracks("/tracks", solution(600))) == []
    (frame,) = frames.select({"view": "dots", "topic": "/tracks", "track": 7})
    assert isinstance(frame.data, str)
    dots = json.loads(frame.data)
    (stack,) = dots["stacks"]
    assert stack["label"] == "array 4" and stack["frequency"] is None
    assert len(stack["times"]) <= MOST_DOTS
    assert stack["times"][-1] == BEGIN / NANOSECONDS + 2 * MOST_DOTS - 1
    predicted = np.arcsin(np.cos(np.arctan2(2000.0, 3000.0) - AXIS))
    np.testing.assert_allclose(stack["residual"], 0.2 - predicted, atol=1e-4)
    assert list(frames.tracks("/tracks", solution(602))) == []
    assert len(list(frames.tracks("/tracks", solution(605)))) == 1
    assert list(frames.select({"view": "dots", "topic": "/tracks", "track": 99})) == []


def test_who_looks_back_sees_the_dots_of_the_solution_of_then() -> None:
    frames = waterfalls()
    for second in range(100):
        take_bearings(frames, second)
        list(frames.tracks("/tracks", solution(second)))
    asked = {"view": "dots", "topic": "/tracks", "track": 7, "t": BEGIN / NANOSECONDS + 42.0}
    (frame,) = frames.select(asked)
    assert frame.time == BEGIN / NANOSECONDS + 40.0
    (stack,) = json.loads(frame.data)["stacks"]
    assert stack["times"][-1] == frame.time
    assert len(stack["times"]) == 41
    assert list(frames.select({**asked, "t": BEGIN / NANOSECONDS - 1.0})) == []
    assert list(frames.select({**asked, "topic": "/other"})) == []
    assert list(frames.tracks("/tracks", solution(100))) == []  # looking back selects nothing


def test_lines_of_what_a_fused_track_was_heard_by_have_dots_too() -> None:
    frames = waterfalls()
    for second in range(20):
        take_bearings(frames, second)
        frames.lines(frequency_lines(second))
    list(frames.tracks("/tracks", solution(20)))
    (frame,) = frames.select({"view": "dots", "topic": "/tracks", "track": 7})
    assert isinstance(frame.data, str)
    bearings, line = json.loads(frame.data)["stacks"]
    assert bearings["frequency"] is None
    assert line["label"] == "array 301.0 Hz" and len(line["times"]) == 20
    np.testing.assert_allclose(line["residual"], 0.0, atol=1e-3)


@pytest.mark.parametrize(
    "said",
    [
        {},
        {"view": "lofar"},
        {"view": "lofar", "sensor": "array", "track": "x"},
        {"view": "lofar", "sensor": "array", "beam": float("nan")},
        {"view": "lofar", "sensor": "array", "beam": [1]},
        {"view": "dots", "topic": "/tracks", "track": None},
        {"view": "dots", "topic": "/tracks", "track": 7, "t": "now"},
        {"view": "dots", "topic": "/tracks", "track": 7, "t": float("nan")},
        {"view": "dots", "topic": "/tracks", "track": 1e300 * 1e300},
    ],
)
def test_a_selection_that_makes_no_sense_is_said(said: dict[str, Any]) -> None:
    with pytest.raises(InputError, match="select needs view"):
        list(waterfalls().select(said))


def test_legs_come_with_own_ship() -> None:
    frames = waterfalls()
    made = [
        frame
        for second in range(30)
        for frame in frames.own_ship(
            OwnShipState(BEGIN + second * NANOSECONDS, (0.0, 0.0), 0.5 * np.pi, (4.0, 0.0), 0.0)
        )
    ]
    assert isinstance(made[-1].data, str)
    (leg,) = json.loads(made[-1].data)["legs"]
    assert not leg["turning"] and leg["course_deg"] == pytest.approx(0.0, abs=1e-6)
