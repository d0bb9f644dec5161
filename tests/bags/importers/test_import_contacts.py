"""Contacts of a file must come out of the bag with their places, instants, own ship and truth."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sonar_tracking.active.contact_tracker import make_contact_tracker
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.bags.contents.message_definitions import installed_typestore
from sonar_tracking.bags.importers.import_contacts import ContactSensor, import_contacts, read_pings
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.message_reading.array_reading import own_ship_from_message
from sonar_tracking.message_reading.contact_reading import contacts_from_message
from sonar_tracking.message_reading.position_reading import position_tracks_from_message
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import TrackSource
from sonar_tracking.records.time import END_OF_DATA
from sonar_tracking.simulation.scenarios.scenario import DEFAULT_EPOCH

SENSOR = ContactSensor(range_deviation=5.0, bearing_deviation_deg=2.0)
SECOND = 1_000_000_000
CONTACTS = """time_s,range_m,bearing_deg,amplitude,own_east_m,own_north_m
0,100,90,12.5,10,0
0,200,0,3,10,0
2,,,,12,0
4,100,180,4,14,0
"""
TRUTH = """time_s,target,east_m,north_m
0,ferry,110,0
4,ferry,118,0
1,boat,0,50
3,boat,0,60
"""


def written(folder: Path, name: str, text: str) -> Path:
    path = folder / name
    path.write_text(text)
    return path


def messages(bag: Path, topic: str) -> list[Any]:
    opened = read_bag(bag)
    type_name = opened.topics[topic].type_name
    store = installed_typestore(type_name)
    return [store.deserialize_cdr(m.data, type_name) for m in opened.messages([topic])]


def test_pings_come_out_as_they_were_written(tmp_path: Path) -> None:
    file = written(tmp_path, "contacts.csv", CONTACTS)
    truth = written(tmp_path, "truth.csv", TRUTH)
    said = import_contacts(file, tmp_path / "bag", SENSOR, truth=truth)
    assert "3 contacts in 3 pings over 4.0 s, truth of 2 targets" in said
    pings = [contacts_from_message(m) for m in messages(tmp_path / "bag", "/active/contacts")]
    assert [ping.stamp for ping in pings] == [DEFAULT_EPOCH + t * SECOND for t in (0, 2, 4)]
    assert [ping.next_stamp for ping in pings] == [pings[1].stamp, pings[2].stamp, END_OF_DATA]
    first, silent, _ = pings
    np.testing.assert_allclose(first.range, [100.0, 200.0])
    np.testing.assert_allclose(first.azimuth, [0.0, np.pi / 2.0], atol=1e-12)
    np.testing.assert_allclose(first.amplitude, [12.5, 3.0])
    np.testing.assert_allclose(first.azimuth_standard_deviation, np.radians(2.0))
    assert len(silent.range) == 0 and silent.ping_interval == 2.0
    assert silent.sensor_position == (12.0, 0.0)
    np.testing.assert_allclose(silent.sensor_velocity, (1.0, 0.0), atol=1e-9)
    assert first.maximum_range == 200.0


def test_own_ship_and_truth_stand_beside_the_pings(tmp_path: Path) -> None:
    file = written(tmp_path, "contacts.csv", CONTACTS)
    truth = written(tmp_path, "truth.csv", TRUTH)
    import_contacts(file, tmp_path / "bag", SENSOR, truth=truth)
    ships = [own_ship_from_message(m) for m in messages(tmp_path / "bag", "/own_ship/odometry")]
    assert [ship.position for ship in ships] == [(10.0, 0.0), (12.0, 0.0), (14.0, 0.0)]
    for ship in ships:  # towards the east: the heading is the course made good
        assert ship.yaw == pytest.approx(0.0, abs=1e-9)
        assert ship.velocity == pytest.approx((1.0, 0.0), abs=1e-9)
    true = [position_tracks_from_message(m) for m in messages(tmp_path / "bag", "/truth/tracks")]
    assert [entry.id.tolist() for entry in true] == [[1], [1, 2], [1]]
    np.testing.assert_allclose(true[1].state, [[114, 0, 2, 0], [0, 55, 0, 5]], atol=1e-9)
    assert all(np.all(entry.source == TrackSource.TRUTH) for entry in true)


@pytest.mark.parametrize("suffix", ["csv", "npz"])
def test_every_line_that_cannot_be_used_is_named(tmp_path: Path, suffix: str) -> None:
    columns = {
        "unix_time_s": [1.6e9, np.nan, 1.6e9, 1.6e9, 1.6e9 + 1, 1.6e9 + 1],
        "range_m": [100.0, 100.0, -5.0, 100.0, 100.0, 120.0],
        "azimuth_deg": [10.0, 10.0, 10.0, np.inf, 10.0, 30.0],
        "amplitude": [1.0, 1.0, 1.0, 1.0, -1.0, 1.0],
        "weather": [0.0] * 6,
    }
    path = tmp_path / f"contacts.{suffix}"
    if suffix == "npz":
        np.savez(path, allow_pickle=False, **{n: np.array(v) for n, v in columns.items()})
        places = [f"entry {index}" for index in range(1, 5)]
    else:
        rows = zip(*columns.values(), strict=True)
        lines = [
            ",".join(columns),
            *(",".join(map(repr, row)) for row in rows),
            "1,2,3",
            "a,1,1,1,0",
        ]
        path.write_text("\n".join(lines))
        places = [f"line {index}" for index in (3, 4, 5, 6, 8, 9)]
    recorded = read_pings(path, SENSOR)
    told = "\n".join(recorded.notes)
    for place in places:
        assert told.count(f"{path}, {place}:") == 1
    assert "weather is not known" in told and "rests at the origin" in told
    assert [len(ping.range) for ping in recorded.pings] == [1, 1]
    np.testing.assert_allclose(recorded.pings[1].azimuth, np.radians(30.0))


def test_relative_bearings_turn_with_own_ship(tmp_path: Path) -> None:
    file = written(
        tmp_path, "contacts.csv", "time_s,range_m,relative_bearing_deg\n0,50,90\n10,50,90\n"
    )
    own = written(tmp_path, "own.csv", "time_s,east_m,north_m,heading_deg\n0,0,0,350\n10,0,50,10\n")
    recorded = read_pings(file, SENSOR, own_ship=own)
    compass = [90.0 - np.degrees(float(ping.azimuth[0])) for ping in recorded.pings]
    np.testing.assert_allclose(compass, [80.0, 100.0])  # starboard of 350 and of 10 degrees
    middle = recorded.own_ship
    np.testing.assert_allclose(middle.turn_rate, -np.radians(2.0))  # to starboard, through north
    assert read_pings(file, SENSOR, own_ship=own).pings[0].sensor_velocity[1] == pytest.approx(5.0)


def test_latency_moves_the_pings_back(tmp_path: Path) -> None:
    file = written(tmp_path, "contacts.csv", CONTACTS)
    late = ContactSensor(range_deviation=5.0, bearing_deviation_deg=2.0, latency=0.5)
    recorded = read_pings(file, late)
    assert recorded.pings[0].stamp == DEFAULT_EPOCH - SECOND // 2
    assert recorded.pings[0].sensor_position[0] == pytest.approx(9.5)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("time_s,range_m\n0,1\n", "exactly one"),
        ("range_m,bearing_deg\n1,1\n", "unix_time_s"),
        ("time_s,bearing_deg\n1,1\n", "no column range_m"),
        ("time_s,range_m,bearing_deg\n", "no usable line"),
        ("time_s,range_m,bearing_deg\n0,x,1\n", "line 2: range_m is 'x', not a number"),
        ("time_s,range_m,bearing_deg,range_m\n0,1,1,1\n", "range_m twice"),
        ("time_s,range_m,relative_bearing_deg\n0,1,1\n", "heading"),
        ("", "no column range_m"),
    ],
)
def test_a_file_that_cannot_be_used_is_refused(tmp_path: Path, text: str, words: str) -> None:
    file = written(tmp_path, "contacts.csv", text)
    with pytest.raises(ConfigurationError, match=words):
        import_contacts(file, tmp_path / "bag", SENSOR)
    assert not (tmp_path / "bag").exists()


def test_errors_of_the_sensor_must_be_known(tmp_path: Path) -> None:
    file = written(tmp_path, "contacts.csv", CONTACTS)
    with pytest.raises(ConfigurationError, match="--range-deviation"):
        read_pings(file, ContactSensor(bearing_deviation_deg=1.0))
    with pytest.raises(ConfigurationError, match="--bearing-deviation-deg"):
        read_pings(file, ContactSensor(range_deviation=1.0))
    with pytest.raises(ConfigurationError, match="cannot be read"):
        read_pings(tmp_path / "nothing.npz", SENSOR)


def test_a_tracker_follows_what_was_imported(tmp_path: Path) -> None:
    generator = np.random.default_rng(2)
    lines = ["time_s,range_m,bearing_deg,own_east_m,own_north_m"]
    for ping in range(12):
        position = np.array([300.0 + 3.0 * ping, 400.0]) - (0.0, 2.0 * ping)
        east, north = position + generator.normal(0.0, 2.0, 2)
        bearing = np.degrees(np.arctan2(east, north))
        lines.append(f"{ping},{np.hypot(east, north):.6f},{bearing:.6f},0,{2 * ping}")
    recorded = read_pings(written(tmp_path, "contacts.csv", "\n".join(lines)), SENSOR)
    tracker = make_contact_tracker(
        ContactTrackerConfiguration(sound_speed=0.0, initial_existence=0.1)
    )
    for contacts in recorded.pings:
        tracks = tracker.update(contacts).tracks
    assert tracks.status.tolist() == [TrackStatus.CONFIRMED]
    np.testing.assert_allclose(tracks.state[0, :2], (333.0, 400.0), atol=8.0)
