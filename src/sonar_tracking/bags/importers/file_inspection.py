"""What a file is, what is wrong with it, and the command that imports it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np

from sonar_tracking.bags.audio.audio_inspection import inspect_audio
from sonar_tracking.bags.audio.open_audio import AUDIO_ENDINGS
from sonar_tracking.bags.importers.array_geometry_file import read_array_geometry
from sonar_tracking.bags.importers.bearing_file import (
    DIRECTIONS,
    read_bearing_lines,
    read_stations,
)
from sonar_tracking.bags.importers.bearing_truth_file import read_surveyed_bearings
from sonar_tracking.bags.importers.contact_file import (
    read_contact_lines,
    read_own_ship,
    read_true_positions,
)
from sonar_tracking.bags.importers.line_notes import LineNotes
from sonar_tracking.bags.importers.npz_file import read_npz
from sonar_tracking.bags.importers.number_table import table_cells
from sonar_tracking.bags.importers.table_times import TIMES, instant_text
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.errors import ConfigurationError, shown
from sonar_tracking.records.arrays import IntArray
from sonar_tracking.scene.nmea_sentences import checksum
from sonar_tracking.simulation.scenarios.scenario import DEFAULT_EPOCH

BAGS = frozenset((".mcap", ".db3", ".zstd"))
PAGE = "the page 'File formats' of the documentation shows each format"

Inspected = tuple[str, list[str], str]
"""What it is, what is wrong, the command."""


def inspect_file(path: Path) -> str:
    """Return what a file is, what is wrong with it and the command to import it, in words.

    Parameters
    ----------
    path : Path
        A table, an array's geometry, audio, an NMEA log or a bag.

    Raises
    ------
    ConfigurationError
        If it is none of these.
    """
    if not path.exists():
        raise ConfigurationError(f"There is no file {path}; check the name.")
    what, wrong, command = _inspector(path)(path)
    return "\n".join([f"{path}: {what}", *(wrong or ["nothing is wrong with it"]), command])


def _inspector(path: Path) -> Callable[[Path], Inspected]:
    suffix = path.suffix.lower()
    is_audio = suffix in AUDIO_ENDINGS
    if path.is_dir():
        is_audio = any(each.suffix.lower() in AUDIO_ENDINGS for each in path.iterdir())
    if is_audio:
        return inspect_audio
    if path.is_dir() or suffix in BAGS:
        return _bag
    if suffix in (".yaml", ".yml"):
        return _geometry
    if suffix != ".npz" and _looks_like_nmea(path):
        return _nmea
    return _table


def _bag(path: Path) -> Inspected:
    bag = read_bag(path)
    topics = ", ".join(f"{n} ({t.message_count})" for n, t in bag.topics.items() if t.message_count)
    return f"a bag with messages of {topics}", [], f"sonar-tracking replay {path}"


def _geometry(path: Path) -> Inspected:
    array = read_array_geometry(path)
    what = f"the geometry of an array of {len(array.element_positions)} elements, "
    what += f"{array.aperture:.4g} m across, sound speed {array.sound_speed:g} m/s"
    return what, [], f"sonar-tracking import wav FILE.wav --geometry {path} --output bag"


def _looks_like_nmea(path: Path) -> bool:
    with path.open("rb") as file:
        return file.readline(200).lstrip()[:1] in (b"$", b"!")


def _nmea(path: Path) -> Inspected:
    kinds: Counter[str] = Counter()
    failed = 0
    with path.open(encoding="ascii", errors="replace") as file:
        for line in file:
            body, star, told = line.strip()[1:].partition("*")
            whole = checksum(map(ord, body)) == told[:2].upper()
            failed += bool(star) and not whole
            kinds[shown(body.split(",")[0], 8)] += not star or whole
    told = ", ".join(f"{count} {kind}" for kind, count in kinds.most_common(8) if count)
    wrong = [f"{failed} sentences have a wrong checksum"] if failed else []
    return f"an NMEA 0183 log: {told or 'no sentence'}", wrong, "it is read as it is, not imported"


def _table(path: Path) -> Inspected:
    if path.suffix == ".npz":
        study = _study(set(read_npz(path)), path)
        if study is not None:
            return study
    columns = set(table_cells(path, LineNotes(path))[0])
    east_north = {"east_m", "north_m"} <= columns
    if {"target", "arrival_angle_deg"} <= columns:
        bearings = read_surveyed_bearings(path)
        command = f"sonar-tracking import wav FILE.wav --truth {path} ..."
        return f"true bearings at {len(bearings)} instants", [], command
    if "range_m" in columns:
        contacts = read_contact_lines(path, DEFAULT_EPOCH)
        count = int(np.sum(np.isfinite(contacts.range)))
        what = f"{count} contacts, {_span(contacts.stamp)}"
        return what, contacts.bad, f"sonar-tracking import contacts {path} --output bag"
    if columns & set(DIRECTIONS):
        lines = read_bearing_lines(path, DEFAULT_EPOCH)
        what = f"{len(lines.stamp)} bearings of {len(set(lines.sensor.tolist()))} sensors, "
        places = " --stations FILE" if len(set(lines.sensor.tolist())) > 1 else ""
        command = f"sonar-tracking import bearings {path}{places} --output bag"
        return what + _span(lines.stamp), list(lines.notes), command
    if east_north and "target" in columns:
        targets, told = read_true_positions(path, DEFAULT_EPOCH)
        stamps = np.concatenate([each.stamp for each in targets.values()])
        what = f"true positions of {len(targets)} targets, {_span(np.sort(stamps))}"
        return what, list(told), f"sonar-tracking import contacts FILE --truth {path} --output bag"
    if east_north and "sensor" in columns:
        stations, told = read_stations(path)
        command = f"sonar-tracking import bearings FILE --stations {path} --output bag"
        return f"the places of {len(stations)} stations", list(told), command
    if east_north and columns & set(TIMES):
        own, told = read_own_ship(path, DEFAULT_EPOCH)
        command = f"sonar-tracking import contacts FILE --own-ship {path} --output bag"
        return f"{len(own.stamp)} positions of own ship, {_span(own.stamp)}", list(told), command
    names = ", ".join(shown(name) for name in sorted(columns)[:20]) or "no columns"
    raise ConfigurationError(
        f"{path} is no format that is known: it has {names}. Contacts need range_m and a "
        f"direction, bearings one of {', '.join(DIRECTIONS)}, own ship east_m and north_m, each "
        f"with time_s or unix_time_s; {PAGE}."
    )


def _study(keys: set[str], path: Path) -> Inspected | None:
    if {"rir", "fs_hz"} <= keys:
        name, what = "room-array", "measured responses of an array"
    elif any(key.endswith("_az_deg") for key in keys):
        name, what = "ship-bearings", "measured directions of arrays on the sea floor"
    else:
        return None
    return what, [], f"sonar-tracking evaluate {name} --data {path}"


def _span(stamp: IntArray) -> str:
    return f"{instant_text(int(stamp[0]))} to {instant_text(int(stamp[-1]))}"
