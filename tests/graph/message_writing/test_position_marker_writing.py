"""Protects the picture of position tracks: what is drawn, and how large the ellipse is."""

from dataclasses import replace

import numpy as np
import pytest
from visualization_msgs.msg import Marker

from sonar_tracking.filtering.uncertainty_ellipse import uncertainty_ellipse
from sonar_tracking.graph.message_writing.position_marker_writing import position_markers
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import PositionTracks, TrackHypothesis, TrackSource

STAMP = 1_767_225_600 * 10**9


def tracks(*status: TrackStatus) -> PositionTracks:
    count = len(status)
    return PositionTracks(
        stamp=STAMP,
        id=np.arange(count, dtype=np.uint64) + (1 << 40),
        status=np.array(status, np.uint8),
        source=np.full(count, TrackSource.TMA, np.uint8),
        state=np.tile([100.0, 200.0, 3.0, -4.0], (count, 1)),
        covariance=np.tile(np.diag([400.0, 100.0, 1.0, 1.0]), (count, 1, 1)),
        hypothesis=np.full(count, TrackHypothesis.LEFT, np.uint8),
        hypothesis_probability=np.full(count, 0.5),
    )


def test_the_ellipse_holds_the_stated_share_and_lies_as_the_errors_do() -> None:
    turn = np.radians(30.0)
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    covariance = rotation @ np.diag([900.0, 100.0]) @ rotation.T
    ellipse = uncertainty_ellipse(covariance, 0.95)
    assert ellipse is not None
    major, minor, azimuth = ellipse.semi_major, ellipse.semi_minor, ellipse.azimuth
    assert (major, minor) == pytest.approx((30.0 * 2.4477, 10.0 * 2.4477), rel=1e-4)
    assert np.tan(azimuth) == pytest.approx(np.tan(turn))
    drawn = np.random.default_rng(1).multivariate_normal([0.0, 0.0], covariance, 20_000)
    along = drawn @ np.array([np.cos(azimuth), np.sin(azimuth)]) / major
    across = drawn @ np.array([-np.sin(azimuth), np.cos(azimuth)]) / minor
    assert np.mean(along**2 + across**2 < 1.0) == pytest.approx(0.95, abs=0.01)


def test_a_track_is_a_dot_an_arrow_a_name_and_an_ellipse() -> None:
    markers = position_markers(tracks(TrackStatus.CONFIRMED)).markers
    assert markers[0].action == Marker.DELETEALL
    by_name = {marker.ns: marker for marker in markers[1:]}
    assert set(by_name) == {"position", "velocity", "name", "ellipse"}
    arrow = by_name["velocity"].points
    assert (arrow[1].x, arrow[1].y) == (100.0 + 60.0 * 3.0, 200.0 - 60.0 * 4.0)
    assert by_name["name"].text == str(1 << 40)
    assert by_name["ellipse"].scale.x == pytest.approx(2.0 * 20.0 * 2.4477, rel=1e-4)
    assert {marker.header.frame_id for marker in markers} == {"map"}
    assert by_name["position"].color.a == pytest.approx(0.5)


def test_what_has_ended_is_not_drawn_and_the_tentative_is_fainter() -> None:
    drawn = position_markers(
        tracks(TrackStatus.TERMINATED, TrackStatus.TENTATIVE, TrackStatus.CONFIRMED)
    ).markers
    dots = [marker for marker in drawn if marker.ns == "position"]
    assert [marker.id for marker in dots] == [1, 2]
    assert dots[0].color.a < dots[1].color.a


def test_an_empty_list_clears_the_picture() -> None:
    (only,) = position_markers(tracks()).markers
    assert only.action == Marker.DELETEALL


def names_of(drawn: PositionTracks) -> set[str]:
    return {marker.ns for marker in position_markers(drawn, size=60.0).markers[1:]}


@pytest.mark.parametrize(("northward", "side"), [(-4.0, 1.0), (4.0, -1.0), (0.0, 1.0)])
def test_the_name_is_where_the_arrow_does_not_go(northward: float, side: float) -> None:
    state = np.array([[100.0, 200.0, 3.0, northward]])
    drawn = position_markers(replace(tracks(TrackStatus.CONFIRMED), state=state), size=60.0)
    (name,) = (marker for marker in drawn.markers if marker.ns == "name")
    assert (name.pose.position.x, name.pose.position.y) == (100.0, 200.0 + side * 120.0)


def test_a_name_can_be_read_though_its_track_is_faint() -> None:
    drawn = position_markers(tracks(TrackStatus.COASTED)).markers[1:]
    opacity = {marker.ns: marker.color.a for marker in drawn}
    assert opacity["position"] == pytest.approx(0.2 * 0.5)
    assert opacity["name"] >= 0.6


def test_no_opacity_is_above_one() -> None:
    certain = replace(tracks(TrackStatus.CONFIRMED), hypothesis_probability=np.array([1.0 + 1e-15]))
    assert max(marker.color.a for marker in position_markers(certain).markers) == 1.0


def test_an_arrow_ends_outside_of_its_dot_or_is_not_drawn() -> None:
    # A dot with a radius of 30 m; an arrow shows what is done in a minute: the limit is 0.5 m/s.
    for speed, seen in ((0.0, False), (0.49, False), (0.51, True)):
        slow = replace(tracks(TrackStatus.CONFIRMED), state=np.array([[100.0, 200.0, 0.0, speed]]))
        expected = {"position", "name", "ellipse"} | ({"velocity"} if seen else set())
        assert names_of(slow) == expected


def test_an_ellipse_is_drawn_up_to_20_km_and_with_a_width() -> None:
    # Semi-axes of 95 % are 2.4477 standard deviations: 20 km are 4085.5 m.
    for along, across, seen in ((4080.0, 10.0, True), (4090.0, 10.0, False), (10.0, 0.0, False)):
        covariance = np.diag([along**2, across**2, 1.0, 1.0])[None]
        wide = replace(tracks(TrackStatus.CONFIRMED), covariance=covariance)
        expected = {"position", "velocity", "name"} | ({"ellipse"} if seen else set())
        assert names_of(wide) == expected


@pytest.mark.parametrize("probability", [0.001, 0.05, 0.1, 0.2, 0.3, 0.6, 1.0])
@pytest.mark.parametrize("status", [*TrackStatus])
def test_nothing_is_drawn_that_is_all_but_transparent(
    status: TrackStatus, probability: float
) -> None:
    drawn = replace(tracks(status), hypothesis_probability=np.array([probability]))
    markers = position_markers(drawn).markers
    assert markers[0].action == Marker.DELETEALL
    assert all(marker.color.a >= 0.05 for marker in markers[1:])
    opacity = {TrackStatus.CONFIRMED: 1.0, TrackStatus.TENTATIVE: 0.4, TrackStatus.COASTED: 0.2}
    seen = opacity.get(status, 0.0) * probability >= 0.05
    assert (len(markers) > 1) == seen


def test_what_is_fixed_has_a_form_of_its_own() -> None:
    both = tracks(TrackStatus.CONFIRMED, TrackStatus.CONFIRMED)
    source = np.array([TrackSource.ACTIVE, TrackSource.STATIC], np.uint8)
    drawn = position_markers(replace(both, source=source)).markers
    forms = {marker.id: marker.type for marker in drawn if marker.ns == "position"}
    assert list(forms.values()) == [Marker.SPHERE, Marker.CUBE]
