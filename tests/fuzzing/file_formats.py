"""A sound file of each format that is imported, and how it is taken."""

from __future__ import annotations

import io
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from sonar_tracking.bags.importers.bearing_file import read_stations
from sonar_tracking.bags.importers.bearing_truth_file import read_surveyed_bearings
from sonar_tracking.bags.importers.bearings_of_sensor import BearingSensor
from sonar_tracking.bags.importers.import_bearings import BearingSources, import_bearings
from sonar_tracking.bags.importers.import_contacts import ContactSensor, import_contacts
from sonar_tracking.bags.importers.import_nmea import import_nmea
from sonar_tracking.bags.importers.import_samples import import_samples
from sonar_tracking.bags.positions.map_origin import MapOrigin
from sonar_tracking.bags.positions.position_files import read_own_ship
from sonar_tracking.bags.positions.position_tables import true_positions_of_table
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.graph.catalogue.node_settings import read_settings
from sonar_tracking.simulation.scenarios.scenario import DEFAULT_EPOCH
from tests.docs.code_blocks import DOCS, blocks_of

EXAMPLES = {
    block.caption: block.text
    for block in blocks_of(DOCS / "reference" / "file_formats.md")
    if block.caption
}
N, RATE, CHANNELS = 24_000, 8000, 3
GEOMETRY = "n_elements: 3\nspacing: 0.5\nsound_speed: 1500\n"
BAND = {"band_demodulator": {"center_frequency": 1000.0, "bandwidth": 100.0}}
AUDIO = {"wav": "WAV", "flac": "FLAC", "w64": "W64", "rf64": "RF64", "aiff": "AIFF", "caf": "CAF"}

Taken = tuple[int, bool]
"""How much was taken, and whether anything was said."""


@dataclass(frozen=True)
class Format:
    """How files of a format are taken.

    Attributes
    ----------
    file : str
        Name of the damaged file.
    take : callable
        Imports a file, with a folder for what it makes.
    holds : callable
        Returns how much the bytes of a file hold at least.
    refused : list of str
        Why files were refused.
    """

    file: str
    take: Callable[[Path, Path], Taken]
    holds: Callable[[bytes], int]
    refused: list[str] = field(default_factory=list)


def made(name: str, folder: Path) -> bytes:
    """Return a sound file of a format, and make what goes with it in a folder."""
    (folder / "geometry.yaml").write_text(GEOMETRY)
    (folder / "contacts_beside.csv").write_text(EXAMPLES["contacts.csv"])
    samples = np.round(np.random.default_rng(3).normal(size=(N, CHANNELS)) * 3000) / 32768
    ending = name.rpartition(".")[2]
    if ending in AUDIO or name == "array.yaml":
        return _audio(ending, samples, folder)
    if name in ("mcap", "metadata.yaml"):
        return _bag(name, folder)
    if name == "parameters.yaml":
        return b"hpda_tracker: {sound_speed: 1500.0, clutter_density: 1.0e-5}\ntma_tracker: {}\n"
    if ending == "npz":
        header, *rows = [x.split(",") for x in EXAMPLES[name.replace("npz", "csv")].split()]
        columns = {
            name: np.array(column)
            for name, column in zip(header, zip(*rows, strict=True), strict=True)
        }
        stream = io.BytesIO()
        np.savez(stream, allow_pickle=False, **columns)
        return stream.getvalue()
    return EXAMPLES[name].encode()


def _audio(ending: str, samples: np.ndarray, folder: Path) -> bytes:
    import soundfile

    form = AUDIO.get(ending, "WAV")
    soundfile.write(folder / "sound.wav", samples, RATE, "PCM_16", format=form)
    if ending in AUDIO:
        return (folder / "sound.wav").read_bytes()
    return EXAMPLES["array.yaml"].replace("8", "3").replace("0.75", "0.5").encode()


def _bag(name: str, folder: Path) -> bytes:
    import_contacts(folder / "contacts_beside.csv", folder / "whole", SENSOR)
    (mcap,) = (folder / "whole").glob("*.mcap")
    return (folder / "whole" / "metadata.yaml" if name == "metadata.yaml" else mcap).read_bytes()


SENSOR = ContactSensor(range_deviation=5.0, bearing_deviation_deg=2.0)


