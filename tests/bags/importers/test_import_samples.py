"""Time series in a WAV file must come out of the bag as they are, and tell where they are."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import wavfile

from sonar_tracking.bags.contents.message_definitions import installed_typestore
from sonar_tracking.bags.importers.audio_recording import GivenTime
from sonar_tracking.bags.importers.import_samples import import_samples, suggested_estimator
from sonar_tracking.bags.storage.bag_records import records_of
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.message_reading.array_reading import own_ship_from_message
from sonar_tracking.message_reading.sample_reading import samples_from_message
from sonar_tracking.records.samples import ArraySamples
from sonar_tracking.records.time import END_OF_DATA
from sonar_tracking.simulation.scenarios.scenario import DEFAULT_EPOCH
from tests.bags.nmea.nmea_scene import BEGIN, DATUM, FERRY, OWN_VELOCITY, log_lines

RATE = 2000
N_ELEMENTS = 4
GEOMETRY = """
sensor_id: towed
n_elements: 4
spacing: 1.0
mounting_x: -10
mounting_yaw_deg: 180
"""
PARAMETERS = {"band_demodulator": {"center_frequency": 300.0, "bandwidth": 20.0}}
OWN_SHIP = "time_s,east_m,north_m,heading_deg\n0,0,0,0\n10,0,50,0\n"
SECOND = 1_000_000_000


def noise(seconds: float = 3.3, channels: int = N_ELEMENTS) -> np.ndarray:
    shape = (round(seconds * RATE), channels)
    return np.random.default_rng(1).normal(size=shape).astype(np.float32)


def imported(
    tmp_path: Path, samples: np.ndarray, geometry: str = GEOMETRY, rate: int = RATE, **options: Any
) -> tuple[list[ArraySamples], str]:
    wavfile.write(tmp_path / "a.wav", rate, samples)
    (tmp_path / "array.yaml").write_text(geometry)
    arguments = {"node_parameters": PARAMETERS, **options}
    said = import_samples(
        tmp_path / "a.wav", tmp_path / "array.yaml", tmp_path / "bag", **arguments
    )
    return [samples_from_message(m) for m in messages(tmp_path / "bag", "/array/samples")], said


def messages(bag: Path, topic: str) -> list[Any]:
    opened = read_bag(bag)
    type_name = opened.topics[topic].type_name
    store = installed_typestore(type_name)
    return [store.deserialize_cdr(m.data, type_name) for m in opened.messages([topic])]


def test_samples_come_out_bit_by_bit_in_contiguous_blocks(tmp_path: Path) -> None:
    samples = noise()
    blocks, said = imported(tmp_path, samples)
    np.testing.assert_array_equal(np.concatenate([block.data for block in blocks]), samples)
    assert [block.stamp for block in blocks] == [
        DEFAULT_EPOCH + index * SECOND // 2 for index in range(7)
    ]
    ends = [block.end_stamp for block in blocks[:-1]]
    assert ends == [block.stamp for block in blocks[1:]]
    assert [block.next_stamp for block in blocks] == [*ends, END_OF_DATA]
    assert {block.sample_rate for block in blocks} == {RATE}
    np.testing.assert_allclose(blocks[0].element_positions[:, 0], range(4))
    assert "6600 samples of 4 elements in 7 blocks, 3.3 s at 2000 Hz" in said
    assert "20 Hz around 300 Hz" in said and "it rests at the origin" in said


def test_channels_are_put_where_the_map_says(tmp_path: Path) -> None:
    samples = noise(channels=6)
    blocks, _ = imported(tmp_path, samples, GEOMETRY + "channels: [6, 1, 3, 2]\n")
    np.testing.assert_array_equal(blocks[0].data, samples[:1000, [5, 0, 2, 1]])


def test_the_array_is_where_own_ship_tows_it(tmp_path: Path) -> None:
    """Northwards at 5 m/s, the array 10 m astern with its first element ahead."""
    (tmp_path / "own.csv").write_text(OWN_SHIP)
    blocks, said = imported(tmp_path, noise(), own_ship=tmp_path / "own.csv")
    sensor = blocks[2].sensor
    assert sensor.position == pytest.approx((0.0, -5.0, 0.0), abs=1e-9)
    assert sensor.velocity == pytest.approx((0.0, 5.0, 0.0), abs=1e-9)
    x, y, z, w = sensor.orientation
    assert 2.0 * np.arctan2(z, w) == pytest.approx(1.5 * np.pi) and x == y == 0.0
    ships = [own_ship_from_message(m) for m in messages(tmp_path / "bag", "/own_ship/odometry")]
    assert len(ships) == len(blocks) + 1
    assert ships[-1].stamp == blocks[-1].end_stamp
    assert ships[2].position == pytest.approx((0.0, 5.0), abs=1e-9)
    assert "rests" not in said


def test_the_bag_says_what_a_replay_starts_and_plays(tmp_path: Path) -> None:
    truth = tmp_path / "truth.csv"
    truth.write_text("time_s,target,arrival_angle_deg\n0,ferry,10\n1,ferry,12\n")
    imported(tmp_path, noise(), truth=truth)
    bag = read_bag(tmp_path / "bag")
    assert bag.recovery is None and bag.recording is not None
    assert bag.recording.node_parameters == PARAMETERS
    assert {name: topic.role for name, topic in bag.topics.items()} == {
        "/array/samples": "input",
        "/own_ship/odometry": "input",
        "/truth/bearing_tracks": "truth",
    }
    times = [message.log_time for message in bag.messages()]
    assert times == sorted(times)


def test_ais_is_the_truth_of_time_series(tmp_path: Path) -> None:
    """Positions as reported; bearings as the array hears them, sound being late."""
    log = tmp_path / "bridge.nmea"
    log.write_text("\n".join(log_lines(40)))
    _, said = imported(
        tmp_path, noise(), own_ship=[log], truth=[log], datum=DATUM,
        time=GivenTime(round(BEGIN.timestamp()) * SECOND + 10 * SECOND),
    )  # fmt: skip
    assert "rests" not in said
    bag = read_bag(tmp_path / "bag")
    assert {name for name, topic in bag.topics.items() if topic.role == "truth"} == {
        "/truth/tracks",
        "/truth/bearing_tracks",
    }
    positions = list(records_of(bag, "/truth/tracks"))
    bearings = messages(tmp_path / "bag", "/truth/bearing_tracks")
    assert len(positions) == len(bearings) == 4
    for second, (picture, heard) in enumerate(zip(positions, bearings, strict=True), start=10):
        row = picture.id.tolist().index(FERRY.mmsi)
        assert picture.state[row, :2] == pytest.approx(FERRY.at(second), abs=0.5)
        ahead = np.array(OWN_VELOCITY) / np.hypot(*OWN_VELOCITY)
        array = second * np.array(OWN_VELOCITY) - 10.0 * ahead
        late = np.hypot(*(FERRY.at(second) - array)) / 1500.0
        away = FERRY.at(second - late) - array
        expected = np.arcsin(-ahead @ away / np.hypot(*away))
        assert heard.arrival_angle[row] == pytest.approx(expected, abs=1e-3)
    rates = np.diff([each.arrival_angle[0] for each in bearings])
    assert bearings[1].arrival_angle_rate[0] == pytest.approx(rates[1], rel=0.05, abs=1e-4)


def test_positions_of_a_table_are_truth_as_well(tmp_path: Path) -> None:
    truth = tmp_path / "truth.csv"
    truth.write_text("time_s,target,east_m,north_m\n0,ferry,500,500\n9,ferry,500,590\n")
    imported(tmp_path, noise(), truth=truth)
    pictures = list(records_of(read_bag(tmp_path / "bag"), "/truth/tracks"))
    assert [tuple(each.state[0]) for each in pictures[:2]] == [
        pytest.approx((500.0, 500.0, 0.0, 10.0)),
        pytest.approx((500.0, 510.0, 0.0, 10.0)),
    ]
    truth.write_text("time_s,target,east_m,north_m\n60,ferry,500,500\n90,ferry,500,590\n")
    with pytest.raises(ConfigurationError, match="they do not overlap"):
        imported(tmp_path, noise(), truth=truth)


def test_blocks_with_samples_that_are_not_numbers_are_left_out_and_told(tmp_path: Path) -> None:
    samples = noise()
    samples[1100:2100, 2] = np.nan
    samples[-1, 0] = np.inf
    blocks, said = imported(tmp_path, samples)
    assert [(block.stamp - DEFAULT_EPOCH) / SECOND for block in blocks] == [0, 1.5, 2, 2.5]
    assert blocks[0].next_stamp == blocks[1].stamp and blocks[-1].next_stamp == END_OF_DATA
    assert "not numbers on channel 3; 0.500 s to 1.500 s were left out" in said
    assert "not numbers on channel 1; 3.000 s to 3.300 s were left out" in said


def test_a_file_that_is_cut_off_is_imported_as_far_as_it_goes_and_told(tmp_path: Path) -> None:
    wavfile.write(tmp_path / "whole.wav", RATE, noise(4.0))
    whole = (tmp_path / "whole.wav").read_bytes()
    (tmp_path / "a.wav").write_bytes(whole[: len(whole) // 2])
    (tmp_path / "array.yaml").write_text(GEOMETRY)
    said = import_samples(tmp_path / "a.wav", tmp_path / "array.yaml", tmp_path / "bag", PARAMETERS)
    assert "announces 4.0 s and holds 2.0 s" in said
    blocks = messages(tmp_path / "bag", "/array/samples")
    assert sum(block.n_samples for block in blocks) == pytest.approx(4000, abs=10)


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        ({"samples": noise(channels=3)}, "has 3 channels, the array has 4"),
        ({"rate": 500}, "sample_rate is 500 Hz; it must be at least 1000 Hz"),
        ({"rate": 1000, "node_parameters": {"band_demodulator": {"center_frequency": 495.0}}},
         "above half the sample rate"),
        ({"node_parameters": {"band_demodulator": {"bandwidth": 60.0}}}, "must be below 50 Hz"),
        ({"samples": noise(0.1)}, "lasts 0.1 s, less than"),
        ({"samples": np.full((RATE, 4), np.nan, np.float32)}, "not numbers on channel 1, 2, 3, 4"),
        ({"geometry": GEOMETRY + "mounting_yw_deg: 3\n"}, "did you mean mounting_yaw_deg"),
    ],
)  # fmt: skip
def test_what_cannot_be_used_is_named_and_leaves_no_bag(
    tmp_path: Path, options: dict[str, Any], reason: str
) -> None:
    with pytest.raises(ConfigurationError, match=reason):
        imported(tmp_path, **{"samples": noise(), **options})
    assert not (tmp_path / "bag").exists()


def test_a_file_of_own_ship_without_a_usable_line_is_named(tmp_path: Path) -> None:
    (tmp_path / "own.csv").write_text("time_s,east_m,north_m\n0,nowhere,0\n")
    with pytest.raises(ConfigurationError, match=r"own\.csv"):
        imported(tmp_path, noise(), own_ship=tmp_path / "own.csv")


@pytest.mark.parametrize(
    ("bandwidth", "count", "period"), [(3.0, 24, 4.0), (10.0, 40, 2.0), (40.0, 100, 1.25)]
)
def test_covariances_are_as_long_as_the_band_allows(
    tmp_path: Path, bandwidth: float, count: int, period: float
) -> None:
    (tmp_path / "array.yaml").write_text(GEOMETRY)
    suggested = suggested_estimator(tmp_path / "array.yaml", {"bandwidth": bandwidth}, "here")
    assert suggested["covariance_snapshots"] == count
    assert suggested["period"] == pytest.approx(period)
    assert suggested["covariance_alignment"] == "centred"
