"""Protects where what is heard is shown: as told, on own ship, or nowhere."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.active.contacts.sensor_location import MountingConfiguration
from sonar_tracking.motion import KinematicState
from sonar_tracking.records.bearings import BearingTracks, Sensor, TrackStatus
from sonar_tracking.records.contacts import Contacts
from sonar_tracking.scene.scene_hearing import (
    HeardStations,
    contacts_need_own_ship,
    located_contacts,
)
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration

SECOND = 10**9
UNKNOWN = (np.nan, np.nan)
NORTHBOUND = KinematicState(
    position=np.array([1000.0, 2000.0]),
    velocity=np.array([0.0, 5.0]),
    azimuth=np.array(np.pi / 2.0),
    turn_rate=np.array(0.0),
)
PING = Contacts(
    stamp=0,
    range=np.array([300.0]),
    azimuth=np.array([0.0]),
    amplitude=np.array([10.0]),
    range_standard_deviation=1.0,
    azimuth_standard_deviation=0.01,
    sensor_position=(50.0, 60.0),
    sensor_velocity=(0.0, 0.0),
)


def places(
    ping: Contacts, own_ship: KinematicState | None, sound_speed: float = 0.0
) -> list[float]:
    """Return x and y of the first contact."""
    mounting = MountingConfiguration(mounting_x=10.0, mounting_yaw_deg=90.0)
    found, positions = located_contacts(ping, own_ship, mounting, own_ship is not None, sound_speed)
    assert len(positions) == len(found.range)
    return [float(value) for value in positions[0]]


def test_contacts_are_where_their_sensor_says() -> None:
    assert places(PING, None) == [350.0, 60.0]
    assert places(PING, NORTHBOUND) == [350.0, 60.0]
    assert not contacts_need_own_ship(PING)


def test_contacts_without_a_pose_are_seen_from_own_ship() -> None:
    # 10 m ahead is north of the ship; +x of a sonar turned by 90 degrees looks west then.
    told = replace(
        PING, sensor_position=UNKNOWN, sensor_velocity=UNKNOWN, frame_id="own_ship/sonar"
    )
    assert contacts_need_own_ship(told)
    assert places(told, NORTHBOUND) == pytest.approx([700.0, 2010.0])


def test_a_moving_sonar_has_gone_on_when_the_echo_returns() -> None:
    # 300 m and back at 1500 m/s are 0.4 s, 2 m at 5 m/s; seen across, the echo comes from 2 m on.
    moving = replace(PING, sensor_velocity=(0.0, 5.0))
    assert places(moving, None, sound_speed=1500.0) == pytest.approx([350.0, 62.0], abs=0.01)


def test_what_nobody_can_locate_has_no_place() -> None:
    told = replace(PING, sensor_position=UNKNOWN, sensor_velocity=UNKNOWN)
    assert np.isnan(places(told, None)).all()


@pytest.mark.filterwarnings("error")
def test_a_contact_that_is_no_number_has_no_place() -> None:
    for range_, azimuth in ((np.nan, 0.0), (np.inf, 0.0), (1.0, np.nan), (1.0, np.inf), (0.0, 0.0)):
        odd = replace(PING, range=np.array([range_]), azimuth=np.array([azimuth]))
        assert not np.isfinite(places(odd, None, sound_speed=1500.0)).all()


def heard(sensor: Sensor, second: int = 0) -> BearingTracks:
    one = np.ones(1)
    return BearingTracks(
        stamp=second * SECOND,
        id=np.array([1], np.uint64),
        status=np.array([TrackStatus.CONFIRMED], np.uint8),
        arrival_angle=0.0 * one,
        arrival_angle_rate=one,
        covariance=np.eye(2)[None],
        measurement=one,
        measurement_variance=one,
        innovation=one,
        signal_to_noise_ratio=one,
        existence_probability=one,
        ambiguous=np.array([True]),
        sensor=sensor,
    )


ON_SHIP = Sensor("array")
BUOY = Sensor("buoy", "map", (6000.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0))


def stations() -> HeardStations:
    return HeardStations(TmaTrackerConfiguration(mounting_x=-20.0, mounting_yaw_deg=180.0))


def test_every_station_is_seen_from_its_place() -> None:
    each = stations()
    assert each.needs_own_ship(heard(ON_SHIP))
    assert not each.needs_own_ship(heard(BUOY))
    each.take(heard(ON_SHIP), NORTHBOUND, odometry=True)
    each.take(heard(BUOY), None, odometry=True)
    array, buoy = (view for _, view in each.heard)
    # 20 m behind a ship that goes north, and turned back to the south.
    assert array.position == pytest.approx((1000.0, 1980.0))
    assert np.sin(array.axis) == pytest.approx(-1.0)
    assert buoy.position == (6000.0, 0.0)


def test_the_last_word_of_a_station_counts_until_it_has_been_silent_for_long() -> None:
    each = stations()
    each.take(heard(BUOY), None, odometry=False)
    each.take(heard(BUOY, 30), None, odometry=False)
    each.take(heard(ON_SHIP, 60), NORTHBOUND, odometry=True)
    assert [tracks.stamp for tracks, _ in each.heard] == [30 * SECOND, 60 * SECOND]
    each.take(heard(ON_SHIP, 91), NORTHBOUND, odometry=True)
    assert [view.sensor_id for _, view in each.heard] == ["array"]


def test_a_station_nobody_can_locate_any_more_is_no_longer_shown() -> None:
    each = stations()
    each.take(heard(ON_SHIP), NORTHBOUND, odometry=True)
    each.take(heard(ON_SHIP, 1), None, odometry=True)
    assert not each.heard


def test_data_that_begin_again_leave_nothing_behind() -> None:
    each = stations()
    each.take(heard(BUOY, 5000), None, odometry=False)
    each.take(heard(replace(BUOY, sensor_id="other")), None, odometry=False)
    assert [view.sensor_id for _, view in each.heard] == ["other"]
