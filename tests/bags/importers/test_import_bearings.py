"""Bearings of a file must come out of the bag with their angles, tracks, lines and places."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sonar_tracking.bags.importers.bearing_association import associate_bearings
from sonar_tracking.bags.importers.bearings_of_sensor import BearingSensor
from sonar_tracking.bags.importers.import_bearings import (
    BearingSources,
    import_bearings,
    sensor_topics,
)
from sonar_tracking.bags.storage.bag_records import records_of
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.records.bearings import AngleKind, TrackStatus

SENSOR = BearingSensor(bearing_deviation_deg=0.5)
OWN_SHIP = "time_s,east_m,north_m,heading_deg\n0,0,0,90\n10,50,0,90\n"


def settings(topics: list[tuple[str, str]]) -> Mapping[str, Mapping[str, Any]]:
    return {}


def imported(folder: Path, text: str, **files: str) -> tuple[dict[str, list[Any]], str]:
    """Return the records of each topic of bearings and lines, and what was said."""
    paths = {}
    for name, content in {"bearings": text, **files}.items():
        paths[name] = folder / f"{name}.csv"
        paths[name].write_text(content)
    sources = BearingSources(paths.get("stations"), paths.get("own_ship"), paths.get("truth"))
    said = import_bearings(paths["bearings"], folder / "bag", SENSOR, sources, settings)
    bag = read_bag(folder / "bag")
    names = [name for name in bag.topics if "/passive/" in name]
    return {name: list(records_of(bag, name)) for name in names}, said


@pytest.mark.parametrize(
    ("column", "angle", "expected", "kind"),
    [
        ("bearing_deg", 30.0, 60.0, AngleKind.AZIMUTH),
        ("azimuth_deg", 30.0, 30.0, AngleKind.AZIMUTH),
        ("relative_bearing_deg", 30.0, -30.0, AngleKind.AZIMUTH),  # bow east
        ("cone_angle_deg", 30.0, 60.0, AngleKind.CONE),
        ("arrival_angle_deg", 30.0, 30.0, AngleKind.CONE),
    ],
)
def test_every_kind_of_angle_comes_out_right(
    tmp_path: Path, column: str, angle: float, expected: float, kind: AngleKind
) -> None:
    text = f"time_s,{column},track\n0,{angle},a\n10,{angle},a\n"
    records, _ = imported(tmp_path, text, own_ship=OWN_SHIP)
    first, last = records["/passive/bearing_tracks"]
    assert np.degrees(first.measurement) == pytest.approx([expected])
    assert first.angle_kind is kind and bool(first.ambiguous[0]) is (kind is AngleKind.CONE)
    assert last.sensor.position == (50.0, 0.0, 0.0)
    assert last.sensor.velocity[0] == pytest.approx(5.0)
    assert first.next_stamp == last.stamp


def test_labels_are_tracks_coasted_where_they_are_not_heard(tmp_path: Path) -> None:
    text = "time_s,azimuth_deg,track\n0,10,a\n0,50,b\n5,11,a\n10,12,a\n10,52,b\n10,99,b\n"
    records, said = imported(tmp_path, text, own_ship=OWN_SHIP)
    pictures = records["/passive/bearing_tracks"]
    assert [each.id.tolist() for each in pictures] == [[1, 2]] * 3
    assert pictures[1].status.tolist() == [TrackStatus.CONFIRMED, TrackStatus.COASTED]
    assert np.isnan(pictures[1].measurement[1])
    assert np.degrees(pictures[2].measurement) == pytest.approx([12.0, 52.0])
    assert "1 bearings of a track that has another one" in said


def test_lines_keep_their_identity(tmp_path: Path) -> None:
    text = (
        "time_s,azimuth_deg,track,frequency_hz\n0,10,a,50\n0,10,a,120\n5,11,a,50.1\n"
        "5,40,b,50\n10,12,a,\n"
    )
    records, _ = imported(tmp_path, text, own_ship=OWN_SHIP)
    first, second, third = records["/passive/frequency_lines"]
    assert first.line_id.tolist() == [1, 2] and first.track_id.tolist() == [1, 1]
    assert second.line_id.tolist() == [1, 3] and second.track_id.tolist() == [1, 2]
    assert second.frequency.tolist() == [50.1, 50.0] and len(third.line_id) == 0


@pytest.mark.slow
def test_two_stations_follow_what_both_see_in_clutter(tmp_path: Path) -> None:
    generator = np.random.default_rng(3)
    places = {"west 1": np.array([-500.0, 0.0]), "2": np.array([500.0, 100.0])}
    lines = ["time_s,sensor,bearing_deg"]
    for time in range(60):
        targets = np.array([[-800.0 + 4.0 * time, 1500.0], [900.0, 800.0 + 3.0 * time]])
        for name, place in places.items():
            seen = targets[generator.random(2) < 0.85] - place
            angles = np.degrees(np.arctan2(*seen.T)) + generator.normal(0.0, 0.5, len(seen))
            clutter = generator.uniform(-180.0, 180.0, generator.poisson(2))
            lines += [f"{time},{name},{angle:.3f}" for angle in (*angles, *clutter)]
    stations = "sensor,east_m,north_m\nwest 1,-500,0\n2,500,100\n"
    records, said = imported(tmp_path, "\n".join(lines), stations=stations)
    assert said.count(" 2 tracks") == 2
    for name, topic in (("west 1", "west_1"), ("2", "sensor_2")):
        picture = records[f"/{topic}/passive/bearing_tracks"][-1]
        assert picture.sensor.position[:2] == tuple(places[name])
        azimuth = np.sort(np.degrees(np.arctan2(*(targets - places[name]).T[::-1])))
        assert np.sort(np.degrees(picture.arrival_angle)) == pytest.approx(azimuth, abs=1.0)


@pytest.mark.slow
def test_clicks_of_sources_that_cross_are_told_apart_in_clutter() -> None:
    generator = np.random.default_rng(8)
    times = np.sort(generator.uniform(0.0, 300.0, 600))
    source = generator.integers(0, 4, 600)  # the last is clutter, one bearing a look
    angles = np.stack([-0.5 + 2e-3 * times, 0.5 - 1.5e-3 * times, 2.0 + 0.0 * times], axis=1)
    true = np.append(angles, generator.uniform(-np.pi, np.pi, (600, 1)), axis=1)
    measured = true[np.arange(600), source] + generator.normal(0.0, 0.005, 600)
    number = associate_bearings(
        (1e9 * times).astype(np.int64) + 10**18, measured, np.full(600, 0.005)
    )
    real = source < 3
    assert (number[real] > 0).mean() > 0.95 and (number[~real] > 0).mean() < 0.1
    right = sum(np.bincount(source[number == k]).max() for k in range(1, number.max() + 1))
    assert right / np.sum(number > 0) > 0.95
    assert number.max() <= 6


@pytest.mark.parametrize(
    ("text", "files", "words"),
    [
        ("time_s,sensor,bearing_deg\n0,a,1\n0,b,2\n", {}, "a, b .* is, is not told"),
        ("time_s,relative_bearing_deg\n0,1\n", {}, "faces is not known"),
        ("time_s,cone_angle_deg\n0,181\n", {}, "not between 0 and 180"),
        ("time_s,range_m\n0,1\n", {}, "exactly one"),
        (
            "time_s,sensor,bearing_deg\n0,a,1\n",
            {"stations": "sensor,east_m,north_m\na,0,0\na,5,5\n"},
            "there twice",
        ),
        (
            "time_s,bearing_deg\n100,1\n200,2\n",
            {"own_ship": OWN_SHIP},
            "do not overlap",
        ),
    ],
)
def test_what_cannot_work_is_refused(
    tmp_path: Path, text: str, files: dict[str, str], words: str
) -> None:
    with pytest.raises(ConfigurationError, match=words):
        imported(tmp_path, text, **files)
    assert not (tmp_path / "bag").exists()


def test_names_of_sensors_become_names_of_topics() -> None:
    topics = sensor_topics(["a b", "a-b", "7"])
    assert [bearings for bearings, _ in topics.values()] == [
        "/a_b/passive/bearing_tracks",
        "/a_b_2/passive/bearing_tracks",
        "/sensor_7/passive/bearing_tracks",
    ]
