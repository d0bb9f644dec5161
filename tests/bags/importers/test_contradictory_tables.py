"""What a table leaves out, contradicts or cannot mean is said in one sentence, or refused."""

from __future__ import annotations

from datetime import datetime, timezone
from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.bags.importers.import_contacts import (
    ContactSensor,
    RecordedPings,
    read_pings,
)
from sonar_tracking.bags.positions.map_origin import MapOrigin
from sonar_tracking.bags.positions.position_files import read_own_ship
from sonar_tracking.bags.positions.position_tables import true_positions_of_table
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.simulation.scenarios.scenario import DEFAULT_EPOCH

SENSOR = ContactSensor(range_deviation=5.0, bearing_deviation_deg=2.0)
SECOND = 1_000_000_000


def pings_of(folder: Path, lines: list[str], own_ship: list[str] | None = None) -> RecordedPings:
    file = folder / "contacts.csv"
    file.write_text("\n".join(lines))
    own = None
    if own_ship is not None:
        own = folder / "own.csv"
        own.write_text("\n".join(own_ship))
    return read_pings(file, SENSOR, own_ship=own)


def run(times: np.ndarray, heading: str = "time_s,range_m,bearing_deg") -> list[str]:
    return [heading, *(f"{time!r},100,90" for time in times.tolist())]


def track(times: np.ndarray) -> list[str]:
    return ["time_s,east_m,north_m", *(f"{time!r},{3 * time!r},0" for time in times.tolist())]


def test_a_track_of_another_year_is_refused(tmp_path: Path) -> None:
    unix = datetime(2019, 5, 1, tzinfo=timezone.utc).timestamp()
    own = ["unix_time_s,east_m,north_m", *(f"{unix + t},{t},0" for t in range(100))]
    with pytest.raises(ConfigurationError, match=r"own.csv lasts from 2019-05-01.*--epoch"):
        pings_of(tmp_path, run(np.arange(100.0)), own)


def test_by_how_much_own_ship_is_extrapolated_is_said(tmp_path: Path) -> None:
    recorded = pings_of(tmp_path, run(np.arange(101.0)), track(np.arange(11.0)))
    (note,) = recorded.notes
    assert "ends 90 s before the data do" in note and "90 % of the run" in note
    covered = pings_of(tmp_path, run(np.arange(101.0)), track(np.arange(0.0, 101.5, 0.5)))
    assert not covered.notes


def test_gaps_and_leaps_of_own_ship_are_said(tmp_path: Path) -> None:
    times = np.concatenate([np.arange(0.0, 50.0), np.arange(400.0, 450.0)])
    recorded = pings_of(tmp_path, run(np.arange(0.0, 440.0, 10.0)), track(times))
    assert any("no position for 351 s" in note for note in recorded.notes)
    leaping = track(np.arange(100.0))
    leaping[50] = "49.0,134000000,0"
    told = pings_of(tmp_path, run(np.arange(99.0)), leaping).notes
    assert any("missing, or no position on earth" in note and "line 51" in note for note in told)
    leaping[50] = "49.0,100000,0"
    told = pings_of(tmp_path, run(np.arange(99.0)), leaping).notes
    assert any("leaps in 2 of 99 steps" in note for note in told)


def test_an_empty_optional_cell_costs_only_itself(tmp_path: Path) -> None:
    lines = [
        "time_s,range_m,bearing_deg,amplitude,range_deviation_m,own_east_m,own_north_m,"
        "own_heading_deg",
        "0,100,90,5,4,0,0,0",
        "1,100,90,,,10,,n/a",
        "2,100,90,5,4,20,0,20",
    ]
    recorded = pings_of(tmp_path, lines)
    assert [len(ping.range) for ping in recorded.pings] == [1, 1, 1]
    assert [len(ping.amplitude) for ping in recorded.pings] == [1, 0, 1]
    deviations = [float(np.ravel(ping.range_standard_deviation)[0]) for ping in recorded.pings]
    assert deviations == [4.0, 5.0, 4.0]
    assert recorded.own_ship.position[1] == pytest.approx((10.0, 0.0))
    assert np.degrees(recorded.own_ship.azimuth) == pytest.approx([90.0, 80.0, 70.0])
    for name in ("amplitude", "range_deviation_m", "own_north_m", "own_heading_deg"):
        assert sum(f"line 3: {name} is empty; " in note for note in recorded.notes) == 1


