"""Recorded bearings become a bag whose replay finds positions.

The file formats are those of :mod:`sonar_tracking.bags.importers.bearing_file`. Bearings without a
label get their tracks by :mod:`sonar_tracking.bags.importers.bearing_association`; true and
relative bearings are told in ``map``, so that own ship's turns are none of theirs. A sensor that is
no station of ``--stations`` is aboard own ship.
"""

from __future__ import annotations

import heapq
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sonar_tracking.bags.contents.metadata import OfferedQuality
from sonar_tracking.bags.contents.recording_information import RecordingInformation
from sonar_tracking.bags.importers.bearing_file import (
    CONES,
    FROM_THE_BOW,
    BearingLines,
    StationPlace,
    read_bearing_lines,
    read_stations,
)
from sonar_tracking.bags.importers.bearing_messages import (
    bearing_tracks_cdr,
    frequency_lines_cdr,
)
from sonar_tracking.bags.importers.bearing_pictures import SensorBearings, bearing_pictures
from sonar_tracking.bags.importers.bearings_of_sensor import BearingSensor, bearings_of_sensor
from sonar_tracking.bags.importers.contact_messages import (
    TRACKS_TYPE,
    odometry_cdr,
    truth_tracks_cdr,
)
from sonar_tracking.bags.importers.import_contacts import ODOMETRY_TOPIC, TRUTH_TOPIC
from sonar_tracking.bags.positions.given_files import Files
from sonar_tracking.bags.positions.map_origin import MapOrigin
from sonar_tracking.bags.positions.nmea_log import NmeaLogs
from sonar_tracking.bags.positions.own_ship_track import (
    OwnShipMotion,
    checked_coverage,
    own_ship_at,
)
from sonar_tracking.bags.positions.position_files import read_own_ship
from sonar_tracking.bags.positions.true_tracks import true_tracks_at
from sonar_tracking.bags.storage.bag_records import BEARING_TRACKS_TYPE, FREQUENCY_LINES_TYPE
from sonar_tracking.bags.storage.writer import new_bag
from sonar_tracking.errors import ConfigurationError, shown
from sonar_tracking.message_reading.own_ship_reading import ODOMETRY_TYPE
from sonar_tracking.records.bearings import Sensor
from sonar_tracking.records.datum import Datum
from sonar_tracking.records.own_ship import OWN_SHIP_FRAMES
from sonar_tracking.records.positions import MAP_FRAME
from sonar_tracking.records.time import seconds

BEARINGS_BELOW, LINES_BELOW = "passive/bearing_tracks", "passive/frequency_lines"

Message = tuple[int, str, bytes]
"""Stamp, topic, serialised message."""

_NOT_IN_A_NAME = re.compile(r"[^A-Za-z0-9_]+")


@dataclass(frozen=True)
class BearingSources:
    """Files beside that of the bearings.

    Attributes
    ----------
    stations : Path or str, optional
        CSV or npz of where stations are.
    own_ship, truth : Path, str, or sequence of them, optional
        CSV, npz or NMEA logs of own ship's and of the targets' positions.
    datum : Datum, optional
        Of ``map``; default: the first place that a file tells, if one does.
    """

    stations: Path | str | None = None
    own_ship: Files | None = None
    truth: Files | None = None
    datum: Datum | None = None


def sensor_topics(names: list[str]) -> dict[str, tuple[str, str]]:
    """Return the topics of bearing tracks and lines of each sensor; one alone needs no name.

    Parameters
    ----------
    names : list of str
        Of the sensors.
    """
    if len(names) == 1:
        return {names[0]: (f"/{BEARINGS_BELOW}", f"/{LINES_BELOW}")}
    below: dict[str, str] = {}
    for number, name in enumerate(names, start=1):
        plain = _NOT_IN_A_NAME.sub("_", name).strip("_")
        plain = plain if plain and not plain[0].isdigit() else f"sensor_{plain or number}"
        below[name] = plain if plain not in below.values() else f"{plain}_{number}"
    return {name: (f"/{b}/{BEARINGS_BELOW}", f"/{b}/{LINES_BELOW}") for name, b in below.items()}


def import_bearings(
    file: Path | str,
    output: Path | str,
    sensor: BearingSensor,
    sources: BearingSources,
    settings_of: Callable[[list[tuple[str, str]]], Mapping[str, Mapping[str, Any]]],
) -> str:
    """Bring recorded bearings into a bag; return what was done, in words.

    Parameters
    ----------
    file : Path or str
        CSV or npz of bearings.
    output : Path or str
        The new bag.
    sensor : BearingSensor
        What the file does not tell.
    sources : BearingSources
        Files beside it.
    settings_of : callable
        Returns what a replay of the bag starts (node, parameter, value), of the topics of the
        bearing tracks and of the lines of each sensor; without lines their topic is empty.

    Raises
    ------
    ConfigurationError
        If a file cannot be used, or the bag not be made; no bag is left then.
    """
    lines = read_bearing_lines(file, sensor.epoch)
    notes = list(lines.notes)
    names = list(dict.fromkeys(lines.sensor.tolist()))
    origin, logs = MapOrigin(sources.datum), NmeaLogs()
    stations, motion = _places(file, lines, names, sources, sensor.epoch, origin, logs, notes)
    topics = sensor_topics(names)
    heard = {
        name: bearings_of_sensor(lines, name, sensor, motion, stations, notes) for name in names
    }
    with_lines = {name for name, one in heard.items() if any(one.frequencies)}
    used = [(topics[n][0], topics[n][1] if n in with_lines else "") for n in names]
    stamps = np.unique(lines.stamp)
    truth = true_tracks_at(sources.truth, stamps, sensor.epoch, notes, origin, logs)
    notes += origin.notes
    messages = [
        _messages(heard[n], topics[n], _sensor_at(n, lines, stations, motion)) for n in names
    ]
    if motion is not None:
        states = (motion.state(index) for index in range(len(motion.stamp)))
        messages.append((state.stamp, ODOMETRY_TOPIC, odometry_cdr(state)) for state in states)
    messages.append((entry.stamp, TRUTH_TOPIC, truth_tracks_cdr(entry)) for entry in truth)
    types = {topic: BEARING_TRACKS_TYPE for topic, _ in used}
    types |= {topic: FREQUENCY_LINES_TYPE for _, topic in used if topic}
    types |= {ODOMETRY_TOPIC: ODOMETRY_TYPE} if motion is not None else {}
    roles: dict[str, Any] = dict.fromkeys(types, "input")
    roles |= {TRUTH_TOPIC: "truth"} if truth else {}
    path = Path(file)
    described = {"name": path.stem, "description": f"imported from {path.name}: bearings"}
    scenario = {**described, **origin.scenario()}
    information = RecordingInformation(scenario, settings_of(used), roles)
    _write(Path(output), information, types, heapq.merge(*messages, key=lambda each: each[0]))
    return "\n".join([_summary(Path(output), lines, heard), *dict.fromkeys(notes)])


