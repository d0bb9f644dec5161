"""What people read of positions: compass courses, ellipses, sides, and a dash for the unknown."""

from __future__ import annotations

import io

import numpy as np
import pytest
from rich.console import Console, RenderableType

from sonar_tracking.display.position_table import compass_text, position_cells, position_table
from sonar_tracking.display.run_display import LineDisplay, LiveDisplay
from sonar_tracking.display.track_table import GraphState, TrackTable
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import TrackHypothesis, TrackSource
from tests.display.position_pictures import position_tracks

STATE = GraphState("tma", 12.0, 6.0, 1, "running")


def rendered(what: RenderableType) -> str:
    console = Console(width=140, record=True, file=io.StringIO())
    console.print(what)
    return console.export_text()


def test_a_row_is_in_the_units_people_use() -> None:
    """South-west at 5 m/s; standard deviations of 100 m east and 10 m north, times 2.448."""
    tracks = position_tracks(
        0.0,
        [[1500.4, -200.0, -3.0, -4.0]],
        covariance=np.diag([1e4, 100.0, 1.0, 1.0])[None],
        existence_probability=np.array([0.987]),
        observability=np.array([0.25]),
        hypothesis=np.array([TrackHypothesis.LEFT], np.uint8),
        hypothesis_probability=np.array([0.62]),
    )
    assert position_cells(tracks, 0) == (
        *("+1500", "-200", "-", "217", "5.0", "245x24, 090", "0.99", "0.25", "left 62%"),
    )


def test_what_is_not_known_is_a_dash() -> None:
    assert position_cells(position_tracks(0.0, [[np.nan] * 4]), 0) == ("-",) * 9
    assert position_cells(position_tracks(0.0, [[1.0, 2.0, 0.0, 0.0]]), 0)[3] == "-"


def test_heights_have_a_column_where_there_are_any() -> None:
    """Estimated with its deviation, assumed without one."""
    state = [[1.0, 2.0, 0.0, 0.0]]
    assert "height" not in rendered(position_table("tracks", position_tracks(0.0, state)))
    assumed = position_tracks(0.0, state, z=np.array([-45.2]))
    assert position_cells(assumed, 0)[2] == "-45"
    deviation = np.array([12.3])
    estimated = position_tracks(0.0, state, z=np.array([-45.2]), z_standard_deviation=deviation)
    assert "-45±12" in rendered(position_table("tracks", estimated))
    assert "height" in rendered(position_table("tracks", estimated))


def test_what_is_fixed_has_no_course() -> None:
    source = np.array([TrackSource.STATIC], np.uint8)
    tracks = position_tracks(0.0, [[1.0, 2.0, 0.01, 0.0]], source=source)
    assert position_cells(tracks, 0)[3:5] == ("fixed", "0.0")


@pytest.mark.parametrize(
    ("azimuth_deg", "text"), [(90.0, "000"), (0.0, "090"), (-179.9, "270"), (90.4, "000")]
)
def test_courses_are_clockwise_from_north_and_never_360(azimuth_deg: float, text: str) -> None:
    assert compass_text(np.radians(azimuth_deg)) == text


def test_confirmed_tracks_come_first_and_the_rest_is_counted() -> None:
    status = np.array([TrackStatus.TENTATIVE] * 30 + [TrackStatus.CONFIRMED], np.uint8)
    tracks = position_tracks(0.0, [[0.0, 0.0, 1.0, 0.0]] * 31, status=status)
    lines = rendered(position_table("/active/tracks", tracks, most_rows=5)).splitlines()
    assert lines[0].startswith("/active/tracks")
    assert next(line for line in lines if " 31 " in f" {line} ").split()[1] == "confirmed"
    assert "and 26 more" in lines[-1]


def test_positions_join_the_bearings_or_stand_alone() -> None:
    table = TrackTable()
    table.add_positions("/passive/tracks", position_tracks(0.0, [[1.0, 2.0, 3.0, 4.0]]))
    text = rendered(table.render(STATE))
    assert "/passive/tracks" in text and "bearing deg" not in text
    table.add_positions("/active/tracks", position_tracks(0.0, []))
    assert rendered(table.render(STATE)).index("/active") < text.index("/passive") + 500
    assert "bearing deg" in rendered(TrackTable().render(STATE))


def test_displays_take_positions_of_any_topic() -> None:
    status = np.array([TrackStatus.CONFIRMED, TrackStatus.TENTATIVE], np.uint8)
    tracks = position_tracks(0.0, [[1234.0, 2.0, 3.0, 4.0]] * 2, status=status)
    for make, expected in ((LineDisplay, "1 in /active/tracks"), (LiveDisplay, "+1234")):
        console = Console(width=140, record=True, file=io.StringIO())
        with make(console) as display:
            display.position_tracks("/active/tracks", tracks)
            display.due(100.0)
            display.show(STATE, 100.0)
        assert expected in console.export_text()
