"""Protects where a station is and what its angles mean: sides, frames, poses told or not."""

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.errors import InputError
from sonar_tracking.motion import KinematicState, wrap_angle
from sonar_tracking.records.bearings import AngleKind, Sensor
from sonar_tracking.tma.targets.station_view import (
    may_be_unset,
    needs_own_ship,
    station_view,
    with_pose_judged,
)
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


def test_an_unknown_depth_is_not_an_unknown_place() -> None:
    """Positions are in the plane: nobody has to tell z, nor how fast it changes."""
    told = facing(0.0)
    flat = replace(
        told, position=(*told.position[:2], np.nan), velocity=(*told.velocity[:2], np.nan)
    )
    view = station_view(flat, own_ship(1.0, 0.2), DEFAULT)
    assert view.position == told.position[:2] and view.velocity == told.velocity[:2]


def test_nothing_known_is_refused_with_the_remedy() -> None:
    with pytest.raises(InputError, match="own_ship/odometry"):
        station_view(Sensor(), None, DEFAULT)


@pytest.mark.parametrize(
    ("yaw", "roll", "pitch"), [(0.7, 0.9, 0.0), (-2.0, -2.5, 0.0), (2.5, 0.0, 0.8)]
)
def test_an_array_that_rolls_or_pitches_still_points_where_its_axis_does(
    yaw: float, roll: float, pitch: float
) -> None:
    """Turned first by roll about x, then by pitch about y, then by yaw about z."""
    turns = [
        np.array([np.cos(yaw / 2.0), 0.0, 0.0, np.sin(yaw / 2.0)]),
        np.array([np.cos(pitch / 2.0), 0.0, np.sin(pitch / 2.0), 0.0]),
        np.array([np.cos(roll / 2.0), np.sin(roll / 2.0), 0.0, 0.0]),
    ]
    total = turns[0]
    for turn in turns[1:]:
        w, x, y, z = total
        total = np.array([[w, -x, -y, -z], [x, w, -z, y], [y, z, w, -x], [z, -y, x, w]]) @ turn
    w, x, y, z = total
    view = station_view(replace(facing(0.0), orientation=(x, y, z, w)), None, DEFAULT)
    assert wrap_angle(view.axis - yaw) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    ("changes", "possible"),
    [
        ({"position": (1e8, 0.0, 0.0)}, True),
        ({"position": (0.0, -1.1e8, 0.0)}, False),
        ({"velocity": (1499.0, 0.0, 0.0)}, True),
        ({"velocity": (1200.0, 900.0, 0.0)}, False),  # as fast as sound
    ],
)
def test_a_station_that_cannot_be_there_or_move_so_is_refused(
    changes: dict[str, tuple[float, float, float]], possible: bool
) -> None:
    sensor = replace(facing(0.0), **changes)  # type: ignore[arg-type]
    if possible:
        station_view(sensor, None, DEFAULT)
        return
    with pytest.raises(InputError, match="check its pose"):
        station_view(sensor, None, DEFAULT)


@pytest.mark.parametrize("missing", ["position", "velocity", "orientation"])
def test_each_part_that_is_not_told_needs_own_ship(missing: str) -> None:
    unknown = (np.nan,) * (4 if missing == "orientation" else 3)
    sensor = replace(facing(0.4), **{missing: unknown})  # type: ignore[arg-type]
    assert needs_own_ship(sensor, DEFAULT)
    with pytest.raises(InputError, match="own_ship/odometry"):
        station_view(sensor, None, DEFAULT)
    view = station_view(sensor, own_ship(1.0, 0.1), replace(DEFAULT, mounting_yaw_deg=90.0))
    told = station_view(facing(0.4), None, DEFAULT)
    assert view.position == pytest.approx(
        (100.0, 200.0) if missing == "position" else told.position
    )
    assert view.velocity == pytest.approx((3.0, 4.0) if missing == "velocity" else told.velocity)
    axis = 1.0 + HALF if missing == "orientation" else told.axis
    assert view.axis == pytest.approx(axis)
    assert view.turn_rate == 0.1


def test_an_angle_from_broadside_is_the_same_ahead_and_astern() -> None:
    view = station_view(facing(0.5), None, DEFAULT)
    assert view.from_broadside(np.pi - 0.3, AngleKind.CONE) == pytest.approx(0.3)
    assert view.from_broadside(-np.pi + 0.3, AngleKind.CONE) == pytest.approx(-0.3)
    # 2 rad to either side of the axis: behind broadside by 2 - pi / 2.
    for azimuth in (2.0, -2.0):
        assert view.from_broadside(azimuth, AngleKind.AZIMUTH) == pytest.approx(HALF - 2.0)


NEW = Sensor("array", "own_ship/array", (0.0,) * 3, (0.0, 0.0, 0.0, 1.0), (0.0,) * 3)


@pytest.mark.parametrize("frame", ["own_ship/array", "", "map", "array"])
def test_a_pose_that_nobody_has_set_is_that_of_own_ship(frame: str) -> None:
    """Its place, its motion and its axis, as if the data did not tell them."""
    new = replace(NEW, frame_id=frame)
    assert may_be_unset(new) and not needs_own_ship(new, DEFAULT)
    sensor, notice = with_pose_judged(new, own_ship(0.3), DEFAULT, odometry=True)
    assert needs_own_ship(sensor, DEFAULT)
    view = station_view(sensor, own_ship(0.3), DEFAULT)
    assert view.position == (100.0, 200.0) and view.velocity == (3.0, 4.0)
    assert view.axis == pytest.approx(0.3)
    assert notice is not None and "own_ship/odometry and the mounting" in notice.text


def test_a_station_of_another_platform_may_be_at_the_origin() -> None:
    buoy = replace(NEW, frame_id="buoy/array")
    assert not may_be_unset(buoy)
    sensor, notice = with_pose_judged(buoy, own_ship(0.3), DEFAULT, odometry=True)
    assert sensor is buoy and notice is not None and "buoy/array" in notice.text
    assert with_pose_judged(buoy, None, DEFAULT, odometry=True) == (buoy, None)


def test_own_ship_at_rest_at_the_origin_has_its_array_there() -> None:
    at_rest = replace(own_ship(0.0), position=np.zeros(2), velocity=np.zeros(2))
    sensor, notice = with_pose_judged(NEW, at_rest, DEFAULT, odometry=True)
    assert sensor is NEW and notice is not None and not notice.text


def test_a_place_that_was_set_is_kept_and_compared_on_own_ship_only() -> None:
    """The direction is not compared: a towed array follows a turn late."""
    for frame, words in (("own_ship/array", "from where"), ("buoy/array", ""), ("map", "")):
        told = replace(facing(2.0, frame), position=(10.0, 2000.0, 0.0))
        sensor, notice = with_pose_judged(told, own_ship(0.0), DEFAULT, odometry=True)
        assert sensor is told
        assert (words in notice.text) if notice else not words
    near = facing(2.0)
    sensor, notice = with_pose_judged(near, own_ship(0.0), DEFAULT, odometry=True)
    assert sensor is near and notice is not None and not notice.text
