"""Protects the pictures of contacts and gates: places, colours, axes, and what is left out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from visualization_msgs.msg import Marker

from sonar_tracking.graph.message_writing.contact_marker_writing import (
    amplitude_colours,
    contact_markers,
    gate_markers,
)
from sonar_tracking.records.contacts import Contacts, GateThresholds

STAMP = 1_767_225_600 * 10**9
POSITIONS = np.array([[10.0, 20.0], [np.nan, 1.0], [30.0, 40.0], [50.0, np.inf]])


def ping(amplitude: list[float]) -> Contacts:
    return Contacts(
        stamp=STAMP,
        range=np.ones(len(POSITIONS)),
        azimuth=np.ones(len(POSITIONS)),
        amplitude=np.array(amplitude),
        range_standard_deviation=1.0,
        azimuth_standard_deviation=0.01,
    )


def test_contacts_are_spheres_where_their_place_is_known() -> None:
    clear, points = contact_markers(ping([5.0, 10.0, 100.0, 1.0]), POSITIONS, size=50.0).markers
    assert clear.action == Marker.DELETEALL
    assert points.type == Marker.SPHERE_LIST
    assert points.header.frame_id == "map"
    assert [(p.x, p.y, p.z) for p in points.points] == [(10.0, 20.0, 0.0), (30.0, 40.0, 0.0)]
    assert len(points.colors) == 2
    assert points.scale.x == points.scale.y == points.scale.z == 40.0
    weak, strong = points.colors
    assert weak.r < strong.r
    assert {weak.a, strong.a} == {1.0}


def test_colours_grow_with_the_amplitude_between_two_ends() -> None:
    # 6 dB is a power of 3.98, 18 dB one of 63.1; 12 dB, 15.85, is half way.
    colours = amplitude_colours(np.array([0.0, 1.0, 3.98, 15.85, 63.1, 1e9, np.inf]), 7)
    assert np.all(np.diff(colours[:, 0]) >= 0.0)
    assert colours[0].tolist() == colours[1].tolist() == pytest.approx(colours[2], abs=1e-3)
    assert colours[3] == pytest.approx(0.5 * (colours[0] + colours[-1]), abs=1e-3)
    assert colours[4] == pytest.approx(colours[-1], abs=1e-3)
    assert np.all((colours >= 0.0) & (colours <= 1.0))


def test_what_was_not_measured_has_the_colour_in_the_middle() -> None:
    middle = amplitude_colours(np.array([10.0**1.2]), 1)
    assert amplitude_colours(np.empty(0), 2) == pytest.approx(np.repeat(middle, 2, axis=0))
    assert amplitude_colours(np.array([np.nan]), 1) == pytest.approx(middle)


def test_a_ping_without_contacts_clears_the_picture() -> None:
    nothing = replace(
        ping([]), range=np.empty(0), azimuth=np.empty(0), range_standard_deviation=1.0
    )
    for positions in (np.empty((0, 2)), np.full((3, 2), np.nan)):
        (only,) = contact_markers(nothing, positions).markers
        assert only.action == Marker.DELETEALL


SQUARES = np.diag([100.0, 25.0])
"""Of standard deviations of 10 m and 5 m."""


def gates(
    covariance: np.ndarray = SQUARES, threshold: float = 10.0, x: float = 1000.0
) -> GateThresholds:
    one = np.ones(1)
    return GateThresholds(
        stamp=STAMP,
        track_id=np.array([3]),
        false_alarm_probability=1e-3 * one,
        threshold=threshold * one,
        resolution_cells=one,
        gate_volume=one,
        predicted_position=np.array([[x, 500.0]]),
        gate_covariance=covariance[None],
        search_false_alarm_probability=1e-3,
        search_threshold=6.9,
        signal_to_noise_ratio_linear=10.0 * one,
        method="as_detected",
    )


def test_a_gate_is_an_outline_of_four_standard_deviations_with_its_threshold() -> None:
    clear, outline, text = gate_markers(gates(), size=50.0).markers
    assert clear.action == Marker.DELETEALL
    assert outline.type == Marker.LINE_STRIP
    points = np.array([(point.x, point.y) for point in outline.points])
    assert points[0] == pytest.approx(points[-1])
    assert np.abs(points - (1000.0, 500.0)).max(axis=0) == pytest.approx((40.0, 20.0), rel=1e-6)
    assert text.text == "10.0 dB"
    assert text.pose.position.x > 1040.0
    assert text.pose.position.y == 500.0


def test_a_gate_lies_as_its_errors_do() -> None:
    turn = np.radians(30.0)
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    turned = gate_markers(gates(rotation @ SQUARES @ rotation.T)).markers[1]
    points = np.array([(point.x, point.y) for point in turned.points]) - (1000.0, 500.0)
    farthest = points[np.argmax(np.hypot(*points.T))]
    assert np.hypot(*farthest) == pytest.approx(40.0)
    assert np.arctan2(farthest[1], farthest[0]) % np.pi == pytest.approx(turn)


@pytest.mark.parametrize("threshold", [np.nan, 0.0, -1.0, np.inf])
def test_an_unknown_threshold_is_not_written(threshold: float) -> None:
    assert [m.ns for m in gate_markers(gates(threshold=threshold)).markers[1:]] == ["gate"]


@pytest.mark.parametrize(
    "unseen",
    [
        gates(np.full((2, 2), np.nan)),
        gates(np.diag([100.0, 0.0])),
        gates(np.diag([-1.0, -1.0])),
        gates(np.diag([2501.0**2, 1.0])),  # four deviations to either side: 20 km
        gates(x=np.nan),
    ],
)
def test_a_gate_that_is_unknown_flat_or_longer_than_any_view_is_left_out(
    unseen: GateThresholds,
) -> None:
    assert len(gate_markers(unseen).markers) == 1
