"""Whatever happens to the bytes of a recording: what is intact is read, the rest is said.

No message may differ from what was recorded where the storage has checksums. Those that have none
(sqlite3, MCAP without chunks, files compressed by zstd as a whole) must still be read or refused
with a sentence.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from mcap.writer import CompressionType
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer

from sonar_tracking.bags.contents.message_definitions import installed_typestore
from tests.bags.bag_fixtures import (
    EPOCH,
    SECOND,
    SNAPSHOTS,
    TRACKS,
    open_writer,
    snapshots_cdr,
    tracks_cdr,
    write_messages,
)
from tests.bags.storage.bag_fuzzing import DAMAGES, Damage, cut, flip, fuzzed, insert, remove
from tests.bags.storage.test_split_bags import write_mcap, write_metadata

CASES = 25
TYPES = {"/array/snapshots": SNAPSHOTS, "/passive/bearing_tracks": TRACKS}
MESSAGES = [
    (topic, (EPOCH + second) * SECOND, data)
    for second in range(60)
    for topic, data in (
        ("/array/snapshots", snapshots_cdr(second, n_snapshots=20 if second % 10 else 300)),
        ("/passive/bearing_tracks", tracks_cdr(second)),
    )
]


def recorded(bag: Path) -> None:
    writer = open_writer(bag)
    write_messages(writer, 40)
    writer.close()


def chunks(compression: CompressionType, n_files: int = 1) -> Callable[[Path], None]:
    """Return a writer of bags of others, of some files."""

    def write(bag: Path) -> None:
        bag.mkdir()
        each = len(MESSAGES) // n_files
        for number in range(n_files):
            part = MESSAGES[number * each : (number + 1) * each]
            write_mcap(bag / f"k_{number}.mcap", part, 4000, compression)
        write_metadata(bag, [f"k_{n}.mcap" for n in range(n_files)], len(MESSAGES))

    return write


def rosbags(plugin: StoragePlugin, mode: CompressionMode | None = None) -> Callable[[Path], None]:
    """Return a writer of bags without checksums."""

    def write(bag: Path) -> None:
        writer = Writer(bag, version=9, storage_plugin=plugin)
        if mode is not None:
            writer.set_compression(mode, CompressionFormat.ZSTD)
        with writer:
            connections = {
                topic: writer.add_connection(topic, name, typestore=installed_typestore(name))
                for topic, name in TYPES.items()
            }
            for topic, log_time, data in MESSAGES:
                writer.write(connections[topic], log_time, data)

    return write


def unchunked(bag: Path) -> None:
    bag.mkdir()
    write_mcap(bag / "k_0.mcap", MESSAGES, 0)
    write_metadata(bag, ["k_0.mcap"], len(MESSAGES))


CHECKED = {
    "recorded": recorded,
    "mcap": chunks(CompressionType.NONE),
    "mcap zstd": chunks(CompressionType.ZSTD),
    "mcap lz4": chunks(CompressionType.LZ4),
    "split": chunks(CompressionType.ZSTD, 3),
}
UNCHECKED = {
    "mcap without chunks": unchunked,
    "sqlite3": rosbags(StoragePlugin.SQLITE3),
    "sqlite3, messages zstd": rosbags(StoragePlugin.SQLITE3, CompressionMode.MESSAGE),
    "sqlite3, files zstd": rosbags(StoragePlugin.SQLITE3, CompressionMode.FILE),
    "mcap, files zstd": rosbags(StoragePlugin.MCAP, CompressionMode.FILE),
}
# Least share kept of an own recording, of one of others in chunks: by one flip, a few bytes in or
# out. A chunk of others is 8 of 120 messages.
LEAST_KEPT = {"recorded": 0.97}
# Found with many cases; kept so that they stay found: storage, damage, seed.
CORPUS: tuple[tuple[str, Damage, int], ...] = (
    # The head of a channel hit, and the next record looked for inside of a chunk.
    ("recorded", insert, 3),
    # Bytes inserted before the closing part, which then does not begin where it says.
    ("mcap", insert, 3),
    ("mcap", remove, 3),
    # The size of a compressed chunk, then said to be absurd.
    ("mcap zstd", flip, 16),
    ("split", cut, 3),
)


@pytest.mark.parametrize("name", CHECKED)
def test_no_message_differs_and_what_is_missing_is_said(tmp_path: Path, name: str) -> None:
    CHECKED[name](tmp_path / "bag")
    for case, result in fuzzed(tmp_path / "bag", DAMAGES, CASES, 7, tmp_path):
        assert result.different == 0, case
        assert result.kept == 1.0 or result.said, case
        assert not result.refused or result.said.endswith("."), case


@pytest.mark.slow
@pytest.mark.parametrize("name", CHECKED)
def test_one_place_costs_no_more_than_its_message_or_chunk(tmp_path: Path, name: str) -> None:
    CHECKED[name](tmp_path / "bag")
    for case, result in fuzzed(tmp_path / "bag", [flip], CASES, 11, tmp_path):
        assert result.kept >= LEAST_KEPT.get(name, 0.9), (case, result.said)


@pytest.mark.slow
@pytest.mark.parametrize("name", UNCHECKED)
def test_without_checksums_a_bag_is_read_or_refused_with_a_sentence(
    tmp_path: Path, name: str
) -> None:
    UNCHECKED[name](tmp_path / "bag")
    for case, result in fuzzed(tmp_path / "bag", DAMAGES, CASES, 7, tmp_path):
        assert not result.refused or result.said.endswith("."), case


@pytest.mark.parametrize("name", ["mcap without chunks", "sqlite3"])
def test_a_flipped_byte_costs_one_message_of_a_plain_file(tmp_path: Path, name: str) -> None:
    UNCHECKED[name](tmp_path / "bag")
    for case, result in fuzzed(tmp_path / "bag", [flip], CASES, 5, tmp_path):
        assert result.different <= 1 and not result.refused, (case, result.said)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "damage", "seed"), CORPUS)
def test_what_was_found_once(tmp_path: Path, name: str, damage: Damage, seed: int) -> None:
    CHECKED[name](tmp_path / "bag")
    for case, result in fuzzed(tmp_path / "bag", [damage], 60, seed, tmp_path):
        assert result.different == 0 and (result.kept == 1.0 or result.said), case
        assert damage is cut or result.kept > 0.4, (case, result.said)
