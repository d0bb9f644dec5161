"""Files made to fill memory or to take for ever are refused, or read within bounds."""

from __future__ import annotations

import json
import sqlite3
import struct
import subprocess
import sys
import zlib
from pathlib import Path

import pytest
import yaml
from mcap.opcode import Opcode

from sonar_tracking.bags.contents.bag_information import information_from_text
from sonar_tracking.bags.contents.metadata import OfferedQuality, quality_from_text
from sonar_tracking.bags.contents.recording_information import RecordingInformation
from sonar_tracking.bags.contents.stored_text import StoredTextError, json_value, yaml_value
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.bags.storage.repair import repair_bag
from sonar_tracking.errors import ConfigurationError
from tests.bags.bag_fixtures import TRACKS, information, open_writer, write_messages

zstd = pytest.importorskip("backports.zstd")

DEEP = {
    "flow": "[\n" * 100_000,
    "block": "\n".join(" " * depth + "a:" for depth in range(3000)),
    "list": "- " * 20_000,
}
MERGES = "\n".join(
    [
        "a0: &a0 {x: 1}",
        *(f"a{n}: &a{n} {{<<: [{', '.join([f'*a{n - 1}'] * 9)}]}}" for n in range(1, 12)),
    ]
)
ALIASES = "\n".join(
    ["a0: &a0 [x, x]", *(f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 9)}]" for n in range(1, 30))]
)


@pytest.mark.parametrize("text", [*DEEP.values(), MERGES], ids=[*DEEP, "merges"])
def test_yaml_that_grows_or_goes_deep_is_not_followed(text: str) -> None:
    with pytest.raises(StoredTextError):
        yaml_value(text)
    assert information_from_text(text) is None
    assert quality_from_text(text) == OfferedQuality()


def test_shared_values_are_not_written_out() -> None:
    text = f"{ALIASES}\nmessage_count: 3\ncompression_mode: *a29\nrelative_file_paths: *a29"
    found = information_from_text(text)
    assert found is not None and (found.message_count, found.compression_mode) == (3, "")


def test_json_that_goes_deep_is_refused_with_a_sentence() -> None:
    with pytest.raises(StoredTextError, match="nested too deeply"):
        json_value("[" * 1_000_000)
    with pytest.raises(ConfigurationError, match="nested too deeply"):
        RecordingInformation.from_json('{"scenario": ' * 200_000, "here")
    with pytest.raises(ConfigurationError, match="must be a mapping of node"):
        RecordingInformation.from_json('{"node_parameters": {"bearing_tracker": 3}}', "here")


def test_damage_in_what_the_bag_says_of_its_making_costs_no_message(tmp_path: Path) -> None:
    writer = open_writer(tmp_path / "run")
    written = write_messages(writer, 10)
    writer.close()
    file = tmp_path / "run" / "run_0.mcap"
    data = bytearray(file.read_bytes())
    at = data.index(b'"node_parameters"')
    data[at] = ord("x")
    file.write_bytes(data)
    bag = read_bag(tmp_path / "run")
    assert bag.recording == information() and bag.message_count == len(written)
    assert bag.recovery is not None and "damaged" in bag.recovery
    # Now every copy: as for a bag of somebody else, the nodes follow from the types.
    for broken in (file, tmp_path / "run" / "metadata.yaml"):
        data = bytearray(broken.read_bytes())
        while (at := data.find(b'"node_parameters"')) >= 0:
            data[at] = ord("x")
        broken.write_bytes(data)
    bag = read_bag(tmp_path / "run")
    assert bag.recording is None and bag.message_count == len(written)
    assert bag.recovery is not None and "cannot be read as JSON" in bag.recovery
    repaired = read_bag(repair_bag(tmp_path / "run"))
    assert repaired.recovery is None and repaired.losses == ()


def bomb_file(path: Path) -> None:
    """Write an MCAP file with a chunk of 33 kB that would decompress to 1 GB."""
    records = zstd.compress(bytes(1 << 20)) * 1024
    name = struct.pack("<I", 4) + b"zstd"
    content = struct.pack("<QQQI", 0, 0, 1 << 30, 0) + name
    content += struct.pack("<Q", len(records)) + records
    path.write_bytes(b"\x89MCAP0\r\n" + struct.pack("<BQ", Opcode.CHUNK, len(content)) + content)


def mcap_with_counts(path: Path) -> None:
    """Write records that state absurd lengths and counts."""
    absurd = struct.pack("<I", 0xFFFFFFF0)
    records = [(opcode, absurd * 8) for opcode in range(1, 16)] + [(Opcode.CHUNK, b"\xff" * 60)]
    data = b"".join(struct.pack("<BQ", opcode, len(text)) + text for opcode, text in records)
    data += struct.pack("<BQ", Opcode.MESSAGE, 1 << 62)
    footer = struct.pack("<BQQQ", Opcode.FOOTER, 20, 8, 0)
    data += footer + struct.pack("<I", zlib.crc32(data + footer))
    path.write_bytes(b"\x89MCAP0\r\n" + data + b"\x89MCAP0\r\n")


