"""A plane wave in a WAV file must come out of the bag with its angle, sign, phase and instant."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import wavfile

from sonar_tracking.bags.contents.message_definitions import installed_typestore
from sonar_tracking.bags.importers.import_wav import import_wav
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.geometry import line_array, steering_vectors, wavenumber
from sonar_tracking.records.time import END_OF_DATA
from tests.bags.bag_fixtures import EPOCH, SECOND

RATE = 16_000
FREQUENCY = 2500.0
SOUND_SPEED = 340.0
SPACING = 0.05
N_ELEMENTS = 4
ANGLE = np.radians(25.0)
GEOMETRY = f"""
sensor_id: bench
n_elements: {N_ELEMENTS}
spacing: {SPACING}
sound_speed: {SOUND_SPEED}
epoch: 2026-01-01T00:00:00Z
"""


def plane_wave(seconds: float = 2.0) -> np.ndarray:
    """Return a sine from ANGLE at each element, phase 0.3 at the first, shape (n, elements)."""
    time = np.arange(round(seconds * RATE)) / RATE
    lead = SPACING * np.arange(N_ELEMENTS) * np.sin(ANGLE) / SOUND_SPEED
    return 0.5 * np.cos(2 * np.pi * FREQUENCY * (time[:, None] + lead) + 0.3)


def imported(
    tmp_path: Path, samples: np.ndarray, geometry: str = GEOMETRY, **options: Any
) -> list[Any]:
    """Import samples and return the decoded snapshot messages."""
    wavfile.write(tmp_path / "a.wav", RATE, samples.astype(np.float32))
    (tmp_path / "array.yaml").write_text(geometry)
    arguments = {"frequency": FREQUENCY, "bandwidth": 100.0, **options}
    import_wav(tmp_path / "a.wav", tmp_path / "array.yaml", output=tmp_path / "bag", **arguments)
    return messages(tmp_path / "bag", "/array/snapshots")


def messages(bag: Path, topic: str) -> list[Any]:
    opened = read_bag(bag)
    type_name = opened.topics[topic].type_name
    store = installed_typestore(type_name)
    return [store.deserialize_cdr(m.data, type_name) for m in opened.messages([topic])]


def columns(message: Any) -> np.ndarray:
    return message.data.view(np.complex64).reshape(message.n_snapshots, -1)


def stamp(time: Any) -> int:
    return int(time.sec) * SECOND + int(time.nanosec)


def test_a_plane_wave_has_the_phases_of_its_steering_vector(tmp_path: Path) -> None:
    blocks = imported(tmp_path, plane_wave())
    steering = steering_vectors(
        line_array(N_ELEMENTS, SPACING), np.array([ANGLE]), wavenumber(FREQUENCY, SOUND_SPEED)
    )[:, 0]
    for block in blocks:
        expected = 0.5 * np.exp(0.3j) * steering
        np.testing.assert_allclose(
            columns(block), np.tile(expected, (block.n_snapshots, 1)), atol=2e-3
        )


def test_the_message_says_what_was_recorded(tmp_path: Path) -> None:
    blocks = imported(tmp_path, plane_wave())
    first = blocks[0]
    assert (first.sensor_id, first.header.frame_id) == ("bench", "own_ship/array")
    assert (first.center_frequency, first.bandwidth, first.sound_speed) == (2500.0, 100.0, 340.0)
    np.testing.assert_allclose(first.element_x, SPACING * np.arange(N_ELEMENTS))
    assert not first.element_y.any() and len(first.noise_covariance) == 0
    assert np.isnan(first.sensor_pose.position.x)


def test_blocks_are_contiguous_and_their_stamps_physical(tmp_path: Path) -> None:
    """A short burst must appear at the stamp at which it was recorded."""
    samples = np.zeros((3 * RATE, N_ELEMENTS))
    burst = slice(RATE + 4000, RATE + 5600)
    samples[burst] = plane_wave(3.0)[burst]
    blocks = imported(tmp_path, samples)
    period = round(blocks[0].sample_period * SECOND)
    times, power = [], []
    for block, following in zip(blocks, [*blocks[1:], None], strict=True):
        begin = stamp(block.header.stamp)
        end = begin + block.n_snapshots * period
        assert stamp(block.next_stamp) == (
            stamp(following.header.stamp) if following else END_OF_DATA
        )
        if following:
            assert block.n_snapshots == 20
            assert abs(stamp(following.header.stamp) - end) <= 1
        times += [begin + period * n for n in range(block.n_snapshots)]
        power += list((np.abs(columns(block)) ** 2).mean(axis=1))
    centre = np.average(np.array(times) - EPOCH * SECOND, weights=power) / SECOND
    assert abs(centre - (1.0 + 4800 / RATE)) < 1e-3


def test_channels_are_put_where_the_map_says(tmp_path: Path) -> None:
    order = [3, 1, 4, 2]
    shuffled = np.zeros((2 * RATE, 6))
    for element, channel in enumerate(order):
        shuffled[:, channel - 1] = plane_wave()[:, element]
    mapped = imported(tmp_path, shuffled, GEOMETRY + f"channels: {order}\n")
    (tmp_path / "straight").mkdir()
    straight = imported(tmp_path / "straight", plane_wave())
    np.testing.assert_array_equal(columns(mapped[0]), columns(straight[0]))


def test_the_bag_can_be_replayed_and_scored(tmp_path: Path) -> None:
    truth = tmp_path / "truth.csv"
    truth.write_text(
        "time_s,target,arrival_angle_deg\n0,ferry,10\n0,tug,-20\n1,ferry,12\n1,tug,-20\n2,tug,-20\n"
    )
    parameters = {"bearing_tracker": {"method": "ryu"}}
    imported(tmp_path, plane_wave(), truth=truth, node_parameters=parameters)
    bag = read_bag(tmp_path / "bag")
    assert bag.recovery is None
    assert {name: topic.role for name, topic in bag.topics.items()} == {
        "/array/snapshots": "input",
        "/truth/bearing_tracks": "truth",
    }
    assert bag.recording is not None and bag.recording.node_parameters == parameters
    assert bag.recording.scenario["name"] == "a"
    first, second, third = messages(tmp_path / "bag", "/truth/bearing_tracks")
    np.testing.assert_allclose(np.degrees(first.arrival_angle), [10.0, -20.0])
    np.testing.assert_allclose(np.degrees(first.arrival_angle_rate), [2.0, 0.0])
    assert list(second.id) == [1, 2] and list(third.id) == [2]
    assert stamp(second.header.stamp) == (EPOCH + 1) * SECOND == stamp(first.next_stamp)
    times = [message.log_time for message in bag.messages()]
    assert times == sorted(times)


def test_a_file_that_is_cut_off_is_imported_as_far_as_it_goes_and_told(tmp_path: Path) -> None:
    wavfile.write(tmp_path / "whole.wav", RATE, plane_wave(4.0).astype(np.float32))
    whole = (tmp_path / "whole.wav").read_bytes()
    (tmp_path / "a.wav").write_bytes(whole[: len(whole) // 2])
    (tmp_path / "array.yaml").write_text(GEOMETRY)
    summary = import_wav(
        tmp_path / "a.wav", tmp_path / "array.yaml", FREQUENCY, 100.0, tmp_path / "bag"
    )
    assert summary.seconds == pytest.approx(2.0, abs=0.01)
    assert "announces 4.0 s and holds 2.0 s" in summary.text()


def test_snapshots_that_are_not_numbers_are_left_out_and_told(tmp_path: Path) -> None:
    samples = plane_wave(4.0)
    samples[RATE, 2] = np.nan
    wavfile.write(tmp_path / "a.wav", RATE, samples.astype(np.float32))
    (tmp_path / "array.yaml").write_text(GEOMETRY)
    summary = import_wav(
        tmp_path / "a.wav", tmp_path / "array.yaml", FREQUENCY, 100.0, tmp_path / "bag"
    )
    assert summary.dropped and "channel 3" in summary.dropped[0]
    assert summary.dropped[0] in summary.text()
    blocks = messages(tmp_path / "bag", "/array/snapshots")
    assert len(blocks) == summary.n_blocks
    assert all(np.isfinite(block.data).all() for block in blocks)
    assert sum(block.n_snapshots for block in blocks) == summary.n_snapshots < 4 * 100


@pytest.mark.parametrize(
    ("geometry", "options", "reason"),
    [
        ("n_elements: 6\nspacing: 0.05", {}, "has 4 channels, the array has 6"),
        (GEOMETRY + "channels: [1, 2, 3, 5]", {}, "on channel 5, but .* has 4 channels"),
        (GEOMETRY + "channels: [1, 2, 3]", {}, "3 entries, the array has 4"),
        (GEOMETRY + "channels: [1, 2, 2, 3]", {}, "holds 2 twice"),
        (GEOMETRY + "channels: [0, 1, 2, 3]", {}, "whole numbers from 1"),
        (GEOMETRY + "chanels: [1, 2, 3, 4]", {}, "did you mean channels"),
        ("sound_speed: 340", {}, "not placed"),
        ("element_x: [0, 1, 1, 2]", {}, "different places"),
        ("element_x: [0, 1, 2, 3]\nelement_y: [0, 1]", {}, "element_y has 2 values"),
        ("n_elements: 8\nelement_x: [0, 1, 2, 3]", {}, "leave one of them out"),
        ("[1, 2]", {}, "mapping"),
        ("a: [1", {}, "not valid YAML"),
        (GEOMETRY, {"bandwidth": 300.0}, "give less than 226.7 Hz"),
        (GEOMETRY.replace("0.05", "0.02"), {"frequency": 8000.0}, "half the sample rate"),
        (GEOMETRY, {"bandwidth": 1.0}, "less than"),
    ],
)
def test_bad_geometry_and_bands_are_named_and_leave_no_bag(
    tmp_path: Path, geometry: str, options: dict[str, float], reason: str
) -> None:
    with pytest.raises(ConfigurationError, match=reason):
        imported(tmp_path, plane_wave(), geometry, **options)
    assert not (tmp_path / "bag").exists()


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("time,angle\n1,2\n", "is no table with time_s"),
        ("time_s,target,arrival_angle_deg\n", "holds no usable line"),
        ("time_s,target,arrival_angle_deg\n0,a,north\n", "line 2: .* 'north', not a number"),
        ("time_s,target,arrival_angle_deg\n0,a,120\n", "line 2: .* between -90 and 90"),
    ],
)
def test_a_bad_truth_file_is_named(tmp_path: Path, text: str, reason: str) -> None:
    (tmp_path / "truth.csv").write_text(text)
    with pytest.raises(ConfigurationError, match=reason):
        imported(tmp_path, plane_wave(), truth=tmp_path / "truth.csv")


def test_a_file_of_nothing_but_nan_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match="not numbers on channel 1, 2, 3, 4"):
        imported(tmp_path, np.full((RATE, N_ELEMENTS), np.nan))


def test_the_default_bandwidth_is_half_of_what_is_allowed(tmp_path: Path) -> None:
    (block, *_) = imported(tmp_path, plane_wave(), bandwidth=None)
    assert block.bandwidth == pytest.approx(0.05 * SOUND_SPEED / (3 * SPACING))
