"""Tables as spreadsheets, loggers and people write them are read, and what was taken is told."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.bags.importers.bearing_file import read_bearing_lines, read_stations
from sonar_tracking.bags.importers.contact_file import CONTACT_COLUMNS, read_contact_lines
from sonar_tracking.bags.positions.map_origin import MapOrigin
from sonar_tracking.bags.positions.position_files import read_own_ship
from sonar_tracking.bags.tables.table_headings import KNOWN
from sonar_tracking.bags.tables.written_angles import written_angle
from sonar_tracking.bags.tables.written_times import written_times
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.records.datum import Datum
from sonar_tracking.records.time import NANOSECONDS
from sonar_tracking.simulation.scenarios.scenario import DEFAULT_EPOCH

NOON = 1_777_636_800 * NANOSECONDS
"""2026-05-01T12:00:00Z."""

SPREADSHEET = (
    "Timestamp;Range [m];Bearing (°);Amplitude\r\n"
    "2026-05-01T14:00:00+02:00;850,5;12,1;14\r\n"
    "2026-05-01T14:00:02.250+02:00;846,25;12,4;11,5;\r\n"
)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
def test_a_spreadsheet_with_decimal_commas_in_any_encoding(tmp_path: Path, encoding: str) -> None:
    path = tmp_path / "contacts.csv"
    path.write_bytes(SPREADSHEET.encode(encoding))
    lines = read_contact_lines(path, DEFAULT_EPOCH)
    assert lines.stamp - NOON == pytest.approx([0.0, 2.25e9], abs=200.0)
    assert lines.range.tolist() == [850.5, 846.25]
    assert lines.amplitude.tolist() == [14.0, 11.5]
    told = " ".join(lines.bad)
    assert "'Range [m]' for range_m, 'Bearing (°)' for bearing_deg" in told
    assert ("cp1252" in told) == (encoding == "cp1252") and "UTC" not in told


@pytest.mark.parametrize(
    ("heads", "cells", "told"),
    [
        ("time", "1777636800.5", "taken for unix_time_s"),
        ("t", "43200.5", "taken for time_s"),
        ("time_s", "2026-05-01 12:00:00.5", "without a zone are taken as UTC"),
        ("date,time", "2026/05/01,12:00:00.5", "'date' and 'time': dates and times without"),
        ("Date,UTC", "01.05.2026,12:00:00.5", "without a zone are taken as UTC"),
        ("datetime", "20260501T12:00:00.5Z", ""),
        ("unix_time", "1777636800.5", "'unix_time' for unix_time_s"),
        ("time", "12:00:00.5", "count from the midnight of --epoch"),
    ],
)
def test_times_as_they_are_written(tmp_path: Path, heads: str, cells: str, told: str) -> None:
    path = tmp_path / "own.csv"
    path.write_text(f"{heads},East,North\n{cells},1,2\n{cells.replace('.5', '.75')},3,4\n")
    midnight = NOON - 43_200 * NANOSECONDS
    surveyed, notes = read_own_ship(path, midnight)
    assert surveyed.stamp - NOON == pytest.approx([0.5e9, 0.75e9], abs=200.0)
    assert told in " ".join(notes)


def test_a_cell_that_is_no_time_costs_its_line_and_is_named(tmp_path: Path) -> None:
    path = tmp_path / "own.csv"
    path.write_text("time,east_m,north_m\n2026-05-01T12:00:00Z,0,0\n2026-13-01T12:00:00Z,1,1\n")
    surveyed, notes = read_own_ship(path, DEFAULT_EPOCH)
    assert len(surveyed.stamp) == 1
    assert "line 3: unix_time_s is '2026-13-01T12:00:00Z', not a number" in " ".join(notes)


@pytest.mark.parametrize(
    ("text", "sides", "angle"),
    [
        ("54°10.8'N", "NS", 54.18),
        ("54 10 48 N", "NS", 54.18),
        ("S54°10'48\"", "NS", -54.18),
        ("7.89 E", "EW", 7.89),
        ("007°53.4′W", "EW", -7.89),
        ("-7 53.4", "EW", -7.89),
        ("54°10.8'E", "NS", None),
        ("54°60.0'N", "NS", None),
        ("54.5 10 N", "NS", None),
        ("north", "NS", None),
    ],
)
def test_angles_as_charts_have_them(text: str, sides: str, angle: float | None) -> None:
    found = written_angle(text, sides)
    assert found is None if angle is None else found == pytest.approx(angle, abs=1e-9)


def test_places_in_degrees_and_minutes(tmp_path: Path) -> None:
    path = tmp_path / "own.csv"
    path.write_text(
        "unix_time_s;Lat;Lon;HDG\n1777636800;54°10,8'N;7°53,4'E;90\n"
        "1777636810;54°10.9'N;7°53.4'E;90\n1777636820;5410.9;7.9;90\n"
    )
    surveyed, notes = read_own_ship(path, DEFAULT_EPOCH, MapOrigin(Datum(54.18, 7.89)))
    assert surveyed.position == pytest.approx(np.array([[0.0, 0.0], [0.0, 185.5]]), abs=0.5)
    assert "line 4" in " ".join(notes) and "not 5410.8 as in NMEA" in " ".join(notes)


def test_columns_between_blanks_under_the_sign_of_a_comment(tmp_path: Path) -> None:
    path = tmp_path / "bearings.txt"
    path.write_text(
        "# of a click detector\n# time_s  bearing_deg  sensor\n0  40.25 west\n2 41 east\n"
    )
    lines = read_bearing_lines(path, DEFAULT_EPOCH)
    assert lines.sensor.tolist() == ["west", "east"]
    path.write_text("sep=;\nStation;East;North\nwest;-500;0\n#later\neast;1\n")
    stations, notes = read_stations(path)
    assert list(stations) == ["west"] and "line 5: 2 values under 3 headings" in " ".join(notes)


def test_what_cannot_be_known_is_refused_with_the_remedy(tmp_path: Path) -> None:
    path = tmp_path / "contacts.csv"
    path.write_text("0,850,12\n1,851,12\n")
    with pytest.raises(ConfigurationError, match="first line holds numbers; write the names"):
        read_contact_lines(path, DEFAULT_EPOCH)
    path.write_text("time_s,range_km,bearing_deg\n0,0.85,12\n")
    with pytest.raises(ConfigurationError, match=r"has no column range_m; it has .* range_km"):
        read_contact_lines(path, DEFAULT_EPOCH)


def test_names_of_the_formats_are_known_and_exact_ones_go_first(tmp_path: Path) -> None:
    assert set(CONTACT_COLUMNS) <= KNOWN
    path = tmp_path / "own.csv"
    path.write_text("time_s,east_m,north_m,east\n0,1,2,9\n")
    surveyed, notes = read_own_ship(path, DEFAULT_EPOCH)
    assert surveyed.position[0].tolist() == [1.0, 2.0]
    assert "column east" in " ".join(notes)
    assert written_times(["", "soon"]) is None
