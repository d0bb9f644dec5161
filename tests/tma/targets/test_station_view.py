"""Protects where a station is and what its angles mean: sides, frames, poses told or not."""

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.errors import InputError
from sonar_tracking.motion import KinematicState, wrap_angle
from sonar_tracking.records.bearings import AngleKind, Sensor
from sonar_tracking.tma.targets.station_view import needs_own_ship, station_view
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration

HALF = np.pi / 2.0
DEFAULT = TmaTrackerConfiguration()


def facing(axis: float, frame: str = "own_ship/array") -> Sensor:
    """Return a sensor at (10, 20) whose x axis has an azimuth."""
    return Sensor(
        sensor_id="array",
        frame_id=frame,
        position=(10.0, 20.0, -5.0),
        orientation=(0.0, 0.0, np.sin(axis / 2.0), np.cos(axis / 2.0)),
        velocity=(1.0, 2.0, 0.0),
    )


def own_ship(heading: float, turn_rate: float = 0.0) -> KinematicState:
    return KinematicState(
        position=np.array([100.0, 200.0]),
        velocity=np.array([3.0, 4.0]),
        azimuth=np.array(heading),
        turn_rate=np.array(turn_rate),
    )


@pytest.mark.parametrize("axis", [-3.0, -1.0, 0.0, 0.7, 3.1])
def test_both_sides_of_a_line_array_give_the_angle_that_was_measured(axis: float) -> None:
    view = station_view(facing(axis), None, DEFAULT)
    for angle in np.radians([-80.0, -10.0, 0.0, 45.0]):
        left, right = view.azimuths(float(angle), AngleKind.CONE, ambiguous=True)
        for side, azimuth in ((1.0, left), (-1.0, right)):
            from_axis = float(wrap_angle(azimuth - axis))
            assert np.sign(from_axis) == side
            assert np.sin(angle) == pytest.approx(np.cos(from_axis))


def test_an_array_that_knows_its_sides_has_one_azimuth() -> None:
    view = station_view(facing(0.5), None, DEFAULT)
    (azimuth,) = view.azimuths(0.2, AngleKind.CONE, ambiguous=False)
    assert azimuth == pytest.approx(0.5 + HALF - 0.2)


def test_azimuths_are_those_of_their_frame() -> None:
    in_map = station_view(facing(1.0, "map"), None, DEFAULT)
    assert in_map.azimuths(0.3, AngleKind.AZIMUTH, False) == pytest.approx((0.3,))
    turned = station_view(facing(1.0, "buoy"), None, DEFAULT)
    assert turned.azimuths(0.3, AngleKind.AZIMUTH, False) == pytest.approx((1.3,))
    expected = HALF - abs(0.3)
    assert turned.from_broadside(0.3, AngleKind.AZIMUTH) == pytest.approx(expected)


def test_what_the_data_do_not_tell_comes_from_own_ship_and_the_mounting() -> None:
    configuration = replace(DEFAULT, mounting_x=-50.0, mounting_y=5.0, mounting_yaw_deg=180.0)
    untold = Sensor()
    assert needs_own_ship(untold, configuration)
    view = station_view(untold, own_ship(HALF, 0.1), configuration)
    assert view.position == pytest.approx((100.0 - 5.0, 200.0 - 50.0))
    assert view.axis == pytest.approx(HALF + np.pi)
    assert view.velocity == pytest.approx((3.0 + 0.1 * 50.0, 4.0 - 0.1 * 5.0))
    assert view.turn_rate == 0.1


def test_a_pose_that_is_told_needs_no_own_ship_unless_the_array_is_towed() -> None:
    assert not needs_own_ship(facing(0.0), DEFAULT)
    assert needs_own_ship(facing(0.0), replace(DEFAULT, array_lag=5.0))
    assert not needs_own_ship(facing(0.0, "buoy"), replace(DEFAULT, array_lag=5.0))
    view = station_view(facing(0.0, "buoy"), own_ship(1.0, 0.2), DEFAULT)
    assert (view.position, view.velocity, view.turn_rate) == ((10.0, 20.0), (1.0, 2.0), 0.0)


def test_nothing_known_is_refused_with_the_remedy() -> None:
    with pytest.raises(InputError, match="own_ship/odometry"):
        station_view(Sensor(), None, DEFAULT)
