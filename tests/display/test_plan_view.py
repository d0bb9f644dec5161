"""The plan view of the terminal: north up, east right, everything inside."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from sonar_tracking.display.plan_view import COLUMNS, ROWS, PlanView
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import TrackSource
from tests.display.position_pictures import position_tracks


def lines_of(view: PlanView) -> list[str]:
    return view.render().plain.splitlines()[1:]


def place_of(lines: list[str], name: str) -> tuple[int, int]:
    return next((row, line.index(name)) for row, line in enumerate(lines) if name in line)


def test_north_is_up_and_east_is_right() -> None:
    view = PlanView()
    states = [[0.0, 900.0, 0.0, 0.0], [800.0, 0.0, 0.0, 0.0], [-800.0, 0.0, 0.0, 0.0]]
    view.add("/active/tracks", position_tracks(0.0, states))
    lines = lines_of(view)
    (north, _), (east, right), (west, left) = (place_of(lines, name) for name in "123")
    assert north < east == west and left < right
    assert place_of(lines, "+")[0] == east


def test_the_past_is_a_trail_until_data_begin_again() -> None:
    view = PlanView()
    for time in range(5):
        view.add("/tracks", position_tracks(time, [[100.0 * time, 500.0, 0.0, 0.0]]))
    assert sum(line.count(".") for line in lines_of(view)) == 4
    view.add("/tracks", position_tracks(0.0, [[0.0, 500.0, 0.0, 0.0]]))
    assert sum(line.count(".") for line in lines_of(view)) == 0


coordinates = st.floats(-1e6, 1e6)


@given(st.lists(st.tuples(coordinates, coordinates), min_size=1, max_size=6))
def test_every_track_is_inside(places: list[tuple[float, float]]) -> None:
    view = PlanView()
    view.add("/tracks", position_tracks(0.0, [[*place, 0.0, 0.0] for place in places]))
    lines = lines_of(view)
    assert len(lines) == ROWS and {len(line) for line in lines} == {COLUMNS}
    # Two tracks in one cell show the later one.
    assert str(len(places)) in "".join(lines)


def test_without_an_established_track_there_is_no_picture() -> None:
    view = PlanView()
    assert view.render().plain == ""
    status = np.array([TrackStatus.TENTATIVE, TrackStatus.CONFIRMED], np.uint8)
    view.add("/tracks", position_tracks(0.0, [[1.0] * 4, [np.nan] * 4], status=status))
    assert view.render().plain == ""


def test_what_is_fixed_is_no_ship() -> None:
    view = PlanView()
    source = np.array([TrackSource.ACTIVE, TrackSource.STATIC], np.uint8)
    places = [[1000.0, 0.0, 1.0, 0.0], [0.0, 1000.0, 0.0, 0.0]]
    view.add("tracks", position_tracks(0.0, places, source=source))
    lines = lines_of(view)
    assert sum(line.count("#") for line in lines) == 1
    assert place_of(lines, "#")[0] < place_of(lines, "1")[0]
    assert not any("2" in line for line in lines)
