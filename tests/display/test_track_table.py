"""What people watch: right numbers, right signs, nothing that breaks on odd data."""

import dataclasses
import io

import numpy as np
from rich.console import Console

from sonar_tracking.display.run_display import LineDisplay, LiveDisplay
from sonar_tracking.display.track_table import (
    PICTURE_COLUMNS,
    GraphState,
    TrackTable,
    bearing_time_picture,
)
from sonar_tracking.records.bearings import BearingTracks, TrackStatus

SECOND = 1_000_000_000
STATE = GraphState("doa_fusion", 12.0, 6.0, 1, "running")


def tracks(stamp: int, degrees: list[float], ids: list[int]) -> BearingTracks:
    n = len(degrees)
    return BearingTracks(
        stamp=stamp,
        id=np.array(ids, dtype=np.uint64),
        status=np.full(n, TrackStatus.CONFIRMED, dtype=np.uint8),
        arrival_angle=np.radians(degrees),
        arrival_angle_rate=np.radians(np.full(n, -0.5)),
        covariance=np.tile(np.diag([np.radians(0.25) ** 2, 1e-6]), (n, 1, 1)),
        measurement=np.full(n, np.nan),
        measurement_variance=np.full(n, np.nan),
        innovation=np.full(n, np.nan),
        signal_to_noise_ratio=np.array([10.0, *[np.nan] * (n - 1)])[:n],
        existence_probability=np.full(n, np.nan),
        ambiguous=np.ones(n, dtype=np.bool_),
    )


def rendered(table: TrackTable) -> str:
    console = Console(width=120, record=True, file=io.StringIO())
    console.print(table.render(STATE))
    return console.export_text()


def test_a_row_shows_degrees_decibels_and_age() -> None:
    table = TrackTable()
    table.add(tracks(10 * SECOND, [-30.0], [7]))
    table.add(tracks(13 * SECOND, [-30.5, 12.25], [7, 8]))
    text = rendered(table)
    row = next(line for line in text.splitlines() if "-30.50" in line)
    assert row.replace("│", " ").split() == [
        *("7", "confirmed", "-30.50", "-0.50", "0.25", "+10.0", "3"),
    ]
    assert "+12.25" in text and " - " in text
    assert "doa_fusion" in text and "2.0 x real time" in text and "running" in text


def test_an_empty_table_and_data_that_begin_again() -> None:
    table = TrackTable()
    assert "track" in rendered(table)
    table.add(tracks(100 * SECOND, [0.0], [1]))
    table.add(tracks(5 * SECOND, [0.0], [1]))
    row = next(line for line in rendered(table).splitlines() if "+0.00" in line)
    assert row.split("│")[-1].strip() == "0"


def test_the_picture_has_the_newest_line_on_top_and_positive_bearings_right() -> None:
    picture = bearing_time_picture([tracks(0, [0.0], [1]), tracks(SECOND, [90.0, -90.0], [2, 37])])
    lines = picture.plain.splitlines()
    assert lines[1][0] == "1" and lines[1][-1] == "2"
    assert lines[2][PICTURE_COLUMNS // 2] == "1"


def test_a_bearing_that_is_not_a_number_is_left_out() -> None:
    unknown = dataclasses.replace(tracks(0, [1.0], [1]), arrival_angle=np.array([np.nan]))
    lines = bearing_time_picture([unknown]).plain.splitlines()
    assert set(lines[1]) == {" ", "."}
    table = TrackTable()
    table.add(unknown)
    assert "nan" not in rendered(table)


def test_displays_print_markup_as_it_is_and_keep_their_pace() -> None:
    for make in (LineDisplay, LiveDisplay):
        console = Console(width=120, record=True, file=io.StringIO())
        with make(console) as display:
            display.tracks(tracks(0, [1.0], [1]))
            display.say("a [/bracket]")
            display.due(100.0)
            display.show(STATE, 100.0)
            assert not display.due(100.01)
            assert display.due(200.0)
        assert "a [/bracket]" in console.export_text()
