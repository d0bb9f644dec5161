"""Protects: where the sensor of a ping is, and what a ping leaves to the parameters."""

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.active.contacts.contact_defaults import (
    ContactDefaultsConfiguration,
    with_defaults,
)
from sonar_tracking.active.contacts.sensor_location import (
    MountingConfiguration,
    located,
    needs_own_ship,
    with_pose_judged,
)
from sonar_tracking.errors import InputError
from sonar_tracking.motion import KinematicState, Trajectory, Turn
from sonar_tracking.records.contacts import Contacts

UNKNOWN = (np.nan, np.nan)
CONTACTS = Contacts(
    stamp=10**9,
    range=np.array([1000.0, 2000.0]),
    azimuth=np.array([0.3, -3.0]),
    amplitude=np.zeros(0),
    range_standard_deviation=10.0,
    azimuth_standard_deviation=0.01,
    sensor_position=(5.0, 6.0),
    sensor_velocity=(1.0, 2.0),
)
MOUNTED = MountingConfiguration(mounting_x=10.0, mounting_y=-4.0, mounting_yaw_deg=180.0)


def ship(time: float = 3.0) -> KinematicState:
    return Trajectory((100.0, 50.0), 0.4, 5.0, [Turn(0.0, 2.0, 0.1)]).state(time)


def test_a_ping_that_tells_its_pose_in_map_is_left_alone() -> None:
    assert not needs_own_ship(CONTACTS)
    assert located(CONTACTS, None, MOUNTED) == CONTACTS
    assert located(CONTACTS, ship(), MOUNTED) == CONTACTS


def test_a_ping_without_pose_takes_own_ship_and_the_mounting() -> None:
    """Velocity on the lever arm: the derivative of the position."""
    lost = replace(CONTACTS, sensor_position=UNKNOWN, sensor_velocity=UNKNOWN)
    assert needs_own_ship(lost)
    found = located(lost, ship(), MOUNTED)
    step = 1e-4
    before = located(lost, ship(3.0 - step), MOUNTED).sensor_position
    after = located(lost, ship(3.0 + step), MOUNTED).sensor_position
    velocity = (np.array(after) - np.array(before)) / (2.0 * step)
    assert found.sensor_velocity == pytest.approx(velocity, rel=1e-5)
    assert np.hypot(*(found.sensor_position - ship().position)) == pytest.approx(np.hypot(10, 4))
    assert np.array_equal(found.azimuth, CONTACTS.azimuth)


def test_what_the_ping_tells_is_not_overwritten() -> None:
    half = replace(CONTACTS, sensor_velocity=UNKNOWN)
    found = located(half, ship(), MOUNTED)
    assert found.sensor_position == CONTACTS.sensor_position
    assert np.all(np.isfinite(found.sensor_velocity))


NEW = replace(
    CONTACTS,
    sensor_position=(0.0, 0.0),
    sensor_velocity=(0.0, 0.0),
    sensor_yaw=0.0,
    unset_pose=True,
)


@pytest.mark.parametrize("frame", ["map", "", "sonar_link", "ship/sonar"])
@pytest.mark.parametrize("velocity", [(0.0, 0.0), UNKNOWN])
def test_a_ping_whose_pose_nobody_has_set_is_as_one_that_does_not_tell(
    frame: str, velocity: tuple[float, float]
) -> None:
    new = replace(NEW, frame_id=frame, sensor_velocity=velocity)
    judged, notice = with_pose_judged(new, ship(), MOUNTED, odometry=True)
    told = replace(new, sensor_position=UNKNOWN, sensor_velocity=UNKNOWN, sensor_yaw=np.nan)
    one, other = located(judged, ship(), MOUNTED), located(told, ship(), MOUNTED)
    assert one.sensor_position == other.sensor_position
    assert one.sensor_velocity == other.sensor_velocity
    assert np.array_equal(one.azimuth, other.azimuth)
    assert notice is not None and "new message" in notice.text


def test_without_odometry_the_sensor_is_at_the_origin_and_before_it_nowhere() -> None:
    judged, notice = with_pose_judged(NEW, None, MOUNTED, odometry=False)
    assert located(judged, None, MOUNTED).sensor_position == (0.0, 0.0)
    assert notice is not None and "no own_ship/odometry" in notice.text
    judged, _ = with_pose_judged(NEW, None, MOUNTED, odometry=True)
    with pytest.raises(InputError, match="odometry"):
        located(judged, None, MOUNTED)


def test_a_pose_that_was_set_is_kept_and_compared() -> None:
    """Its yaw only where azimuths turn with the sensor; a ping that does not tell has none."""
    judged, notice = with_pose_judged(CONTACTS, ship(), MOUNTED, odometry=True)
    assert judged is CONTACTS and notice is not None and not notice.text
    far = replace(CONTACTS, sensor_position=(5.0, 6000.0))
    judged, notice = with_pose_judged(far, ship(), MOUNTED, odometry=True)
    assert judged is far and notice is not None and "from where" in notice.text
    askew = replace(CONTACTS, sensor_yaw=float(ship().azimuth))
    for frame, words in (("map", ""), ("sonar", "180 degrees")):
        told = replace(askew, frame_id=frame)
        judged, notice = with_pose_judged(told, ship(), MOUNTED, odometry=True)
        assert judged is told and notice is not None and words in notice.text
        assert bool(notice.text) == bool(words)
    silent = replace(CONTACTS, sensor_position=UNKNOWN)
    assert with_pose_judged(silent, ship(), MOUNTED, odometry=True) == (silent, None)


@pytest.mark.parametrize("yaw", [0.5, np.nan])
def test_azimuths_that_turn_with_the_sensor_are_brought_into_map(yaw: float) -> None:
    turned = replace(CONTACTS, frame_id="own_ship/array", sensor_yaw=yaw, minimum_azimuth=-0.4)
    assert needs_own_ship(turned) == np.isnan(yaw)
    found = located(turned, ship(), MOUNTED)
    expected = 0.5 if np.isfinite(yaw) else float(ship().azimuth) + np.pi
    difference = np.exp(1j * (found.azimuth - turned.azimuth - expected))
    assert difference == pytest.approx(np.ones(2))
    assert np.all(np.abs(found.azimuth) <= np.pi)
    sector = np.exp(1j * (found.minimum_azimuth + 0.4 - expected))
    assert sector == pytest.approx(1.0)
    assert found.frame_id == "map"


def test_a_ping_that_needs_own_ship_and_has_none_is_refused() -> None:
    with pytest.raises(InputError, match="odometry"):
        located(replace(CONTACTS, sensor_velocity=UNKNOWN), None, MOUNTED)


def test_parameters_fill_in_what_a_ping_does_not_tell_and_nothing_else() -> None:
    defaults = ContactDefaultsConfiguration(
        range_standard_deviation=30.0,
        azimuth_standard_deviation_deg=1.0,
        false_alarm_probability=1e-3,
        azimuth_width_deg=90.0,
    )
    told = with_defaults(CONTACTS, defaults)
    assert told.range_standard_deviation == 10.0
    assert told.false_alarm_probability == 1e-3
    assert told.azimuth_width == pytest.approx(np.pi / 2.0)
    assert np.isnan(told.detection_threshold)
    silent = replace(CONTACTS, range_standard_deviation=np.nan, azimuth_standard_deviation=np.nan)
    filled = with_defaults(silent, defaults)
    assert filled.range_standard_deviation == 30.0
    assert filled.azimuth_standard_deviation == pytest.approx(np.radians(1.0))
    untouched = with_defaults(silent, ContactDefaultsConfiguration())
    assert np.isnan(untouched.range_standard_deviation)
