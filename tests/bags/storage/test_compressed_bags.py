"""Compressed bags are read as if they were not, within bounds, or refused for the true reason."""

from __future__ import annotations

import errno
import sqlite3
import struct
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest
import yaml
from backports import zstd
from mcap.opcode import Opcode
from mcap.writer import CompressionType
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as RosbagsWriter
from rosbags.rosbag2.enums import CompressionFormat, CompressionMode

from sonar_tracking.bags.contents import decompression
from sonar_tracking.bags.contents.decompression import DamagedDataError, TooLargeError, decompressed
from sonar_tracking.bags.contents.message_definitions import installed_typestore
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.errors import ConfigurationError
from tests.bags.bag_fixtures import EPOCH, SECOND, TRACKS, open_writer, tracks_cdr, write_messages
from tests.bags.storage.test_split_bags import write_mcap, write_metadata

TOPIC = "/passive/bearing_tracks"
N = 8
WRITTEN = [(EPOCH * SECOND + second, tracks_cdr(second)) for second in range(N)]


@pytest.fixture(autouse=True)
def nothing_is_left_behind(
    tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> Iterator[None]:
    folder = tmp_path_factory.mktemp("temporary")
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    yield
    assert not list(folder.iterdir())


def write_compressed(path: Path, plugin: StoragePlugin, mode: CompressionMode) -> None:
    """Write a bag with the rosbags package."""
    writer = RosbagsWriter(path, version=9, storage_plugin=plugin)
    writer.set_compression(mode, CompressionFormat.ZSTD)
    writer.set_custom_data("campaign", "spring")
    with writer:
        connection = writer.add_connection(TOPIC, TRACKS, typestore=installed_typestore(TRACKS))
        for log_time, data in WRITTEN:
            writer.write(connection, log_time, data)


def read(path: Path) -> list[tuple[int, bytes]]:
    return [(m.log_time, m.data) for m in read_bag(path).messages()]


@pytest.mark.parametrize("mode", [CompressionMode.FILE, CompressionMode.MESSAGE])
@pytest.mark.parametrize("plugin", [StoragePlugin.SQLITE3, StoragePlugin.MCAP])
def test_bags_compressed_by_another_recorder_are_read_whole_or_as_a_single_file(
    tmp_path: Path, plugin: StoragePlugin, mode: CompressionMode
) -> None:
    write_compressed(tmp_path / "other", plugin, mode)
    bag = read_bag(tmp_path / "other")
    assert bag.recovery is None and bag.message_count == N
    assert read(tmp_path / "other") == WRITTEN
    (file,) = [f for f in (tmp_path / "other").iterdir() if f.name != "metadata.yaml"]
    assert (file.suffix == ".zstd") == (mode is CompressionMode.FILE)
    alone = read_bag(file)
    assert alone.recovery is None and alone.custom_data["campaign"] == "spring"
    assert read(file) == WRITTEN


def test_a_split_bag_compressed_file_by_file_is_merged(tmp_path: Path) -> None:
    for number in range(3):
        messages = [(TOPIC, *message) for message in WRITTEN[number::3]]
        write_mcap(tmp_path / f"k_{number}.mcap", messages)
        plain = (tmp_path / f"k_{number}.mcap").read_bytes()
        half = len(plain) // 2
        # Several frames in one file are one stream.
        data = zstd.compress(plain[:half]) + zstd.compress(plain[half:])
        (tmp_path / f"k_{number}.mcap.zstd").write_bytes(data)
        (tmp_path / f"k_{number}.mcap").unlink()
    write_metadata(tmp_path, [f"k_{number}.mcap.zstd" for number in range(3)], N)
    assert read_bag(tmp_path).recovery is None
    assert read(tmp_path) == WRITTEN
    # A recorder that was killed has told the names without compression, or none.
    write_metadata(tmp_path, [f"k_{number}.mcap" for number in range(3)], N)
    assert read(tmp_path) == WRITTEN
    (tmp_path / "metadata.yaml").unlink()
    assert read(tmp_path) == WRITTEN


def test_of_a_file_and_its_compressed_twin_one_is_read(tmp_path: Path) -> None:
    write_compressed(tmp_path / "bag", StoragePlugin.MCAP, CompressionMode.FILE)
    compressed = tmp_path / "bag" / "bag.mcap.zstd"
    plain = tmp_path / "bag" / "bag.mcap"
    plain.write_bytes(b"what a player was decompressing when it was killed")
    assert read(tmp_path / "bag") == WRITTEN
    plain.write_bytes(zstd.decompress(compressed.read_bytes()))
    compressed.write_bytes(compressed.read_bytes()[:50])
    (tmp_path / "bag" / "metadata.yaml").unlink()
    assert read(tmp_path / "bag") == WRITTEN, "what a recorder was compressing when it was killed"


def test_a_compressed_file_that_is_cut_off_gives_what_is_before_the_cut(tmp_path: Path) -> None:
    writer = open_writer(tmp_path / "run")
    written = write_messages(writer, 60)
    writer.close()
    plain = (tmp_path / "run" / "run_0.mcap").read_bytes()
    frames = [zstd.compress(plain[at : at + 5000]) for at in range(0, len(plain), 5000)]
    whole = b"".join(frames)
    some = len(frames) * 3 // 4
    end_of_frame = len(b"".join(frames[:some]))
    for size, reason in (
        (end_of_frame + 20, "cut off"),
        (end_of_frame, f"ends at byte {5000 * some}"),
    ):
        (tmp_path / "cut.mcap.zstd").write_bytes(whole[:size])
        bag = read_bag(tmp_path / "cut.mcap.zstd")
        assert bag.recovery is not None and reason in bag.recovery
        assert str(tmp_path / "cut.mcap.zstd") in bag.recovery
        messages = [(m.topic, m.log_time, m.data) for m in bag.messages()]
        assert 0 < len(messages) < len(written)
        assert messages == sorted(written[: len(messages)], key=lambda message: message[1])
    (tmp_path / "cut.mcap.zstd").write_bytes(whole[:10])
    with pytest.raises(ConfigurationError, match=r"cut\.mcap\.zstd cannot be read \(.*cut off\)"):
        read_bag(tmp_path / "cut.mcap.zstd")
    (tmp_path / "cut.mcap.zstd").write_bytes(b"no compressed data at all")
    with pytest.raises(ConfigurationError, match=r"cut\.mcap\.zstd cannot be read \(.*damaged"):
        read_bag(tmp_path / "cut.mcap.zstd")


def test_a_damaged_message_is_left_out_and_counted(tmp_path: Path) -> None:
    write_compressed(tmp_path / "bag", StoragePlugin.SQLITE3, CompressionMode.MESSAGE)
    with sqlite3.connect(tmp_path / "bag" / "bag.db3") as base:
        (data,) = base.execute("SELECT data FROM messages WHERE id = 3").fetchone()
        base.execute("UPDATE messages SET data = ? WHERE id = 3", (data[:-9],))
    base.close()
    bag = read_bag(tmp_path / "bag")
    assert bag.recovery is not None
    assert f"1 messages of {TOPIC} are damaged" in bag.recovery and "7 of 8" in bag.recovery
    assert bag.topics[TOPIC].message_count == N - 1
    assert read(tmp_path / "bag") == [*WRITTEN[:2], *WRITTEN[3:]]


def test_what_exceeds_its_bound_is_refused_before_it_fills_memory_or_disk(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    bomb = zstd.compress(bytes(64 << 20))
    assert len(bomb) < 1 << 14
    monkeypatch.setattr(decompression, "LARGEST_FILE", 1 << 20)
    (tmp_path / "bomb.mcap.zstd").write_bytes(bomb)
    with pytest.raises(TooLargeError, match=r"bomb\.mcap\.zstd would .* more than 1 MiB.*unzstd"):
        read_bag(tmp_path / "bomb.mcap.zstd")
    with pytest.raises(TooLargeError, match="A message would decompress to more than 1 MiB"):
        decompressed(bomb, "zstd", 1 << 20, "A message")
    assert decompressed(bomb, "zstd", 64 << 20, "A message") == bytes(64 << 20)


def test_a_bomb_among_the_messages_is_found_when_the_bag_is_opened(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sonar_tracking.bags.storage.compressed_messages.LARGEST_MESSAGE", 1 << 20)
    write_compressed(tmp_path / "bag", StoragePlugin.SQLITE3, CompressionMode.MESSAGE)
    with sqlite3.connect(tmp_path / "bag" / "bag.db3") as base:
        base.execute("UPDATE messages SET data = ? WHERE id = 5", (zstd.compress(bytes(9 << 20)),))
    base.close()
    with pytest.raises(TooLargeError, match=rf"A message of {TOPIC} in .*bag\.db3 would"):
        read_bag(tmp_path / "bag")


def test_a_chunk_holds_no_more_than_it_says_and_is_allowed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    messages = [(TOPIC, *message) for message in WRITTEN]
    path = tmp_path / "k.mcap"
    write_mcap(path, messages, compression=CompressionType.ZSTD)
    data = bytearray(path.read_bytes())
    assert read(path) == WRITTEN
    with monkeypatch.context() as patch:
        patch.setattr(decompression, "LARGEST_CHUNK", 1000)
        with pytest.raises(TooLargeError, match=r"chunk of .*k\.mcap would decompress"):
            read_bag(path)
    at = 8
    while data[at] != Opcode.CHUNK:
        at += 9 + struct.unpack_from("<Q", data, at + 1)[0]
    struct.pack_into("<Q", data, at + 9 + 16, 100)
    path.write_bytes(data)
    # The closing part knows the size, too; where that is damaged, the chunk is taken at its word.
    assert read(path) == WRITTEN
    data[-12] ^= 1
    path.write_bytes(data)
    with pytest.raises(ConfigurationError, match=r"a compressed chunk at byte \d+ cannot be"):
        read_bag(path)


@pytest.mark.parametrize("mode", ["FILE", "MESSAGE"])
def test_another_compression_is_named(tmp_path: Path, mode: str) -> None:
    write_mcap(tmp_path / "k.mcap", [(TOPIC, *message) for message in WRITTEN])
    information = {
        "relative_file_paths": ["k.mcap.brotli"],
        "compression_mode": mode,
        "compression_format": "brotli",
    }
    text = yaml.safe_dump({"rosbag2_bagfile_information": information})
    (tmp_path / "metadata.yaml").write_text(text)
    with pytest.raises(ConfigurationError, match="compressed by brotli"):
        read_bag(tmp_path)


def test_a_full_disk_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(path: Path, plain: Path) -> str:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(decompression, "_decompress_file", full)
    write_compressed(tmp_path / "bag", StoragePlugin.MCAP, CompressionMode.FILE)
    with pytest.raises(ConfigurationError, match=r"no room for what is in it.*TMPDIR"):
        read_bag(tmp_path / "bag")


def test_several_frames_are_one_and_a_part_of_one_is_none() -> None:
    data = zstd.compress(b"one ") + zstd.compress(b"two")
    assert decompressed(data, "zstd", 7, "x") == b"one two"
    for damaged in (data[:-1], data[:7], b"\x28\xb5\x2f\xfd", b"junk", data + b"junk"):
        with pytest.raises(DamagedDataError):
            decompressed(damaged, "zstd", 100, "x")
