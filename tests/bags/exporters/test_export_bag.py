"""Protects exports: every row with its numbers, places from the datum, charts others can read."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from sonar_tracking.bags.contents.message_definitions import installed_typestore
from sonar_tracking.bags.contents.recording_information import RecordingInformation
from sonar_tracking.bags.exporters.chart_files import KML_NAMESPACE
from sonar_tracking.bags.exporters.export_bag import export_bag
from sonar_tracking.bags.exporters.export_rows import ExportRow
from sonar_tracking.bags.exporters.track_lines import MOST_KEPT, TrackLine
from sonar_tracking.bags.storage.bag_records import COMMANDS_TYPE
from sonar_tracking.bags.storage.writer import new_bag
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.geodesy import surface_positions
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.datum import Datum
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.positions import PositionTracks, TrackSource
from tests.bags.bag_fixtures import EPOCH, SECOND, filled, tracks_cdr
from tests.bags.position_fixtures import (
    BEARINGS,
    ODOMETRY,
    POSITIONS,
    odometry_cdr,
    position_tracks_cdr,
)

HELGOLAND = Datum(54.18, 7.89)
BEGIN = EPOCH
TENTATIVE_ID = 9


def picture(second: int) -> PositionTracks:
    """Return a confirmed ship that runs east at 10 m/s, made of a bearing track, and a guess."""
    return PositionTracks(
        stamp=(BEGIN + second) * SECOND,
        id=np.array([7, TENTATIVE_ID], np.uint64),
        status=np.array([TrackStatus.CONFIRMED, TrackStatus.TENTATIVE], np.uint8),
        source=np.array([TrackSource.FUSED, TrackSource.FUSED], np.uint8),
        state=np.array([[1000.0 + 10.0 * second, 500.0, 10.0, 0.0], [1.0, 2.0, 0.0, 0.0]]),
        covariance=np.stack([np.diag([400.0, 100.0, 1.0, 4.0])] * 2),
        existence_probability=np.array([0.99, np.nan]),
        contributor_track=np.array([0], np.uint32),
        contributor_source=np.array([TrackSource.TMA], np.uint8),
        contributor_id=np.array([3], np.uint64),
        contributor_sensor=("array",),
    )


@pytest.fixture(params=[None, HELGOLAND], ids=["no datum", "datum"])
def bag(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """Return a bag of five seconds with tracks, bearings and own ship."""
    return made_bag(tmp_path / "trip", request.param)


def made_bag(path: Path, datum: Datum | None) -> Path:
    scenario = {"name": "trip"} | ({"datum": datum.to_mapping()} if datum else {})
    with new_bag(path, RecordingInformation(scenario)) as writer:
        writer.add_topic("/tracks", POSITIONS, role="output")
        writer.add_topic("/passive/bearing_tracks", BEARINGS, role="output")
        writer.add_topic("/own_ship/odometry", ODOMETRY, role="input")
        for second in range(5):
            stamp = (BEGIN + second) * SECOND
            state = OwnShipState(stamp, (0.0, 5.0 * second), np.pi / 2, (5.0, 0.0), 0.0)
            writer.write("/own_ship/odometry", stamp, odometry_cdr(state))
            writer.write("/passive/bearing_tracks", stamp, tracks_cdr(second))
            writer.write("/tracks", stamp, position_tracks_cdr(picture(second)))
    return path


def table(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_a_table_has_every_row_with_its_numbers(bag: Path, tmp_path: Path) -> None:
    rows = table(export_bag(bag, "csv", tmp_path / "trip.csv"))
    tracks = [row for row in rows if row["topic"] == "/tracks" and row["id"] == "7"]
    assert len(tracks) == 5
    last = tracks[-1]
    assert last["time"] == "2026-01-01T00:00:04.000000Z"
    assert (last["status"], last["source"]) == ("confirmed", "fused")
    assert [float(last[name]) for name in ("x_m", "y_m", "vx_m_s")] == [1040.0, 500.0, 10.0]
    assert (float(last["course_deg"]), float(last["speed_m_s"])) == (90.0, 10.0)
    assert float(last["covariance_x_x"]) == 400.0
    assert float(last["covariance_vy_vy"]) == 4.0
    assert last["contributors"] == "tma:array:3"
    guess = next(row for row in rows if row["id"] == str(TENTATIVE_ID))
    assert (guess["status"], guess["existence_probability"]) == ("tentative", "")
    own = [row for row in rows if row["kind"] == "own_ship"]
    assert [float(row["heading_deg"]) for row in own] == pytest.approx([0.0] * 5, abs=1e-9)
    assert {row["angle_kind"] for row in rows if row["kind"] == "bearing"} <= {"cone"}


def test_places_are_those_of_the_datum(tmp_path: Path) -> None:
    bag = made_bag(tmp_path / "trip", HELGOLAND)
    rows = table(export_bag(bag, "csv", tmp_path / "trip.csv", ["/tracks"]))
    places = np.array([[float(row["latitude_deg"]), float(row["longitude_deg"])] for row in rows])
    expected = np.array([[float(row["x_m"]), float(row["y_m"])] for row in rows])
    assert np.abs(surface_positions(places[:, 0], places[:, 1], HELGOLAND) - expected).max() < 1e-2


def test_without_a_datum_a_table_has_no_places_and_a_chart_is_refused(tmp_path: Path) -> None:
    bag = made_bag(tmp_path / "trip", None)
    rows = table(export_bag(bag, "csv", tmp_path / "trip.csv"))
    assert {row["latitude_deg"] for row in rows} == {""}
    for name in ("geojson", "kml"):
        with pytest.raises(ConfigurationError, match="add --datum LATITUDE,LONGITUDE"):
            export_bag(bag, name, tmp_path / "chart")
    assert not (tmp_path / "chart").exists()
    assert export_bag(bag, "kml", tmp_path / "chart.kml", datum="54.18,7.89").exists()


def test_a_chart_has_one_line_a_target(tmp_path: Path) -> None:
    bag = made_bag(tmp_path / "trip", HELGOLAND)
    chart = json.loads(export_bag(bag, "geojson", tmp_path / "trip.geojson").read_text())
    names = {entry["properties"]["name"]: entry for entry in chart["features"]}
    assert set(names) == {"/tracks 7", "own ship"}
    line = names["/tracks 7"]
    assert line["geometry"]["type"] == "LineString"
    assert len(line["geometry"]["coordinates"]) == len(line["properties"]["times"]) == 5
    longitude, latitude = line["geometry"]["coordinates"][0]
    place = surface_positions(np.array(latitude), np.array(longitude), HELGOLAND)
    np.testing.assert_allclose(place, [1000.0, 500.0], atol=1e-2)
    assert line["properties"]["covariance_x_x"] == 400.0

    kml = ElementTree.parse(export_bag(bag, "kml", tmp_path / "trip.kml")).getroot()
    space = {"k": KML_NAMESPACE}
    marks = kml.findall("k:Document/k:Placemark", space)
    assert {mark.findtext("k:name", namespaces=space) for mark in marks} == set(names)
    text = marks[0].findtext("k:LineString/k:coordinates", namespaces=space)
    assert text is not None and len(text.split()) == 5


@pytest.mark.parametrize("namespace", ["", "/ship_a"])
def test_tracks_have_the_names_operators_gave_them(tmp_path: Path, namespace: str) -> None:
    scenario = {"datum": HELGOLAND.to_mapping()}
    commands = f"{namespace}/operator/commands"
    with new_bag(tmp_path / "trip", RecordingInformation(scenario)) as writer:
        writer.add_topic(f"{namespace}/tracks", POSITIONS, role="output")
        writer.add_topic(commands, COMMANDS_TYPE, role="input")
        for second, name in enumerate(("ferry", "", "Ferry 2")):
            stamp = (BEGIN + second) * SECOND
            command = filled(COMMANDS_TYPE, command=5, topic="tracks", id=7, name=name)
            data = installed_typestore(COMMANDS_TYPE).serialize_cdr(command, COMMANDS_TYPE)
            writer.write(commands, stamp, bytes(data))
            writer.write(f"{namespace}/tracks", stamp, position_tracks_cdr(picture(second)))
    rows = table(export_bag(tmp_path / "trip", "csv", tmp_path / "trip.csv"))
    assert {row["name"] for row in rows if row["id"] == "7"} == {"Ferry 2"}
    assert {row["name"] for row in rows if row["id"] != "7"} == {""}
    chart = json.loads(export_bag(tmp_path / "trip", "geojson", tmp_path / "c.json").read_text())
    assert [entry["properties"]["name"] for entry in chart["features"]] == ["Ferry 2"]
    kml = export_bag(tmp_path / "trip", "kml", tmp_path / "trip.kml").read_text()
    assert "<name>Ferry 2</name>" in kml


def test_a_damaged_bag_gives_what_is_left(tmp_path: Path) -> None:
    bag = made_bag(tmp_path / "trip", HELGOLAND)
    (file,) = bag.glob("*.mcap")
    file.write_bytes(file.read_bytes()[:-200])
    (bag / "metadata.yaml").unlink()
    assert table(export_bag(bag, "csv", tmp_path / "trip.csv"))


@pytest.mark.parametrize(
    ("file_format", "topics", "sentence"),
    [
        ("shp", (), "--format"),
        ("csv", ("/track",), "/tracks"),
        ("kml", ("/passive/bearing_tracks",), "holds nothing that kml can show"),
    ],
)
def test_what_cannot_be_exported_is_said(
    tmp_path: Path, file_format: str, topics: tuple[str, ...], sentence: str
) -> None:
    bag = made_bag(tmp_path / "trip", HELGOLAND)
    with pytest.raises(ConfigurationError, match=sentence):
        export_bag(bag, file_format, tmp_path / "file", topics)


def test_a_file_is_not_overwritten(tmp_path: Path) -> None:
    bag = made_bag(tmp_path / "trip", HELGOLAND)
    (tmp_path / "trip.csv").write_text("mine")
    with pytest.raises(ConfigurationError, match="exists already"):
        export_bag(bag, "csv", tmp_path / "trip.csv")


def test_a_long_track_keeps_its_ends_and_bounded_many_points() -> None:
    line = TrackLine()
    for second in range(5 * MOST_KEPT):
        line.add(ExportRow(second, (0.0, 0.0), (second * 1e-4, 0.0), True))
    line.finish()
    stamps = [stamp for stamp, _, _ in line.points]
    assert len(stamps) <= MOST_KEPT + 1
    assert (stamps[0], stamps[-1]) == (0, 5 * MOST_KEPT - 1)
    assert len(set(np.diff(stamps)[:-1])) == 1


def test_a_track_across_the_meridian_of_180_degrees_is_cut() -> None:
    line = TrackLine()
    for stamp, longitude in enumerate([179.99, 179.999, -179.99]):
        line.add(ExportRow(stamp, (0.0, 0.0), (10.0, longitude), True))
    line.finish()
    assert [len(part) for part in line.parts()] == [2, 1]
