"""Any file gets an answer: what it is, what is wrong, how to import it; damage is no traceback."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from scipy.io import wavfile

from sonar_tracking.bags.importers.bearing_file import read_bearing_lines, read_stations
from sonar_tracking.bags.importers.contact_file import read_contact_lines
from sonar_tracking.bags.importers.file_inspection import inspect_file
from sonar_tracking.bags.positions.map_origin import MapOrigin
from sonar_tracking.bags.positions.position_files import read_own_ship
from sonar_tracking.bags.positions.position_tables import true_positions_of_table
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.evaluation.studies.room_array.responses import read_room_responses
from sonar_tracking.evaluation.studies.ship_bearings.data import read_bearings
from sonar_tracking.simulation.scenarios.scenario import DEFAULT_EPOCH
from tests.docs.code_blocks import DOCS, blocks_of

EXAMPLES = {
    block.caption: block.text
    for block in blocks_of(DOCS / "reference" / "file_formats.md")
    if block.caption
}
READERS = {
    "contacts.csv": lambda path: read_contact_lines(path, DEFAULT_EPOCH),
    "bearings.csv": lambda path: read_bearing_lines(path, DEFAULT_EPOCH),
    "stations.csv": read_stations,
    "own_ship.csv": lambda path: read_own_ship(path, DEFAULT_EPOCH),
    "truth.csv": lambda path: true_positions_of_table(path, DEFAULT_EPOCH, MapOrigin()),
}
MUTATIONS = 40
"""Of each format; the same with a thousand has been run."""


@pytest.mark.parametrize(
    ("name", "what", "command"),
    [
        ("contacts.csv", "4 contacts", "import contacts"),
        ("bearings.csv", "4 bearings of 2 sensors", "import bearings"),
        ("stations.csv", "4 stations", "--stations"),
        ("own_ship.csv", "4 positions of own ship", "--own-ship"),
        ("own_ship.nmea", "2 positions of own ship", "import nmea"),
        ("ais.nmea", "3 AIS reports of 1 ships", "import nmea"),
        ("truth.csv", "true positions of 1 targets", "--truth"),
        ("true_bearings.csv", "true bearings at 4 instants", "--truth"),
        ("array.yaml", "8 elements", "--geometry"),
    ],
)
def test_every_example_of_the_documentation_is_recognised(
    tmp_path: Path, name: str, what: str, command: str
) -> None:
    path = tmp_path / name
    path.write_text(EXAMPLES[name])
    told = inspect_file(path)
    assert what in told and command in told and "nothing is wrong" in told


def test_what_is_wrong_is_told(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text("time_s,range_m,bearing_deg\n0,10,1\n1,,2\n")
    assert "line 3: range_m is missing" in inspect_file(path)
    log = tmp_path / "log.nmea"
    log.write_text("$GPHDT,274.07,T*03\n$GPHDT,274.07,T*04\n")
    told = inspect_file(log)
    assert "1 HDT" in told and "line 2: the checksum is wrong" in told
    assert "neither own ship nor other ships" in told
    path.write_text("a,b\n1,2\n")
    with pytest.raises(ConfigurationError, match="no format that is known: it has a, b"):
        inspect_file(path)
    with pytest.raises(ConfigurationError, match="no file"):
        inspect_file(tmp_path / "nothing.csv")


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("n_elements: 3\nspacing: 500\nsound_speed: 1500\n", "If these are millimetres"),
        ("element_x: [0, 0]\nelement_z: [0, 1]\nsound_speed: 1500\n", "the array is vertical"),
        ("n_elements: 3\nspacing: 0.5\n", "gives no sound_speed: 1500 m/s is assumed"),
        ("n_elements: 3\nspacing: 0.5\nsound_speed: 900\n", "sound_speed is 900 m/s"),
    ],
)
def test_what_is_doubtful_of_an_array_is_told_at_any_frequency(
    tmp_path: Path, text: str, told: str
) -> None:
    path = tmp_path / "array.yaml"
    path.write_text(text)
    assert told in inspect_file(path)


def test_the_command_has_what_the_file_does_not_tell(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("time_s,range_m,bearing_deg,range_deviation_m\n0,10,1,2\n")
    told = inspect_file(path)
    assert "--bearing-deviation-deg DEGREES" in told and "--range-deviation" not in told
    path.write_text("time_s,bearing_deg\n0,10\n")
    assert "--bearing-deviation-deg DEGREES" in inspect_file(path)


def test_files_of_hydrophones_are_not_taken_for_overlaps(tmp_path: Path) -> None:
    for name in ("H1_20260501_120000", "H2_20260501_120000"):
        wavfile.write(tmp_path / f"{name}.wav", 8000, np.ones(8000, np.int16))
    told = inspect_file(tmp_path)
    assert "2 channels" in told and "2 hydrophones have a file each" in told
    assert "overlap" not in told


def mutated(data: bytes, generator: np.random.Generator) -> bytes:
    """Return a file with bytes changed, cut out, doubled, or its end missing."""
    changed = bytearray(data)
    for _ in range(generator.integers(1, 6)):
        place = int(generator.integers(0, len(changed)))
        match generator.integers(0, 4):
            case 0:
                changed[place] = int(generator.integers(0, 256))
            case 1:
                del changed[place : place + int(generator.integers(1, 12))]
            case 2:
                changed[place:place] = changed[place : place + int(generator.integers(1, 12))]
            case _:
                changed = changed[: max(place, 1)]
        changed = changed or bytearray(b"\n")
    return bytes(changed)


@pytest.mark.parametrize("name", READERS)
@pytest.mark.parametrize("suffix", ["csv", "npz"])
def test_a_damaged_table_is_refused_or_its_losses_are_told(
    tmp_path: Path, name: str, suffix: str
) -> None:
    generator = np.random.default_rng(sum(name.encode()))
    source = tmp_path / f"sound.{suffix}"
    if suffix == "csv":
        source.write_text(EXAMPLES[name])
    else:
        header, *rows = [line.split(",") for line in EXAMPLES[name].split()]
        np.savez(
            source, allow_pickle=False, **dict(zip(header, zip(*rows, strict=True), strict=True))
        )
    damaged = tmp_path / f"damaged.{suffix}"
    for _ in range(MUTATIONS):
        damaged.write_bytes(mutated(source.read_bytes(), generator))
        try:
            READERS[name](damaged)
            told = inspect_file(damaged)
        except ConfigurationError as error:
            told = str(error)
        assert str(damaged) in told


def test_an_archive_that_is_no_table_is_told_how_to_become_one(tmp_path: Path) -> None:
    path = tmp_path / "data.npz"
    np.savez(path, allow_pickle=False, range_m=np.zeros((3, 2)), rate=np.array(1.0))
    with pytest.raises(ConfigurationError, match=r"write one array a column, as numpy\.savez"):
        inspect_file(path)
    path.write_text("range_m\n1\n")
    with pytest.raises(ConfigurationError, match="it is no npz file"):
        inspect_file(path)


def test_studies_say_what_keys_they_need(tmp_path: Path) -> None:
    path = tmp_path / "data.npz"
    np.savez(path, allow_pickle=False, EE_az_deg=np.zeros(3), EE_t_s=np.zeros(3))
    with pytest.raises(ConfigurationError, match=r"lacks EE_t_suspect, EE_el_deg"):
        read_bearings(path)
    np.savez(path, allow_pickle=False, other=np.zeros(3))
    with pytest.raises(ConfigurationError, match="NAME_t_s"):
        read_bearings(path)
    with pytest.raises(ConfigurationError, match=re.escape("rir, rir_scale, fs_hz")):
        read_room_responses(path)
    room = {
        "rir": np.zeros((1, 2, 9)),
        "rir_scale": np.array(1.0),
        "fs_hz": np.array(48000),
        "source_id": np.array([7, 6]),
        "source_xz_m": np.zeros((2, 2)),
        "mic_xz_m": np.zeros((2, 2)),
    }
    np.savez(path, allow_pickle=False, **room)
    with pytest.raises(ConfigurationError, match="sources x elements x samples"):
        read_room_responses(path)
