"""What a file is, what is wrong with it, and the command that imports it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from sonar_tracking.bags.audio.audio_inspection import inspect_audio
from sonar_tracking.bags.audio.open_audio import AUDIO_ENDINGS
from sonar_tracking.bags.importers.array_geometry_file import read_array_geometry
from sonar_tracking.bags.importers.array_plausibility import (
    doubts_of_geometry,
    highest_frequency,
)
from sonar_tracking.bags.importers.bearing_file import (
    DIRECTIONS,
    read_bearing_lines,
    read_stations,
)
from sonar_tracking.bags.importers.bearing_truth_file import read_surveyed_bearings
from sonar_tracking.bags.importers.contact_file import read_contact_lines
from sonar_tracking.bags.nmea.ais_reports import FORMATS
from sonar_tracking.bags.nmea.own_ship_sentences import READERS
from sonar_tracking.bags.positions.given_files import files_in
from sonar_tracking.bags.positions.map_origin import MapOrigin
from sonar_tracking.bags.positions.nmea_log import looks_like_nmea, read_nmea_log
from sonar_tracking.bags.positions.position_tables import (
    PLACE,
    PLANE,
    own_ship_of_table,
    true_positions_of_table,
)
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.bags.tables.line_notes import LineNotes
from sonar_tracking.bags.tables.npz_file import read_npz
from sonar_tracking.bags.tables.number_table import table_cells
from sonar_tracking.bags.tables.table_times import TIMES, instant_text
from sonar_tracking.errors import ConfigurationError, shown
from sonar_tracking.records.arrays import FloatArray, IntArray
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
    if path.is_dir() and not any(each.suffix.lower() in BAGS for each in path.iterdir()):
        return _directory
    if path.is_dir() or suffix in BAGS:
        return _bag
    if suffix in (".yaml", ".yml"):
        return _geometry
    if suffix != ".npz" and looks_like_nmea(path):
        return _nmea
    return _table


def _directory(path: Path) -> Inspected:
    """Inspect each file of a directory; the command is that of the first, with the directory."""
    told, wrong, command = [], [], ""
    for file in files_in(path):
        try:
            what, faults, how = _inspector(file)(file)
        except ConfigurationError as error:
            wrong.append(f"{error} It is left out.")
            continue
        told.append(f"{file.name}: {what}")
        wrong += faults
        command = command or how.replace(str(file), str(path))
    if not told:
        raise ConfigurationError(
            f"{path} is a directory with neither a bag nor a file that can be imported. {wrong[0]}"
        )
    return "\n".join([f"a directory of {len(told)} files", *told]), wrong, command


def _bag(path: Path) -> Inspected:
    bag = read_bag(path)
    topics = ", ".join(f"{n} ({t.message_count})" for n, t in bag.topics.items() if t.message_count)
    return f"a bag with messages of {topics}", [], f"sonar-tracking replay {path}"


def _geometry(path: Path) -> Inspected:
    array = read_array_geometry(path)
    what = (
        f"the geometry of an array of {len(array.element_positions)} elements, "
        f"{array.aperture:.4g} m across, sound speed {array.sound_speed:g} m/s: bearings up to "
        f"{highest_frequency(array):.4g} Hz"
    )
    command = f"sonar-tracking import samples FILE.wav --geometry {path} --frequency HZ"
    return what, doubts_of_geometry(array, str(path)), f"{command} --output bag"


def _nmea(path: Path) -> Inspected:
    log = read_nmea_log(path)
    known = (*READERS, *FORMATS)
    counts = [f"{log.formats[name]} {name}" for name in known if log.formats[name]]
    wrong, told = list(log.wrong), []
    if log.fixes:
        stamps = np.sort(log.stamps(DEFAULT_EPOCH, wrong))
        told.append(f"{len(stamps)} positions of own ship, {_span(stamps)}")
    if log.reports:
        ships = len({report.mmsi for report in log.reports})
        stamps = np.sort(log.stamps(DEFAULT_EPOCH, wrong, ships=True))
        told.append(f"{len(stamps)} AIS reports of {ships} ships, {_span(stamps)}")
    what = f"an NMEA 0183 log ({', '.join(counts) or 'no sentence that is used'}): "
    command = f"sonar-tracking import nmea {path} --output bag"
    if not told:
        return f"{what}neither own ship nor other ships", wrong, f"it is not imported; {PAGE}"
    return what + "; ".join(told), wrong, command


def _table(path: Path) -> Inspected:
    if path.suffix == ".npz":
        study = _study(set(read_npz(path)), path)
        if study is not None:
            return study
    columns = set(table_cells(path, LineNotes(path))[0])
    positions = set(PLANE) <= columns or set(PLACE) <= columns
    if {"target", "arrival_angle_deg"} <= columns:
        bearings, told = read_surveyed_bearings(path, DEFAULT_EPOCH)
        command = f"sonar-tracking import wav FILE.wav --truth {path} ..."
        return f"true bearings at {len(bearings)} instants", list(told), command
    if "range_m" in columns:
        contacts = read_contact_lines(path, DEFAULT_EPOCH)
        count = int(np.sum(np.isfinite(contacts.range)))
        what = f"{count} contacts, {_span(contacts.stamp)}"
        heard = np.isfinite(contacts.range)
        lacking = _lacking("--range-deviation METRES", contacts.range_deviation[heard])
        lacking += _lacking("--bearing-deviation-deg DEGREES", contacts.azimuth_deviation[heard])
        return what, contacts.bad, f"sonar-tracking import contacts {path}{lacking} --output bag"
    if columns & set(DIRECTIONS):
        lines = read_bearing_lines(path, DEFAULT_EPOCH)
        what = f"{len(lines.stamp)} bearings of {len(set(lines.sensor.tolist()))} sensors, "
        places = " --stations FILE" if len(set(lines.sensor.tolist())) > 1 else ""
        places += _lacking("--bearing-deviation-deg DEGREES", lines.deviation)
        command = f"sonar-tracking import bearings {path}{places} --output bag"
        return what + _span(lines.stamp), list(lines.notes), command
    if positions and "target" in columns:
        targets, told = true_positions_of_table(path, DEFAULT_EPOCH, MapOrigin())
        stamps = np.concatenate([each.stamp for each in targets.values()])
        what = f"true positions of {len(targets)} targets, {_span(np.sort(stamps))}"
        return what, list(told), f"sonar-tracking import contacts FILE --truth {path} --output bag"
    if positions and "sensor" in columns:
        stations, told = read_stations(path)
        command = f"sonar-tracking import bearings FILE --stations {path} --output bag"
        return f"the places of {len(stations)} stations", list(told), command
    if positions and columns & set(TIMES):
        own, told = own_ship_of_table(path, DEFAULT_EPOCH, MapOrigin())
        command = f"sonar-tracking import contacts FILE --own-ship {path} --output bag"
        return f"{len(own.stamp)} positions of own ship, {_span(own.stamp)}", list(told), command
    names = ", ".join(shown(name) for name in sorted(columns)[:20]) or "no columns"
    raise ConfigurationError(
        f"{path} is no format that is known: it has {names}. Contacts need range_m and a "
        f"direction, bearings one of {', '.join(DIRECTIONS)}, own ship east_m and north_m "
        f"or latitude_deg and longitude_deg, each with time_s or unix_time_s; {PAGE}."
    )


def _study(keys: set[str], path: Path) -> Inspected | None:
    if {"rir", "fs_hz"} <= keys:
        name, what = "room-array", "measured responses of an array"
    elif any(key.endswith("_t_suspect") for key in keys):
        name, what = "ship-bearings", "measured directions of arrays on the sea floor"
    elif "radar_det_range_m" in keys:
        name, what = "maritime-contacts", "contacts of a radar with the truth"
    else:
        return None
    return what, [], f"sonar-tracking evaluate {name} --data {path}"


def _lacking(option: str, told: FloatArray) -> str:
    """Return an option that stands for what lines do not tell; nothing if all of them do."""
    return "" if np.isfinite(told).all() else f" {option}"


def _span(stamp: IntArray) -> str:
    return f"{instant_text(int(stamp[0]))} to {instant_text(int(stamp[-1]))}"
