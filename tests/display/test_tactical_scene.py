"""The chart shows things where they are: both sides of a bearing, contacts, own ship between."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.active.contacts.sensor_location import MountingConfiguration
from sonar_tracking.display.located_pings import located_pings, recorded_mounting
from sonar_tracking.display.position_history import open_histories, position_histories
from sonar_tracking.display.tactical_plot import draw_tactical_plot
from sonar_tracking.display.tactical_scene import (
    TacticalScene,
    bearing_lines,
    contact_points,
    own_ship_track,
    stations_at_rest,
)
from sonar_tracking.records.bearings import AngleKind, BearingTracks, Sensor, TrackStatus
from sonar_tracking.records.contacts import Contacts
from sonar_tracking.records.own_ship import OwnShipState
from tests.display.position_pictures import EPOCH, SECOND, position_tracks

START = EPOCH * SECOND


def bearings(kind: AngleKind, yaw_deg: float = 90.0) -> BearingTracks:
    """Return 30 degrees, confirmed, and a tentative track, from a sensor at (100, 200)."""
    half = math.radians(0.5 * yaw_deg)
    nan = np.full(2, np.nan)
    return BearingTracks(
        stamp=START + 3 * SECOND,
        id=np.array([1, 2], np.uint64),
        status=np.array([TrackStatus.CONFIRMED, TrackStatus.TENTATIVE], np.uint8),
        arrival_angle=np.radians([30.0, 50.0]),
        arrival_angle_rate=nan,
        covariance=np.full((2, 2, 2), np.nan),
        measurement=nan,
        measurement_variance=nan,
        innovation=nan,
        signal_to_noise_ratio=nan,
        existence_probability=nan,
        ambiguous=np.ones(2, np.bool_),
        sensor=Sensor(
            position=(100.0, 200.0, 0.0), orientation=(0.0, 0.0, math.sin(half), math.cos(half))
        ),
        angle_kind=kind,
    )


def test_both_sides_of_a_line_array_are_drawn() -> None:
    """An array that points north and 30 degrees from broadside towards its end: 30 and 150."""
    lines = bearing_lines([bearings(AngleKind.CONE)], START)
    np.testing.assert_allclose(lines[:, :3], [[3.0, 100.0, 200.0]] * 2)
    np.testing.assert_allclose(np.degrees(lines[:, 3]), [150.0, 30.0])


def test_an_azimuth_is_drawn_as_it_is_and_a_bearing_from_nowhere_not_at_all() -> None:
    lines = bearing_lines([bearings(AngleKind.AZIMUTH)], START)
    np.testing.assert_allclose(np.degrees(lines[:, 3]), [30.0])
    assert bearing_lines([bearings(AngleKind.CONE, math.nan)], START).shape == (0, 4)


def test_a_station_is_a_sensor_that_does_not_move() -> None:
    still = bearings(AngleKind.CONE)
    moving = dataclasses.replace(still, sensor=Sensor(sensor_id="towed", position=(0.0, 0.0, 0.0)))
    moved = dataclasses.replace(still, sensor=Sensor(sensor_id="towed", position=(9.0, 0.0, 0.0)))
    unknown = dataclasses.replace(still, sensor=Sensor(sensor_id="lost"))
    found = stations_at_rest([still, moving, still, moved, unknown])
    assert found == {"array": (100.0, 200.0)}


def ping(time: float, **columns: object) -> Contacts:
    values: dict[str, object] = {
        "range": np.array([1000.0]),
        "azimuth": np.array([0.5 * math.pi]),
        "sensor_position": (math.nan, math.nan),
        "sensor_velocity": (math.nan, math.nan),
    }
    return Contacts(
        stamp=START + round(time * SECOND),
        amplitude=np.empty(0),
        range_standard_deviation=1.0,
        azimuth_standard_deviation=0.01,
        **(values | columns),  # type: ignore[arg-type]
    )


def test_pings_are_placed_by_own_ship_where_they_do_not_tell() -> None:
    """Own ship sails east at 10 m/s and the sensor is 50 m ahead of its reference."""
    own_ship = [
        OwnShipState(START + time * SECOND, (10.0 * time, 0.0), 0.0, (10.0, 0.0), 0.0)
        for time in (0, 10)
    ]
    mounting = recorded_mounting({"mounting_x": 50.0, "method": "integrated"})
    rejected: list[str] = []
    told = ping(2.0, sensor_position=(7.0, 8.0), sensor_velocity=(0.0, 0.0))
    at_rest = {"sensor_position": (0.0, 0.0), "sensor_velocity": (0.0, 0.0)}
    new = ping(6.0, **at_rest, unset_pose=True)
    placed = located_pings([ping(5.0), told, new, ping(11.0)], own_ship, mounting, rejected)
    expected = [[2.0, 7.0, 1008.0], [5.0, 100.0, 1000.0], [6.0, 110.0, 1000.0]]
    np.testing.assert_allclose(contact_points(placed, START, 0.0), expected, atol=1e-9)
    assert len(rejected) == 1 and "no odometry at its stamp" in rejected[0]
    assert recorded_mounting({}) == MountingConfiguration()


def test_own_ship_is_drawn_in_order_of_time() -> None:
    states = [OwnShipState(START + time * SECOND, (time, 0), 0.1, (1, 0), 0) for time in (2, 1)]
    assert own_ship_track(states, START)[:, :2].tolist() == [[1.0, 1.0], [2.0, 2.0]]
    assert own_ship_track([], START).shape == (0, 4)


def test_a_history_holds_what_claims_a_target() -> None:
    """Tentative rows and rows without a place are left out; identifiers stay apart."""
    status = np.array([TrackStatus.TENTATIVE, TrackStatus.CONFIRMED], np.uint8)
    early = position_tracks(0.0, [[1.0, 1.0, 0.0, 0.0], [5.0, 5.0, 0.0, 0.0]], status=status)
    late = position_tracks(1.0, [[2.0, 2.0, 0.0, 0.0], [np.nan, 5.0, 0.0, 0.0]])
    first, second = position_histories([early, late])
    assert (first.id, first.positions.tolist()) == (1, [[2.0, 2.0]])
    assert (second.id, second.seconds(START).tolist()) == (2, [0.0])
    assert position_histories([]) == ()


def test_open_positions_are_those_of_bearings_not_of_contacts() -> None:
    status = np.full(2, TrackStatus.TENTATIVE, np.uint8)
    bearing = np.array([0, 6], np.uint64)
    picture = position_tracks(0.0, [[1.0] * 4] * 2, status=status, bearing_track_id=bearing)
    assert [history.id for history in open_histories([picture])] == [2]


@pytest.mark.slow
@pytest.mark.parametrize("n_tracks", [0, 1, 30])
def test_a_chart_is_drawn_whatever_lies_on_it(tmp_path: Path, n_tracks: int) -> None:
    lists = [position_tracks(t, [[5.0 * t, 9.0, 0.0, 0.0]] * n_tracks) for t in (0.0, 1.0)]
    tracks = {"/active/tracks": position_histories(lists)}
    contacts = contact_points(
        [ping(0.0, sensor_position=(0.0, 0.0), sensor_velocity=(0.0, 0.0))], START, 1500.0
    )
    scene = TacticalScene(START, tracks=tracks, contacts=contacts)
    draw_tactical_plot(scene, tmp_path / "chart.png")
    assert (tmp_path / "chart.png").stat().st_size > 5000