def _summary(output: Path, lines: BearingLines, heard: dict[str, SensorBearings]) -> str:
    duration = seconds(int(lines.stamp[-1] - lines.stamp[0]))
    told = [
        f"{name}: {len(one.stamp)} bearings, {len(np.unique(one.number[one.number > 0]))} tracks, "
        f"{int(np.sum(one.number == 0))} of no track"
        for name, one in heard.items()
    ]
    return f"{output}: {len(lines.stamp)} lines over {duration:.1f} s. {'; '.join(told)}."


def _places(
    file: Path | str,
    lines: BearingLines,
    names: list[str],
    sources: BearingSources,
    epoch: int,
    origin: MapOrigin,
    logs: NmeaLogs,
    notes: list[str],
) -> tuple[dict[str, StationPlace], OwnShipMotion | None]:
    """Return where the stations are, and own ship at the stamps of the bearings."""
    stations: dict[str, StationPlace] = {}
    if sources.stations is not None:
        stations, bad = read_stations(sources.stations, origin)
        notes.extend(bad)
    aboard = [name for name in names if name not in stations]
    motion = None
    if sources.own_ship is not None:
        surveyed, bad = read_own_ship(sources.own_ship, epoch, origin, logs)
        notes.extend(bad)
        stamps = np.unique(lines.stamp)
        notes.extend(checked_coverage(surveyed, stamps))
        motion = own_ship_at(surveyed, stamps)
    elif aboard and (stations or len(names) > 1):
        raise ConfigurationError(
            f"Where {', '.join(shown(n) for n in aboard)} of {file} is, is not told; name it in "
            "--stations, or give --own-ship if it is aboard."
        )
    elif aboard:
        notes.append(
            f"{file} does not tell where its sensor was: it rests at the origin, and bearings of "
            "one place give no positions; give --own-ship or --stations."
        )
        stations = {aboard[0]: StationPlace((0.0, 0.0, 0.0))}
    facing = [n for n in names if n in stations and np.isnan(stations[n].azimuth)]
    if lines.kind in FROM_THE_BOW and facing:
        raise ConfigurationError(
            f"{file} has {lines.kind}, but where {', '.join(shown(n) for n in facing)} faces is "
            "not known; give heading_deg in --stations, or --own-ship with heading_deg."
        )
    return stations, motion


def _sensor_at(
    name: str,
    lines: BearingLines,
    stations: dict[str, StationPlace],
    motion: OwnShipMotion | None,
) -> Callable[[int], Sensor]:
    cone = lines.kind in CONES
    turned = cone and name in stations

    def fixed(stamp: int) -> Sensor:
        place = stations[name]
        half = 0.5 * place.azimuth if turned else 0.0
        turn = (0.0, 0.0, float(np.sin(half)), float(np.cos(half)))
        frame = sensor_topics([name, ""])[name][0].split("/")[1] if cone else MAP_FRAME
        return Sensor(name, frame, place.position, turn, (0.0, 0.0, 0.0))

    def aboard(stamp: int) -> Sensor:
        assert motion is not None
        index = int(np.searchsorted(motion.stamp, stamp))
        half = 0.5 * float(motion.azimuth[index]) if cone else 0.0
        x, y = motion.position[index]
        vx, vy = motion.velocity[index]
        turn = (0.0, 0.0, float(np.sin(half)), float(np.cos(half)))
        frame = f"{OWN_SHIP_FRAMES}array" if cone else MAP_FRAME
        return Sensor(name, frame, (float(x), float(y), 0.0), turn, (float(vx), float(vy), 0.0))

    return fixed if name in stations else aboard


def _messages(
    bearings: SensorBearings, topics: tuple[str, str], sensor_at: Callable[[int], Sensor]
) -> Iterator[Message]:
    for tracks, lines in bearing_pictures(bearings, sensor_at):
        yield tracks.stamp, topics[0], bearing_tracks_cdr(tracks)
        if lines is not None:
            yield lines.stamp, topics[1], frequency_lines_cdr(lines)


def _write(
    path: Path,
    information: RecordingInformation,
    types: dict[str, str],
    messages: Iterator[Message],
) -> None:
    with new_bag(path, information) as writer:
        for topic, type_name in types.items():
            writer.add_topic(topic, type_name, role="input")
        if TRUTH_TOPIC in information.topic_roles:
            quality = OfferedQuality(durability="transient_local")
            writer.add_topic(TRUTH_TOPIC, TRACKS_TYPE, role="truth", qos=quality)
        for stamp, topic, data in messages:
            writer.write(topic, stamp, data)
