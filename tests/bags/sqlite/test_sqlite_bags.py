"""Files of sqlite3, of any version of rosbag2 and however they ended, are read like others."""

from __future__ import annotations

import shutil
import sqlite3
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.errors import ConfigurationError
from tests.bags.bag_fixtures import TRACKS, open_writer, tracks_cdr, write_messages

TOPIC = "/passive/bearing_tracks"
# The tables as rosbag2 made them before it kept definitions, metadata and an index of times.
OLD_TABLES = """
CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,
                    serialization_format TEXT NOT NULL{quality});
CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL,
                      timestamp INTEGER NOT NULL, data BLOB NOT NULL);
"""
TIMES = (7, 3, 3, 9, 7, 1)


def old_file(path: Path, with_quality: bool) -> sqlite3.Connection:
    """Write the messages of :data:`TIMES` into a file without index; return the connection."""
    base = sqlite3.connect(path)
    base.executescript(OLD_TABLES.format(quality=", offered_qos_profiles TEXT" * with_quality))
    row = (1, TOPIC, TRACKS, "cdr", *(("- {depth: 3, durability: 1}",) if with_quality else ()))
    base.execute(f"INSERT INTO topics VALUES ({', '.join('?' * len(row))})", row)
    for number, time in enumerate(TIMES):
        base.execute(
            "INSERT INTO messages(topic_id, timestamp, data) VALUES (1, ?, ?)",
            (time, tracks_cdr(number)),
        )
    base.commit()
    return base


def in_order() -> list[tuple[int, bytes]]:
    written = [(time, tracks_cdr(number)) for number, time in enumerate(TIMES)]
    return sorted(written, key=lambda message: message[0])


def read(path: Path) -> list[tuple[int, bytes]]:
    return [(m.log_time, m.data) for m in read_bag(path).messages()]


@pytest.mark.parametrize("with_quality", [False, True])
def test_old_files_without_index_are_put_in_order_and_ties_keep_theirs(
    tmp_path: Path, with_quality: bool
) -> None:
    old_file(tmp_path / "old #1 50%.db3", with_quality).close()
    bag = read_bag(tmp_path / "old #1 50%.db3")
    assert read(bag.path) == in_order() and bag.recovery is None
    assert bag.topics[TOPIC].role == "output"
    quality = bag.topics[TOPIC].quality
    assert (quality.depth, quality.durability) == (
        (3, "transient_local") if with_quality else (10, "volatile")
    )


def test_what_a_killed_recorder_left_in_its_journal_is_read(tmp_path: Path) -> None:
    base = old_file(tmp_path / "running.db3", True)
    base.execute("PRAGMA journal_mode = WAL")
    base.execute("PRAGMA wal_autocheckpoint = 0")
    with base:
        base.execute(
            "INSERT INTO messages(topic_id, timestamp, data) VALUES (1, 20, ?)", (tracks_cdr(99),)
        )
    (tmp_path / "killed").mkdir()
    for name in ("running.db3", "running.db3-wal"):
        shutil.copy(tmp_path / name, tmp_path / "killed" / name)
    base.close()
    before = (tmp_path / "killed" / "running.db3").read_bytes()
    bag = read_bag(tmp_path / "killed" / "running.db3")
    assert bag.recovery is None
    assert read(bag.path) == [*in_order(), (20, tracks_cdr(99))]
    assert (tmp_path / "killed" / "running.db3").read_bytes() == before


def test_names_that_are_no_text_any_more_are_damage(tmp_path: Path) -> None:
    """Quoted in an error of sqlite they are one more error, of its module."""
    path = tmp_path / "bag.db3"
    old_file(path, with_quality=True).close()
    data = path.read_bytes()
    assert b"tabletopicstopics" in data
    broken = data.replace(b"tabletopicstopics", b"tablet\x98picst\x98pics")
    path.write_bytes(broken.replace(b"CREATE TABLE topics", b"CREATE TABLE \x98(,,,,"))
    bag = read_bag(path)
    assert bag.recovery is not None and "pages were read one by one" in bag.recovery
    assert sorted(m.data for m in bag.messages()) == sorted(data for _, data in in_order())


def test_a_damaged_file_is_refused_with_a_sentence(tmp_path: Path) -> None:
    old_file(tmp_path / "k.db3", True).close()
    data = (tmp_path / "k.db3").read_bytes()
    for size in (0, 50, 5000, len(data) - 3000):
        (tmp_path / "k.db3").write_bytes(data[:size])
        with pytest.raises(ConfigurationError, match=r"k\.db3 (cannot be read|is damaged)"):
            read(tmp_path / "k.db3")


@pytest.mark.slow
@pytest.mark.parametrize("compress", ["none", "zstd"])
def test_bags_converted_to_sqlite3_and_back_hold_the_same(tmp_path: Path, compress: str) -> None:
    writer = open_writer(tmp_path / "run")
    write_messages(writer, 8)
    writer.close()
    original = read_bag(tmp_path / "run")
    for source, target, storage in (("run", "base", "sqlite3"), ("base", "back", "mcap")):
        subprocess.run(
            [
                sys.executable, "-m", "rosbags.convert", "--src", tmp_path / source,
                "--dst", tmp_path / target, "--dst-storage", storage,
                "--compress", compress, "--compress-mode", "file",
            ],
            check=True, capture_output=True,
        )  # fmt: skip
        converted = read_bag(tmp_path / target)
        assert converted.recovery is None and converted.outdated is None
        assert list(converted.messages()) == list(original.messages())
        described = {
            name: (topic.type_name, topic.role, topic.message_count, topic.quality)
            for name, topic in converted.topics.items()
        }
        assert described == {
            name: (topic.type_name, topic.role, topic.message_count, topic.quality)
            for name, topic in original.topics.items()
        }


def test_a_bag_may_be_read_and_collected_in_another_thread(tmp_path: Path) -> None:
    """Garbage is collected by whichever thread runs just then, such as that of the page."""
    old_file(tmp_path / "old.db3", False).close()
    bags = [read_bag(tmp_path / "old.db3")]

    def read_and_drop() -> list[tuple[int, bytes]]:
        bag = bags.pop()
        return [(m.log_time, m.data) for m in bag.messages()]

    with ThreadPoolExecutor(1) as another:
        assert another.submit(read_and_drop).result() == in_order()
