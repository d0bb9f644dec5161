"""Recorded contacts become a bag that can be replayed: pings, own ship, and the truth if known.

The file formats are those of :mod:`sonar_tracking.bags.importers.contact_file`. A line that cannot
be used is left out and named. Each ping tells where its sensor was, so that a replay needs nothing
else.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sonar_tracking.bags.contents.metadata import OfferedQuality
from sonar_tracking.bags.contents.recording_information import RecordingInformation
from sonar_tracking.bags.importers.contact_file import ContactLines, read_contact_lines
from sonar_tracking.bags.importers.contact_messages import (
    CONTACTS_TYPE,
    TRACKS_TYPE,
    contacts_cdr,
    odometry_cdr,
    truth_tracks_cdr,
)
from sonar_tracking.bags.positions.given_files import Files
from sonar_tracking.bags.positions.map_origin import MapOrigin
from sonar_tracking.bags.positions.nmea_log import NmeaLogs
from sonar_tracking.bags.positions.own_ship_track import (
    OwnShipMotion,
    checked_coverage,
    own_ship_at,
)
from sonar_tracking.bags.positions.position_files import read_own_ship
from sonar_tracking.bags.positions.surveyed_positions import SurveyedPositions
from sonar_tracking.bags.positions.true_tracks import true_tracks_at
from sonar_tracking.bags.storage.writer import new_bag
from sonar_tracking.configuration import parameter
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.message_reading.own_ship_reading import ODOMETRY_TYPE
from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import FloatArray, IndexArray
from sonar_tracking.records.contacts import Contacts
from sonar_tracking.records.datum import Datum
from sonar_tracking.records.positions import TruthTracks
from sonar_tracking.records.time import END_OF_DATA, NANOSECONDS, seconds
from sonar_tracking.simulation.scenarios.scenario import DEFAULT_EPOCH

CONTACTS_TOPIC = "/active/contacts"
ODOMETRY_TOPIC = "/own_ship/odometry"
TRUTH_TOPIC = "/truth/tracks"

DEFAULT_NODE_PARAMETERS: Mapping[str, Mapping[str, Any]] = {"hpda_tracker": {}}
"""Nodes a replay starts where nothing else is asked for, with their default parameters."""

_Message = tuple[int, str, bytes]
"""Stamp, topic, serialised message."""


@dataclass(frozen=True)
class ContactSensor:
    """What a file of contacts does not tell of its sensor."""

    sensor_id: str = parameter("sonar", "name of the sensor in the messages")
    range_deviation: float = parameter(
        0.0, "standard deviation of ranges without their own; 0 = none", unit="m", minimum=0.0
    )
    bearing_deviation_deg: float = parameter(
        0.0,
        "standard deviation of directions without their own; 0 = none",
        unit="deg",
        minimum=0.0,
        maximum=180.0,
    )
    maximum_range: float = parameter(
        0.0, "of the survey; 0 = the farthest contact", unit="m", minimum=0.0
    )
    latency: float = parameter(
        0.0, "by which the times are later than the pings", unit="s", minimum=-1e4, maximum=1e4
    )
    epoch: int = parameter(DEFAULT_EPOCH, "instant of time_s = 0", unit="ns", minimum=1)


@dataclass(frozen=True)
class RecordedPings:
    """What was read.

    Attributes
    ----------
    pings : tuple of Contacts
        In order of time; azimuths in ``map``.
    own_ship : OwnShipMotion
        At the pings.
    truth : tuple of TruthTracks
        At the pings; empty = not known.
    notes : tuple of str
        A sentence for each line left out, and for what was assumed.
    """

    pings: tuple[Contacts, ...]
    own_ship: OwnShipMotion
    truth: tuple[TruthTracks, ...]
    notes: tuple[str, ...]


def read_pings(
    file: Path | str,
    sensor: ContactSensor,
    own_ship: Files | None = None,
    truth: Files | None = None,
    origin: MapOrigin | None = None,
) -> RecordedPings:
    """Read recorded contacts.

    Parameters
    ----------
    file : Path or str
        CSV or npz of contacts; see :mod:`sonar_tracking.bags.importers.contact_file`.
    sensor : ContactSensor
        What the file does not tell.
    own_ship, truth : Path, str, or sequence of them, optional
        CSV, npz or NMEA logs of own ship's and of the targets' positions.
    origin : MapOrigin, optional
        The datum; default: the first place that a file tells, if one does.

    Raises
    ------
    ConfigurationError
        If a file cannot be used.
    """
    origin = origin or MapOrigin()
    lines = read_contact_lines(file, sensor.epoch, origin)
    _check_deviations(lines, sensor)
    notes = list(lines.bad)
    logs = NmeaLogs()
    surveyed = _surveyed_own_ship(file, lines, own_ship, sensor.epoch, origin, logs, notes)
    stamps, first = np.unique(lines.stamp, return_index=True)
    stamps = stamps - round(sensor.latency * NANOSECONDS)
    motion = own_ship_at(surveyed, stamps)
    notes.extend(checked_coverage(surveyed, stamps))
    groups = np.split(np.arange(len(lines.stamp)), first[1:])
    heard = lines.range[np.isfinite(lines.range)]
    farthest = float(np.max(heard)) if len(heard) else np.nan
    pings = tuple(
        _ping(lines, rows, motion, index, sensor, sensor.maximum_range or farthest)
        for index, rows in enumerate(groups)
    )
    true = true_tracks_at(truth, stamps, sensor.epoch, notes, origin, logs)
    return RecordedPings(pings, motion, true, tuple(dict.fromkeys([*notes, *origin.notes])))


def import_contacts(
    file: Path | str,
    output: Path | str,
    sensor: ContactSensor,
    own_ship: Files | None = None,
    truth: Files | None = None,
    node_parameters: Mapping[str, Mapping[str, Any]] = DEFAULT_NODE_PARAMETERS,
    datum: Datum | None = None,
) -> str:
    """Bring recorded contacts into a bag; return what was done, in words.

    Parameters
    ----------
    file, sensor, own_ship, truth
        See :func:`read_pings`.
    output : Path or str
        The new bag.
    node_parameters : mapping of mapping
        Node, parameter, value: what a replay of the bag starts.
    datum : Datum, optional
        Of ``map``; default: the first place that a file tells, if one does.

    Raises
    ------
    ConfigurationError
        If a file cannot be used, or the bag not be made; no bag is left then.
    """
    origin = MapOrigin(datum)
    recorded = read_pings(file, sensor, own_ship, truth, origin)
    path = Path(output)
    information = _information(Path(file), recorded, node_parameters, origin)
    _write(path, recorded, information)
    count = sum(len(ping.range) for ping in recorded.pings)
    duration = seconds(recorded.pings[-1].stamp - recorded.pings[0].stamp)
    targets = len({target for entry in recorded.truth for target in entry.id.tolist()})
    told = f", truth of {targets} targets" if recorded.truth else ""
    summary = (
        f"{path}: {count} contacts in {len(recorded.pings)} pings over {duration:.1f} s{told}."
    )
    return "\n".join([summary, *recorded.notes])


def _surveyed_own_ship(
    file: Path | str,
    lines: ContactLines,
    own_ship: Files | None,
    epoch: int,
    origin: MapOrigin,
    logs: NmeaLogs,
    notes: list[str],
) -> SurveyedPositions:
    told = np.isfinite(lines.own_ship[:, :2]).all(axis=1)
    if own_ship is not None:
        surveyed, bad = read_own_ship(own_ship, epoch, origin, logs)
        notes.extend(bad)
    elif told.any():
        stamp, first = np.unique(lines.stamp[told], return_index=True)
        rows = lines.own_ship[told][first]
        surveyed = SurveyedPositions(stamp, rows[:, :2], rows[:, 2], f"own ship in {file}")
    else:
        notes.append(f"{file} does not tell where own ship was: it rests at the origin.")
        surveyed = SurveyedPositions(lines.stamp[:1], np.zeros((1, 2)), np.array([np.nan]))
    if lines.relative and np.isnan(surveyed.azimuth).all():
        raise ConfigurationError(
            f"{file} has relative_bearing_deg, but own ship's heading is not known; give "
            "own_heading_deg with every contact, or heading_deg in the file of own ship."
        )
    return surveyed


def _ping(
    lines: ContactLines,
    rows: IndexArray,
    motion: OwnShipMotion,
    index: int,
    sensor: ContactSensor,
    maximum_range: float,
) -> Contacts:
    rows = rows[np.isfinite(lines.range[rows])]
    bow = motion.azimuth[index] if lines.relative else 0.0
    stamps = motion.stamp
    last = index + 1 == len(stamps)
    interval = seconds(float(np.median(np.diff(stamps)))) if len(stamps) > 1 else np.nan
    if not last:
        interval = seconds(int(stamps[index + 1] - stamps[index]))
    return Contacts(
        stamp=int(stamps[index]),
        range=lines.range[rows],
        azimuth=wrap_angle(lines.azimuth[rows] + bow),
        amplitude=_amplitudes(lines, rows),
        range_standard_deviation=_deviations(lines.range_deviation[rows], sensor.range_deviation),
        azimuth_standard_deviation=_deviations(
            lines.azimuth_deviation[rows], float(np.radians(sensor.bearing_deviation_deg))
        ),
        sensor_position=(float(motion.position[index, 0]), float(motion.position[index, 1])),
        sensor_velocity=(float(motion.velocity[index, 0]), float(motion.velocity[index, 1])),
        maximum_range=maximum_range,
        next_stamp=END_OF_DATA if last else int(stamps[index + 1]),
        ping_interval=interval,
        sensor_id=sensor.sensor_id,
        sensor_yaw=float(wrap_angle(motion.azimuth[index])),
    )


def _amplitudes(lines: ContactLines, rows: IndexArray) -> FloatArray:
    """Return the amplitudes of the contacts of a ping; none unless all of them are known."""
    own = lines.amplitude[rows] if len(lines.amplitude) else np.zeros(0)
    return own if np.isfinite(own).all() else np.zeros(0)


def _deviations(own: FloatArray, common: float) -> FloatArray:
    return np.where(np.isfinite(own), own, common)


def _check_deviations(lines: ContactLines, sensor: ContactSensor) -> None:
    """Refuse contacts of which neither file nor options tell how exact they are."""
    told = {
        "--range-deviation (m)": (lines.range_deviation, sensor.range_deviation),
        "--bearing-deviation-deg": (lines.azimuth_deviation, sensor.bearing_deviation_deg),
    }
    heard = np.isfinite(lines.range)
    lacking = [
        option for option, (own, common) in told.items()
        if common <= 0.0 and np.isnan(own[heard]).any()
    ]  # fmt: skip
    if lacking:
        raise ConfigurationError(
            f"The contacts do not tell how exact they are; give {' and '.join(lacking)}, or a "
            "column of it."
        )


def _information(
    file: Path,
    recorded: RecordedPings,
    node_parameters: Mapping[str, Mapping[str, Any]],
    origin: MapOrigin,
) -> RecordingInformation:
    scenario = {
        "name": file.stem,
        "description": f"imported from {file.name}: {len(recorded.pings)} pings",
        **origin.scenario(),
    }
    roles: dict[str, Any] = {CONTACTS_TOPIC: "input", ODOMETRY_TOPIC: "input"}
    if recorded.truth:
        roles[TRUTH_TOPIC] = "truth"
    return RecordingInformation(scenario, node_parameters, roles)


def _write(path: Path, recorded: RecordedPings, information: RecordingInformation) -> None:
    with new_bag(path, information) as writer:
        writer.add_topic(CONTACTS_TOPIC, CONTACTS_TYPE, role="input")
        writer.add_topic(ODOMETRY_TOPIC, ODOMETRY_TYPE, role="input")
        if recorded.truth:
            quality = OfferedQuality(durability="transient_local")
            writer.add_topic(TRUTH_TOPIC, TRACKS_TYPE, role="truth", qos=quality)
        for stamp, topic, data in _messages(recorded):
            writer.write(topic, stamp, data)


def _messages(recorded: RecordedPings) -> Iterator[_Message]:
    """Yield all messages by stamp: own ship and truth ahead of the ping they belong to."""
    states = (recorded.own_ship.state(index) for index in range(len(recorded.pings)))
    odometry = ((state.stamp, ODOMETRY_TOPIC, odometry_cdr(state)) for state in states)
    truth = ((entry.stamp, TRUTH_TOPIC, truth_tracks_cdr(entry)) for entry in recorded.truth)
    pings = ((ping.stamp, CONTACTS_TOPIC, contacts_cdr(ping)) for ping in recorded.pings)
    yield from heapq.merge(odometry, truth, pings, key=lambda message: message[0])
