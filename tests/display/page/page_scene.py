"""A small scene for the live page: records as the graph makes them, one second after the other."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from sonar_tracking.display.page.contact_frames import ContactFrames, threshold_frame
from sonar_tracking.display.page.own_ship_log import OwnShipLog
from sonar_tracking.display.page.page_configuration import PageConfiguration
from sonar_tracking.display.page.page_frames import Frame
from sonar_tracking.display.page.page_server import PageServer
from sonar_tracking.display.page.track_frames import (
    StationPlaces,
    bearings_frame,
    lines_frame,
    own_ship_frame,
    tracks_frame,
)
from sonar_tracking.records.bearings import AngleKind, BearingTracks, Sensor, TrackStatus
from sonar_tracking.records.contacts import Contacts, GateThresholds
from sonar_tracking.records.lines import FrequencyLines
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.positions import PositionTracks, TrackSource
from sonar_tracking.records.time import NANOSECONDS

START = 1_767_225_600
"""Data time at which scenes begin, s."""

TOPIC = "/tracks"


def own_ship(second: float) -> OwnShipState:
    """Return own ship going north with 4 m/s."""
    stamp = round((START + second) * NANOSECONDS)
    return OwnShipState(stamp, (0.0, 4.0 * second), math.pi / 2, (4.0, 0.0), 0.0)


def tracks(second: float, count: int = 3) -> PositionTracks:
    """Return tracks in a row 2 km east of own ship's start, going west with 5 m/s."""
    numbers = np.arange(count)
    state = np.zeros((count, 4))
    state[:, 0] = 2000.0 - 5.0 * second
    state[:, 1] = 100.0 * numbers
    state[:, 2] = -5.0
    return PositionTracks(
        stamp=round((START + second) * NANOSECONDS),
        id=(numbers + 1).astype(np.uint64),
        status=np.full(count, TrackStatus.CONFIRMED, np.uint8),
        source=np.full(count, TrackSource.FUSED, np.uint8),
        state=state,
        covariance=np.broadcast_to(np.diag([400.0, 900.0, 0.25, 1.0]), (count, 4, 4)),
        existence_probability=np.full(count, 0.987654),
        initiated=np.full(count, float(START)),
        updated=np.full(count, START + second),
        contributor_track=np.zeros(1, np.uint32) if count else np.empty(0, np.uint32),
        contributor_source=np.ones(min(count, 1), np.uint8),
        contributor_sensor=("array",) * min(count, 1),
        contributor_id=np.full(min(count, 1), 7, np.uint64),
    )


def bearings(second: float) -> BearingTracks:
    """Return two bearing tracks of a line array on own ship that tells nothing of its pose."""
    return BearingTracks(
        stamp=round((START + second) * NANOSECONDS),
        id=np.array([1, 2], np.uint64),
        status=np.ones(2, np.uint8),
        arrival_angle=np.array([0.5, -0.25 - 0.001 * second]),
        arrival_angle_rate=np.zeros(2),
        covariance=np.broadcast_to(np.diag([1e-4, 1e-6]), (2, 2, 2)),
        measurement=np.full(2, np.nan),
        measurement_variance=np.full(2, np.nan),
        innovation=np.full(2, np.nan),
        signal_to_noise_ratio=np.ones(2),
        existence_probability=np.ones(2),
        ambiguous=np.ones(2, bool),
        angle_kind=AngleKind.CONE,
        sensor=Sensor(),
    )


def lines(second: float) -> FrequencyLines:
    """Return one line of the first bearing track."""
    one = np.ones(1)
    return FrequencyLines(
        stamp=round((START + second) * NANOSECONDS),
        track_id=np.array([1], np.uint64),
        arrival_angle=0.5 * one,
        arrival_angle_variance=1e-4 * one,
        line_id=np.array([4], np.uint64),
        frequency=120.25 * one,
        standard_deviation=0.1 * one,
        signal_to_noise_ratio=10.0 * one,
        integration_time=4.0 * one,
    )


def contacts(second: float) -> Contacts:
    """Return a ping with three contacts."""
    return Contacts(
        stamp=round((START + second) * NANOSECONDS),
        range=np.array([1000.0, 2000.0, 3000.0]),
        azimuth=np.array([0.0, 1.0, 2.0]),
        amplitude=np.array([10.0, 20.0, 40.0]),
        range_standard_deviation=30.0,
        azimuth_standard_deviation=0.01,
        sensor_position=(0.0, 4.0 * second),
        sensor_velocity=(0.0, 4.0),
        detection_threshold=5.8,
        maximum_range=6000.0,
        ping_interval=10.0,
    )


def thresholds(second: float) -> GateThresholds:
    """Return the gate of one track."""
    one = np.ones(1)
    return GateThresholds(
        stamp=round((START + second) * NANOSECONDS),
        track_id=np.array([1]),
        false_alarm_probability=0.003 * one,
        threshold=4.0 * one,
        resolution_cells=9.0 * one,
        gate_volume=1e4 * one,
        predicted_position=np.array([[1900.0, 0.0]]),
        gate_covariance=np.array([[[2500.0, 0.0], [0.0, 1600.0]]]),
        search_false_alarm_probability=0.003,
        search_threshold=5.8,
        signal_to_noise_ratio_linear=20.0 * one,
        method="adaptive",
    )


def frames(first: int, last: int, count: int = 3) -> Iterator[Frame]:
    """Yield the frames of some seconds of the scene, the last one excluded."""
    log = OwnShipLog()
    configuration = PageConfiguration()
    places, pings = StationPlaces(configuration, log), ContactFrames(configuration, log)
    for second in range(first, last):
        state = own_ship(second)
        log.add(state)
        yield own_ship_frame(state)
        yield tracks_frame(TOPIC, tracks(second, count))
        heard = bearings(second)
        view = places.view(heard.sensor, heard.stamp)
        yield bearings_frame("/passive/bearing_tracks", heard, view)
        yield lines_frame("/passive/frequency_lines", lines(second))
        if second % 10 == 0:
            yield pings.frame("/active/contacts", contacts(second))
            yield threshold_frame("/active/threshold", thresholds(second))


def show(server: PageServer, first: int, last: int, count: int = 3) -> None:
    """Let a server show some seconds of the scene."""
    for frame in frames(first, last, count):
        server.do(server.feed.emit, frame)
