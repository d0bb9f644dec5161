"""Logs of NMEA 0183: alone into a bag, or beside the data of a sensor; and the datum of imports."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sonar_tracking.bags.importers.file_inspection import inspect_file
from sonar_tracking.bags.importers.import_contacts import ContactSensor, import_contacts, read_pings
from sonar_tracking.bags.importers.import_nmea import import_nmea
from sonar_tracking.bags.positions import nmea_log
from sonar_tracking.bags.positions.map_origin import MapOrigin
from sonar_tracking.bags.positions.nmea_log import NmeaLog, read_nmea_log
from sonar_tracking.bags.positions.own_ship_track import checked_coverage, own_ship_at
from sonar_tracking.bags.positions.position_files import read_own_ship
from sonar_tracking.bags.positions.position_tables import own_ship_of_table
from sonar_tracking.bags.storage.bag_records import records_of
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.display.plot_bag import plot_bag
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.geodesy import surface_places, surface_positions
from sonar_tracking.records.datum import Datum, datum_of
from sonar_tracking.records.time import NANOSECONDS
from tests.bags.nmea.nmea_scene import (
    ANCHORED,
    BEGIN,
    DATUM,
    FERRY,
    OWN_VELOCITY,
    gga,
    hdt,
    log_lines,
    rmc,
    vdm,
)

START = round(BEGIN.timestamp()) * NANOSECONDS
SENSOR = ContactSensor(range_deviation=5.0, bearing_deviation_deg=2.0)


def written(folder: Path, name: str, lines: list[str]) -> Path:
    path = folder / name
    path.write_text("\r\n".join(lines))
    return path


def test_own_ship_and_ships_come_out_where_they_were(tmp_path: Path) -> None:
    log = written(tmp_path, "log.nmea", log_lines())
    said = import_nmea([log], tmp_path / "bag", DATUM)
    assert "120 positions of own ship and 2 ships by AIS over 119.0 s" in said
    bag = read_bag(tmp_path / "bag")
    assert bag.recording is not None
    assert datum_of(bag.recording.scenario, "bag") == DATUM
    states = list(records_of(bag, "/own_ship/odometry"))
    for state in states:
        elapsed = (state.stamp - START) * 1e-9
        expected = (OWN_VELOCITY[0] * elapsed, OWN_VELOCITY[1] * elapsed)
        assert state.position == pytest.approx(expected, abs=0.01)
        assert state.velocity[0] == pytest.approx(np.hypot(*OWN_VELOCITY), abs=0.01)
        assert state.velocity[1] == pytest.approx(0.0, abs=0.01)
    pictures = list(records_of(bag, "/truth/tracks"))
    assert bag.topics["/truth/tracks"].role == "truth"
    ferry = [p.state[p.id.tolist().index(FERRY.mmsi)] for p in pictures if FERRY.mmsi in p.id]
    assert len(ferry) == 111  # from the report at 0 s to that at 110 s
    for second, state in enumerate(ferry):
        assert state[:2] == pytest.approx(FERRY.at(second), abs=0.5)  # reports are to 0.2 m
        assert state[2:] == pytest.approx(FERRY.velocity, abs=0.06)  # and to 0.1 kn
    assert sum(ANCHORED.mmsi in p.id for p in pictures) == 1


def test_own_ship_alone_is_a_bag_that_can_be_opened(tmp_path: Path) -> None:
    log = written(tmp_path, "log.nmea", log_lines(20, ships=()))
    assert "20 positions of own ship over" in import_nmea([log], tmp_path / "bag")
    assert len(list(records_of(read_bag(tmp_path / "bag"), "/own_ship/odometry"))) == 20
    drawn = plot_bag(tmp_path / "bag", tmp_path / "pictures")
    assert "tactical_plot.png" in {path.name for path in drawn}


def test_contacts_take_own_ship_and_truth_of_one_log(tmp_path: Path) -> None:
    log = written(tmp_path, "log.nmea", log_lines())
    begin = BEGIN.timestamp()
    rows = [f"{begin + t},1000,45" for t in range(10, 60, 10)]
    contacts = written(tmp_path, "contacts.csv", ["unix_time_s,range_m,bearing_deg", *rows])
    said = import_contacts(contacts, tmp_path / "bag", SENSOR, log, log)
    assert "truth of 2 targets" in said or "truth of 1 targets" in said
    assert said.count("no --datum") == 1
    recorded = read_pings(contacts, SENSOR, log, log, MapOrigin(DATUM))
    own = recorded.own_ship
    assert own.position[1] == pytest.approx([100.0, 40.0], abs=0.01)
    assert own.velocity[1] == pytest.approx(OWN_VELOCITY, abs=0.01)
    truth = recorded.truth[1]
    row = truth.id.tolist().index(FERRY.mmsi)
    assert truth.position[row] == pytest.approx(FERRY.at(20.0), abs=0.5)


def test_a_log_without_a_date_takes_that_of_the_epoch_and_says_so(tmp_path: Path) -> None:
    log = written(tmp_path, "log.nmea", [gga(t, (0.0, 0.0)) for t in range(5)])
    epoch = 1_777_593_600 * NANOSECONDS  # 2026-05-01
    surveyed, notes = read_own_ship(log, epoch)
    assert surveyed.stamp.tolist() == [START + t * NANOSECONDS for t in range(5)]
    assert any("no date (RMC or ZDA)" in note and "--epoch" in note for note in notes)
    assert any("5 of 5 positions come without a heading" in note for note in notes)


def test_what_is_damaged_is_counted_by_kind(tmp_path: Path) -> None:
    lines = log_lines(20)
    noise = ["$GPGGA,1235", "\x00\x81noise", "$GPHDT,1.0,T*00", "$GPGSV,1,1,00*79"]
    part = "!AIVDM,2,1,6,A,55MwgS`00001L@?;OK8<P58hE>0b0<Dp4>22220l1@:44vT4,0*6B"
    log = written(tmp_path, "log.nmea", [*lines, *(noise * 5), hdt(3.0), part])
    surveyed, notes = read_own_ship(log, START)
    told = "\n".join(notes)
    assert len(surveyed.stamp) == 20
    assert "and 2 more: the sentence has no checksum" in told
    assert "and 2 more: no sentence" in told and "and 2 more: the checksum is wrong" in told
    assert "sentences of other kinds are not used: 5 GSV" in told
    assert "1 AIS messages are not whole: the log ends before their last part" in told


@pytest.mark.slow
@pytest.mark.parametrize("end", [b"\n", b"\r\n", b"\r"])
def test_lines_have_the_numbers_an_editor_shows(tmp_path: Path, end: bytes) -> None:
    lines = [line.encode("ascii") for line in log_lines(600)]
    lines[3:3] = [b"", b"noise"]
    lines[1500] = b"more noise" * 3
    log = tmp_path / "log.nmea"
    log.write_bytes(end.join(lines))
    assert log.stat().st_size > 100_000
    assert any("lines 5 and 1501: no sentence" in note for note in read_nmea_log(log).wrong)


def test_logs_that_tell_nothing_are_refused(tmp_path: Path) -> None:
    only_heading = written(tmp_path, "heading.nmea", [hdt(1.0), hdt(2.0)])
    with pytest.raises(ConfigurationError, match="no GGA or RMC"):
        read_own_ship(only_heading, START)
    with pytest.raises(ConfigurationError, match="neither own ship"):
        import_nmea([only_heading], tmp_path / "bag")
    bare = written(tmp_path, "bare.nmea", [line.partition("*")[0] for line in log_lines(5)])
    with pytest.raises(ConfigurationError, match=r"no sentence of NMEA 0183.* has no checksum"):
        inspect_file(bare)
    timeless = written(tmp_path, "ais.nmea", [vdm(FERRY, t) for t in range(5)])
    with pytest.raises(ConfigurationError, match="before any date and time were known"):
        import_nmea([timeless], tmp_path / "bag")
    assert not (tmp_path / "bag").exists()


@pytest.mark.slow
def test_logs_that_follow_are_one_track(tmp_path: Path) -> None:
    """Three of a day, the last without its begin, two with some seconds of the one before."""
    lines = log_lines(100)
    at = [index for index, line in enumerate(lines) if "GGA" in line]
    folder = tmp_path / "logs"
    folder.mkdir()
    for name, begin, end in (("1", 0, 40), ("2", 35, 50), ("10", 70, None)):
        last = None if end is None else at[end]
        written(folder, f"{name}.nmea", lines[at[begin] : last])
    (folder / "README.txt").write_text("logs of a day")
    said = import_nmea([folder], tmp_path / "bag", DATUM)
    assert "80 positions of own ship and 2 ships by AIS over 99.0 s" in said
    assert "README.txt holds no sentence" in said and "It is left out." in said
    assert "1 overlap between files of own ship" in said
    assert "4 s (5 positions) of " in said and "2.nmea" in said
    assert "has no position for 21 s from 2026-05-02 00:00:19 UTC" in said
    told = inspect_file(folder)
    assert "a directory of 3 files" in told and "1.nmea: an NMEA 0183 log" in told
    assert f"import nmea {folder} --output bag" in told and "README.txt" in told
    states = list(records_of(read_bag(tmp_path / "bag"), "/own_ship/odometry"))
    for state in states:
        elapsed = (state.stamp - START) * 1e-9
        expected = (OWN_VELOCITY[0] * elapsed, OWN_VELOCITY[1] * elapsed)
        assert state.position == pytest.approx(expected, abs=0.01)
    ferry = [
        p.state[p.id.tolist().index(FERRY.mmsi)][:2]
        for p in records_of(read_bag(tmp_path / "bag"), "/truth/tracks")
        if FERRY.mmsi in p.id
    ]
    assert len(ferry) == 91 and ferry[60] == pytest.approx(FERRY.at(60.0), abs=0.5)


def test_tables_and_logs_follow_one_another_and_two_ships_do_not(tmp_path: Path) -> None:
    log = written(tmp_path, "a.nmea", log_lines(20, ships=()))
    rows = [f"{BEGIN.timestamp() + t},{5 * t},{2 * t},90" for t in range(15, 40)]
    heads = "unix_time_s,east_m,north_m,heading_deg"
    table = written(tmp_path, "b.csv", [heads, *rows])
    surveyed, notes = read_own_ship([table, log], START, MapOrigin(DATUM))
    assert len(surveyed.stamp) == 40 and surveyed.source == f"{log} and 1 more"
    np.testing.assert_allclose(surveyed.position[:, 0], 5.0 * np.arange(40), atol=0.01)
    assert sum("overlap" in note for note in notes) == 1
    other = written(tmp_path, "b.csv", [heads, *(row.replace(",90", "00,90") for row in rows)])
    _, notes = read_own_ship([table, other, log], START, MapOrigin(DATUM))
    assert any("check that all are of one ship" in note for note in notes)


@pytest.mark.slow
def test_logs_without_a_date_are_of_days_that_follow(tmp_path: Path) -> None:
    logs = [
        written(
            tmp_path, f"{day}.nmea", [gga(30.0 + 60 * t, (0.0, 0.0)) for t in range(0, 1439, 9)]
        )
        for day in range(3)
    ]
    surveyed, notes = read_own_ship(logs, START)
    assert len(surveyed.stamp) == 3 * 160
    assert surveyed.stamp[160] - surveyed.stamp[0] == 86_400 * NANOSECONDS
    assert surveyed.stamp[320] - surveyed.stamp[160] == 86_400 * NANOSECONDS
    assert sum("no date (RMC or ZDA)" in note for note in notes) == 3


def test_a_heading_ahead_of_the_first_position_is_of_it(tmp_path: Path) -> None:
    lines = [hdt(10.0), hdt(20.0), *(rmc(t, (5.0 * t, 0.0), (5.0, 0.0)) for t in range(100))]
    surveyed, notes = read_own_ship(written(tmp_path, "a.nmea", lines), START, MapOrigin(DATUM))
    assert np.degrees(surveyed.azimuth[0]) == pytest.approx(70.0, abs=0.01)
    assert any("95 of 100 positions come without a heading" in note for note in notes)
    motion = own_ship_at(surveyed, surveyed.stamp)
    assert np.degrees(motion.azimuth[[5, 50, 99]]) == pytest.approx([70.0, 70.0, 0.0], abs=0.1)
    (told,) = checked_coverage(surveyed, surveyed.stamp)
    assert "has no heading at 35 of 100 positions for longer than 60 s" in told


def test_a_log_that_is_own_ship_and_truth_is_read_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    log = written(tmp_path, "log.nmea", log_lines())
    rows = [f"{BEGIN.timestamp() + t},1000,45" for t in range(10, 60, 10)]
    contacts = written(tmp_path, "contacts.csv", ["unix_time_s,range_m,bearing_deg", *rows])
    read: list[Path] = []

    def counted(path: Path) -> NmeaLog:
        read.append(path)
        return read_nmea_log(path)

    monkeypatch.setattr(nmea_log, "read_nmea_log", counted)
    assert "truth of" in import_contacts(contacts, tmp_path / "bag", SENSOR, log, log)
    assert read == [log]


def test_a_table_of_latitudes_is_the_same_track(tmp_path: Path) -> None:
    positions = np.array([[0.0, 0.0], [35_000.0, 35_000.0], [-49_000.0, 3_000.0]])
    places = surface_places(positions, DATUM)
    rows = [f"{t},{la:.9f},{lo:.9f}" for t, (la, lo) in enumerate(places.tolist())]
    table = written(tmp_path, "own.csv", ["time_s,latitude_deg,longitude_deg", *rows])
    surveyed, _ = own_ship_of_table(table, START, MapOrigin(DATUM))
    np.testing.assert_allclose(surveyed.position, positions, atol=0.01)
    back = surface_places(surveyed.position, DATUM)
    np.testing.assert_allclose(
        surface_positions(back[:, 0], back[:, 1], DATUM), positions, atol=0.01
    )
    first = MapOrigin()
    surveyed, _ = own_ship_of_table(table, START, first)
    assert surveyed.position[0] == pytest.approx([0.0, 0.0], abs=0.01)
    assert first.datum is not None and "the first place in" in first.notes[0]


def test_metres_and_places_go_together_by_a_datum_alone(tmp_path: Path) -> None:
    contacts = written(
        tmp_path, "contacts.csv",
        ["time_s,range_m,bearing_deg,own_east_m,own_north_m", "0,100,1,0,0", "9,100,1,5,0"],
    )  # fmt: skip
    truth = written(
        tmp_path, "truth.csv",
        ["time_s,target,latitude_deg,longitude_deg", "0,a,54.181,7.89", "9,a,54.182,7.89"],
    )  # fmt: skip
    with pytest.raises(ConfigurationError, match=r"give --datum .* of it"):
        read_pings(contacts, SENSOR, None, truth)
    recorded = read_pings(contacts, SENSOR, None, truth, MapOrigin(DATUM))
    assert recorded.truth[0].position[0] == pytest.approx([0.0, 111.3], abs=0.1)
    with pytest.raises(ConfigurationError, match="km from the datum"):
        read_pings(contacts, SENSOR, None, truth, MapOrigin(Datum(10.0, 7.89)))


def test_half_a_position_is_refused(tmp_path: Path) -> None:
    table = written(tmp_path, "own.csv", ["time_s,latitude_deg,east_m", "0,1,2"])
    with pytest.raises(ConfigurationError, match="give east_m and north_m, or latitude_deg"):
        own_ship_of_table(table, START, MapOrigin())