def nothing_but_damage(path: Path) -> None:
    """Write millions of records each of which is damaged."""
    record = struct.pack("<BQ", Opcode.SCHEMA, 3) + b"abc"
    path.write_bytes(b"\x89MCAP0\r\n" + record * 1_000_000)


def endless_view(path: Path) -> None:
    """Write a database whose messages are computed without end."""
    base = sqlite3.connect(path)
    base.executescript(
        "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT);"
        f"INSERT INTO topics VALUES (1, '/tracks', '{TRACKS}');"
        "CREATE VIEW messages AS WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n) "
        "SELECT x AS id, 1 AS topic_id, x AS timestamp, zeroblob(1000000) AS data FROM n;"
    )
    base.close()


def computed_column(path: Path) -> None:
    """Write a database whose messages grow when they are read."""
    base = sqlite3.connect(path)
    base.executescript(
        "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT);"
        f"INSERT INTO topics VALUES (1, '/tracks', '{TRACKS}');"
        "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, "
        "data BLOB AS (zeroblob(900000000)));"
        "INSERT INTO messages(topic_id, timestamp) VALUES (1, 1);"
    )
    base.close()


HOSTILE = {
    "bomb.mcap": bomb_file,
    "counts.mcap": mcap_with_counts,
    "damage.mcap": nothing_but_damage,
    "view.db3": endless_view,
    "column.db3": computed_column,
}


@pytest.mark.slow
@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_files_are_refused_within_bounds(tmp_path: Path, name: str) -> None:
    HOSTILE[name](tmp_path / name)
    code = (
        "import sys\n"
        "from sonar_tracking.bags.storage.reader import read_bag\n"
        "from sonar_tracking.errors import ConfigurationError\n"
        "try:\n    list(read_bag(sys.argv[1]).messages())\n"
        "except ConfigurationError as error:\n    print(error)\n"
        # Of this process alone: what resource tells begins with the peak of its parent.
        "status = dict(line.split(':', 1) for line in open('/proc/self/status'))\n"
        "print(status['VmHWM'].split()[0])\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, tmp_path / name], capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 0, done.stderr
    sentence, kilobytes = done.stdout.strip().rsplit("\n", 1)
    assert name in sentence and sentence.endswith(".")
    assert int(kilobytes) < 500_000


WRITE = """
import resource, sys
from pathlib import Path
resource.setrlimit(resource.RLIMIT_FSIZE, (60_000, 60_000))
sys.path.insert(0, {root!r})
from sonar_tracking.bags.storage.repair import repair_bag
from sonar_tracking.errors import ConfigurationError
try:
    repair_bag(Path({bag!r}))
except ConfigurationError as error:
    print(error)
"""


@pytest.mark.slow
def test_a_full_disk_ends_a_repair_with_a_sentence_and_without_a_bag(tmp_path: Path) -> None:
    writer = open_writer(tmp_path / "run")
    write_messages(writer, 200)
    writer.close()
    file = tmp_path / "run" / "run_0.mcap"
    file.write_bytes(file.read_bytes()[:-300])
    code = WRITE.format(root=str(Path(__file__).parents[3]), bag=str(tmp_path / "run"))
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert "cannot be written (File too large); make room" in done.stdout, done.stderr
    assert not done.stderr
    assert [entry.name for entry in tmp_path.iterdir()] == ["run"]


def test_a_repaired_bag_says_what_the_damaged_one_lacked(tmp_path: Path) -> None:
    writer = open_writer(tmp_path / "run")
    write_messages(writer, 30)
    writer.close()
    file = tmp_path / "run" / "run_0.mcap"
    data = bytearray(file.read_bytes())
    data[data.rindex(b"\x05", 0, len(data) * 3 // 4) + 100] ^= 1
    file.write_bytes(data)
    damaged = read_bag(tmp_path / "run")
    (loss,) = damaged.losses
    assert loss.messages == 1 and loss.topic in damaged.topics
    repaired = read_bag(repair_bag(tmp_path / "run"))
    assert repaired.recovery is None and repaired.losses == damaged.losses
    assert json.loads(repaired.custom_data["sonar_tracking.missing"])[0]["topic"] == loss.topic
    names = yaml.safe_load((repaired.path / "metadata.yaml").read_text())
    assert "rosbag2_bagfile_information" in names


def test_what_is_missing_behind_a_cut_is_one_short_sentence(tmp_path: Path) -> None:
    writer = open_writer(tmp_path / "run")
    write_messages(writer, 200)
    writer.close()
    file = tmp_path / "run" / "run_0.mcap"
    data = file.read_bytes()
    file.write_bytes(data[: len(data) // 2])
    said = read_bag(tmp_path / "run").recovery
    assert said is not None and said.count("it ends at") == 1 and len(said) < 500
    assert "of /array/snapshots" in said and "of /clock" in said
