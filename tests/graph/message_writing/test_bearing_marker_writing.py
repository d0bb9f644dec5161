"""Protects the picture of what is heard: where rays end, how wide wedges are, what is left out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from visualization_msgs.msg import Marker, MarkerArray

from sonar_tracking.graph.message_writing.bearing_marker_writing import bearing_markers
from sonar_tracking.records.bearings import AngleKind, BearingTracks, TrackStatus
from sonar_tracking.tma.targets.station_view import StationView

STAMP = 1_767_225_600 * 10**9
PLACE = (100.0, 200.0)
LENGTH = 1000.0


def heard(
    angle_deg: float = 30.0,
    kind: AngleKind = AngleKind.CONE,
    deviation_deg: float = 2.0,
    status: TrackStatus = TrackStatus.CONFIRMED,
) -> BearingTracks:
    one = np.ones(1)
    return BearingTracks(
        stamp=STAMP,
        id=np.array([7], np.uint64),
        status=np.array([status], np.uint8),
        arrival_angle=np.radians(angle_deg) * one,
        arrival_angle_rate=0.0 * one,
        covariance=np.radians(deviation_deg) ** 2 * np.eye(2)[None],
        measurement=one,
        measurement_variance=one,
        innovation=one,
        signal_to_noise_ratio=one,
        existence_probability=one,
        ambiguous=np.array([kind is AngleKind.CONE]),
        angle_kind=kind,
    )


def station(axis_deg: float = 0.0, frame_id: str = "own_ship/array") -> StationView:
    return StationView("array", frame_id, PLACE, (0.0, 0.0), np.radians(axis_deg), 0.0)


def drawn(tracks: BearingTracks, view: StationView) -> dict[str, Marker]:
    """Return the markers after the first by the second part of their namespace."""
    first, *others = bearing_markers([(tracks, view)], STAMP, LENGTH, size=50.0).markers
    assert first.action == Marker.DELETEALL
    assert {marker.header.frame_id for marker in (first, *others)} == {"map"}
    assert all(marker.ns.startswith("array/") for marker in others)
    return {marker.ns.removeprefix("array/"): marker for marker in others}


def azimuths_deg(marker: Marker) -> list[float]:
    """Return the directions in which the points of a marker are seen, without the station."""
    points = np.array([(point.x, point.y) for point in marker.points]) - PLACE
    away = points[np.hypot(*points.T) > 1e-6]
    assert np.hypot(*away.T) == pytest.approx(LENGTH)
    return sorted(set(np.degrees(np.arctan2(away[:, 1], away[:, 0])).round(6).tolist()))


def test_a_cone_is_a_ray_on_the_left_and_one_on_the_right() -> None:
    # 30 degrees from broadside is 60 from the axis, which points east: 60 degrees to either side.
    markers = drawn(heard(30.0), station(axis_deg=0.0))
    assert set(markers) == {
        *("ray_left", "wedge_left", "name_left"),
        *("ray_right", "wedge_right", "name_right"),
    }
    start, end = markers["ray_left"].points
    assert (start.x, start.y) == PLACE
    assert (end.x, end.y) == pytest.approx((100.0 + 500.0, 200.0 + 866.0254))
    assert azimuths_deg(markers["ray_right"]) == [-60.0]
    assert markers["ray_left"].color.a == markers["ray_right"].color.a == 0.5
    assert markers["name_left"].text == "7"
    colours = {side: markers[f"ray_{side}"].color for side in ("left", "right")}
    assert (colours["left"].r, colours["left"].b) != (colours["right"].r, colours["right"].b)


def test_the_axis_turns_both_rays() -> None:
    markers = drawn(heard(-20.0), station(axis_deg=90.0))
    # 110 degrees from an axis that points north.
    assert azimuths_deg(markers["ray_left"]) == [-160.0]
    assert azimuths_deg(markers["ray_right"]) == [-20.0]


@pytest.mark.parametrize(("frame_id", "expected"), [("map", 135.0), ("own_ship/array", 145.0)])
def test_an_azimuth_is_one_ray(frame_id: str, expected: float) -> None:
    markers = drawn(heard(135.0, AngleKind.AZIMUTH), station(10.0, frame_id))
    assert set(markers) == {"ray", "wedge", "name"}
    assert azimuths_deg(markers["ray"]) == [pytest.approx(expected)]
    assert markers["ray"].color.a == 1.0


def test_a_wedge_reaches_to_95_per_cent_on_either_side() -> None:
    wedge = drawn(heard(135.0, AngleKind.AZIMUTH, deviation_deg=2.0), station(0.0, "map"))["wedge"]
    assert wedge.type == Marker.TRIANGLE_LIST
    assert len(wedge.points) % 3 == 0
    around = azimuths_deg(wedge)
    assert (around[0], around[-1]) == pytest.approx((135.0 - 3.92, 135.0 + 3.92))
    assert max(np.diff(around)) <= 3.0 + 1e-6


def test_a_wedge_ends_at_the_axis_of_the_array() -> None:
    # 88 +- 3.92 degrees from broadside: nothing arrives from beyond the end.
    markers = drawn(heard(88.0, deviation_deg=2.0), station(axis_deg=0.0))
    left, right = (azimuths_deg(markers[f"wedge_{side}"]) for side in ("left", "right"))
    assert (left[0], left[-1]) == pytest.approx((0.0, 2.0 + 3.92), abs=1e-6)
    assert (right[0], right[-1]) == pytest.approx((-5.92, 0.0), abs=1e-6)


@pytest.mark.parametrize(
    ("deviation_deg", "seen"), [(0.1, False), (0.16, True), (22.0, True), (23.5, False)]
)
def test_a_wedge_is_wider_than_its_ray_and_narrower_than_a_quarter(
    deviation_deg: float, seen: bool
) -> None:
    # A ray is a fifth of 50 m wide: 10 m are 0.573 degrees at 1000 m, a deviation of 0.146.
    markers = drawn(heard(0.0, AngleKind.AZIMUTH, deviation_deg), station(0.0, "map"))
    assert set(markers) == ({"ray", "name", "wedge"} if seen else {"ray", "name"})


def test_without_a_variance_there_is_no_wedge() -> None:
    for variance in (np.nan, 0.0, -1.0, np.inf):
        unknown = replace(heard(), covariance=np.full((1, 2, 2), variance))
        names = set(drawn(unknown, station()))
        assert names == {"ray_left", "name_left", "ray_right", "name_right"}
        unknown = replace(unknown, angle_kind=AngleKind.AZIMUTH)
        assert set(drawn(unknown, station())) == {"ray", "name"}


def test_what_has_no_angle_or_has_ended_is_not_drawn() -> None:
    assert not drawn(heard(np.nan), station())
    assert not drawn(heard(status=TrackStatus.TERMINATED), station())
    assert not drawn(replace(heard(), arrival_angle=np.array([np.inf])), station())


def test_the_faint_is_left_out_and_its_name_can_be_read() -> None:
    markers = drawn(heard(status=TrackStatus.COASTED), station())
    # 0.2 on either of two sides; the wedge would have 0.03.
    assert set(markers) == {"ray_left", "name_left", "ray_right", "name_right"}
    assert markers["ray_left"].color.a == pytest.approx(0.1)
    assert markers["name_left"].color.a >= 0.6


def test_stations_are_in_one_picture_under_their_names() -> None:
    buoy = replace(station(frame_id="map"), sensor_id="buoy", position=(0.0, 0.0))
    pairs = [(heard(), station()), (heard(10.0, AngleKind.AZIMUTH), buoy)]
    picture: MarkerArray = bearing_markers(pairs, STAMP)
    assert {"array/ray_left", "array/ray_right", "buoy/ray"} < {m.ns for m in picture.markers}
    names = [(marker.ns, marker.id) for marker in picture.markers]
    assert len(set(names)) == len(names)
    (only,) = bearing_markers([], STAMP).markers
    assert only.action == Marker.DELETEALL