def _said(text: str, usual: int) -> Taken:
    """Return the first number of a summary, and whether there are more lines than usual."""
    match = re.search(r": (\d+) ", text)
    return int(match[1]) if match else 0, len(text.splitlines()) > usual


def _samples(path: Path, folder: Path) -> Taken:
    said = import_samples(path, folder / "geometry.yaml", folder / "bag", BAND)
    return _said(said, 3)


def _geometry(path: Path, folder: Path) -> Taken:
    import_samples(folder / "sound.wav", path, folder / "bag", BAND)
    return 1, True


def _contacts(path: Path, folder: Path) -> Taken:
    return _said(import_contacts(path, folder / "bag", SENSOR), 2)


def _bearings(path: Path, folder: Path) -> Taken:
    stations = folder / "stations_beside.csv"
    stations.write_text("sensor,east_m,north_m\nwest,-500,0\neast,500,100\n")
    sensor = BearingSensor(bearing_deviation_deg=1.0)
    said = import_bearings(path, folder / "bag", sensor, BearingSources(stations), lambda _: {})
    return _said(said, 1)


def _stations(path: Path, folder: Path) -> Taken:
    stations, told = read_stations(path, MapOrigin())
    return len(stations), bool(told)


def _own_ship(path: Path, folder: Path) -> Taken:
    surveyed, told = read_own_ship(path, DEFAULT_EPOCH)
    beside = folder / "contacts_beside.csv"
    import_contacts(beside, folder / "bag", SENSOR, own_ship=path)
    return len(surveyed.stamp), bool(told)


def _truth(path: Path, folder: Path) -> Taken:
    targets, told = true_positions_of_table(path, DEFAULT_EPOCH, MapOrigin())
    import_contacts(folder / "contacts_beside.csv", folder / "bag", SENSOR, truth=path)
    return sum(len(each.stamp) for each in targets.values()), bool(told)


def _true_bearings(path: Path, folder: Path) -> Taken:
    bearings, told = read_surveyed_bearings(path, DEFAULT_EPOCH)
    return sum(len(each.target) for each in bearings), bool(told)


def _nmea(path: Path, folder: Path) -> Taken:
    return _said(import_nmea([path], folder / "bag"), 2)


def _whole_bag(path: Path, folder: Path) -> Taken:
    bag = read_bag(path)
    return sum(1 for _ in bag.messages()), bag.recovery is not None


def _bag_of_metadata(path: Path, folder: Path) -> Taken:
    (mcap,) = (folder / "whole").glob("*.mcap")
    (path.parent / mcap.name).write_bytes(mcap.read_bytes())
    return _whole_bag(path.parent, folder)


def _parameters(path: Path, folder: Path) -> Taken:
    read_settings(path)
    return 1, True


def _lines(data: bytes) -> int:
    """Return the lines below the headings of a table."""
    return max(len([line for line in data.splitlines() if line.strip()]) - 1, 0)


def _sentences(what: bytes) -> Callable[[bytes], int]:
    return lambda data: len(re.findall(what, data))


_TABLES: dict[str, Callable[[Path, Path], Taken]] = {
    "contacts": _contacts,
    "bearings": _bearings,
    "stations": _stations,
    "own_ship": _own_ship,
    "truth": _truth,
    "true_bearings": _true_bearings,
}

FORMATS: dict[str, Format] = {
    **{ending: Format(f"damaged.{ending}", _samples, lambda _: N) for ending in AUDIO},
    **{f"{name}.csv": Format("damaged.csv", take, _lines) for name, take in _TABLES.items()},
    **{f"{name}.npz": Format("damaged.npz", take, lambda _: 4) for name, take in _TABLES.items()},
    "own_ship.nmea": Format("damaged.nmea", _nmea, _sentences(rb"GPRMC[^\n]*\*[0-9A-F]{2}\n")),
    "ais.nmea": Format("damaged.nmea", _nmea, lambda _: 0),
    "array.yaml": Format("array.yaml", _geometry, lambda _: 0),
    "parameters.yaml": Format("parameters.yaml", _parameters, lambda _: 0),
    "mcap": Format("damaged.mcap", _whole_bag, lambda _: 6),
    "metadata.yaml": Format("directory/metadata.yaml", _bag_of_metadata, lambda _: 6),
}
"""By name."""