def test_a_heading_missing_here_and_there_is_taken_from_the_lines_around(tmp_path: Path) -> None:
    file = tmp_path / "own.csv"
    file.write_text("time_s,east_m,north_m,heading_deg\n0,0,0,10\n5,0,0,\n10,0,0,20\n")
    surveyed, notes = read_own_ship(file, DEFAULT_EPOCH)
    assert len(surveyed.stamp) == 3
    assert notes == (f"{file}, line 3: heading_deg is empty; the heading is taken from the "
                     "lines around.",)  # fmt: skip


def test_sentences_of_one_kind_are_counted(tmp_path: Path) -> None:
    lines = run(np.arange(40.0)) + [f"{t},,45" for t in range(26)] + [f"{t},abc,45" for t in (1, 2)]
    recorded = pings_of(tmp_path, lines)
    missing = [note for note in recorded.notes if "range_m is missing" in note]
    assert len(missing) == 1 and "lines 42, 43, 44 and 23 more" in missing[0]
    assert "import bearings" in missing[0]
    wrong = [note for note in recorded.notes if "'abc'" in note]
    assert len(wrong) == 1 and "lines 68 and 69" in wrong[0]


def test_a_ping_outlives_its_contacts(tmp_path: Path) -> None:
    lines = ["time_s,range_m,bearing_deg", "0,100,90", "1,-4,90", "2,100,90"]
    assert [len(ping.range) for ping in pings_of(tmp_path, lines).pings] == [1, 0, 1]


@pytest.mark.parametrize(
    ("column", "factor", "unit"),
    [
        ("unix_time_s", 1e3, "milliseconds"),
        ("time_s", 1e3, "milliseconds"),
        ("unix_time_s", 1e6, "microseconds"),
        ("unix_time_s", 1e9, "nanoseconds"),
        ("time_s", 1.0, "name the column unix_time_s"),
    ],
)
def test_times_of_another_unit_are_refused(
    tmp_path: Path, column: str, factor: float, unit: str
) -> None:
    times = factor * (1.62e9 + np.arange(10.0))
    with pytest.raises(ConfigurationError, match=unit):
        pings_of(tmp_path, run(times, f"{column},range_m,bearing_deg"))


def test_pings_minutes_apart_are_suspected_to_be_milliseconds(tmp_path: Path) -> None:
    notes = pings_of(tmp_path, run(1000.0 * np.arange(10.0))).notes
    assert any("1000 s apart" in note and "divide it by 1000" in note for note in notes)


def test_a_day_goes_on_after_midnight(tmp_path: Path) -> None:
    times = np.array([86398.0, 86399.0, 0.0, 1.0])
    recorded = pings_of(tmp_path, run(times))
    stamps = np.array([ping.stamp for ping in recorded.pings])
    assert np.diff(stamps).tolist() == [SECOND] * 3
    assert any("midnight" in note and "line 4" in note for note in recorded.notes)


def test_lines_out_of_order_are_said(tmp_path: Path) -> None:
    recorded = pings_of(tmp_path, run(np.array([0.0, 2.0, 1.0, 3.0])))
    assert [len(recorded.pings), len({p.stamp for p in recorded.pings})] == [4, 4]
    assert any("line 4: time_s is less than in a line before" in n for n in recorded.notes)


def test_targets_one_after_the_other_are_in_order(tmp_path: Path) -> None:
    file = tmp_path / "truth.csv"
    rows = [f"{t},{name},{t},0" for name in ("a", "b") for t in range(5)]
    file.write_text("\n".join(["time_s,target,east_m,north_m", *rows, "3,b,9,9"]))
    targets, notes = true_positions_of_table(file, DEFAULT_EPOCH, MapOrigin())
    assert [len(each.stamp) for each in targets.values()] == [5, 5]
    assert len(notes) == 2 and all("line 12" in note for note in notes)
    assert "position of this time already" in notes[1]


def test_semicolons_and_decimal_commas_are_read(tmp_path: Path) -> None:
    recorded = pings_of(tmp_path, ["time_s;range_m;bearing_deg", "0,5;100,25;90", "1,5;101;90"])
    assert recorded.pings[0].range[0] == 100.25
    assert recorded.pings[0].stamp == DEFAULT_EPOCH + SECOND // 2
