"""Logs of NMEA 0183 become a bag: own ship, and other ships by their AIS as the truth.

Such a bag can be shown, drawn and exported; beside the data of a sensor the same logs are given to
the import of these, as ``--own-ship`` and ``--truth``.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from sonar_tracking.bags.contents.metadata import OfferedQuality
from sonar_tracking.bags.contents.recording_information import RecordingInformation
from sonar_tracking.bags.importers.contact_messages import (
    TRACKS_TYPE,
    odometry_cdr,
    truth_tracks_cdr,
)
from sonar_tracking.bags.importers.import_contacts import ODOMETRY_TOPIC, TRUTH_TOPIC
from sonar_tracking.bags.nmea.ship_histories import ShipHistory
from sonar_tracking.bags.positions.given_files import read_each
from sonar_tracking.bags.positions.joined_positions import joined_positions
from sonar_tracking.bags.positions.map_origin import MapOrigin
from sonar_tracking.bags.positions.nmea_log import NmeaLog, epochs_of_logs, read_nmea_log
from sonar_tracking.bags.positions.nmea_tracks import own_ship_of_log, ships_of_logs
from sonar_tracking.bags.positions.own_ship_track import (
    OwnShipMotion,
    checked_coverage,
    own_ship_at,
)
from sonar_tracking.bags.positions.true_tracks import TrueTargets
from sonar_tracking.bags.storage.writer import new_bag
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.message_reading.own_ship_reading import ODOMETRY_TYPE
from sonar_tracking.records.arrays import IntArray
from sonar_tracking.records.datum import Datum
from sonar_tracking.records.positions import TruthTracks
from sonar_tracking.records.time import NANOSECONDS, seconds
from sonar_tracking.simulation.scenarios.scenario import DEFAULT_EPOCH

PERIOD = NANOSECONDS
"""Between two pictures of the other ships, ns."""


def import_nmea(
    files: Sequence[Path | str],
    output: Path | str,
    datum: Datum | None = None,
    epoch: int = DEFAULT_EPOCH,
) -> str:
    """Bring logs into a bag; return what was done, in words.

    Parameters
    ----------
    files : sequence of Path or str
        Logs, or directories of them: of own ship, of AIS, or both; several follow one another.
    output : Path or str
        The new bag.
    datum : Datum, optional
        Of ``map``; default: the first place in the logs.
    epoch : int
        Its date is that of logs without one, ns.

    Raises
    ------
    ConfigurationError
        If a log cannot be used, or the bag not be made; no bag is left then.
    """
    origin, notes = MapOrigin(datum), list[str]()
    logs = read_each(list(dict.fromkeys(files)), read_nmea_log, notes)
    motion = _own_ship(logs, epoch, origin, notes)
    truth = _truth(logs, epoch, origin, notes)
    if motion is None and not truth:
        raise ConfigurationError(
            f"{', '.join(str(log.path) for log in logs)}: neither own ship (GGA, RMC) nor ships "
            f"with AIS (VDM) can be read. {' '.join([*notes, *logs[0].wrong][:2])}".strip()
        )
    path = Path(output)
    _write(path, motion, truth, _information(logs, motion, origin))
    stamps = np.concatenate(
        [np.zeros(0, np.int64) if motion is None else motion.stamp, [t.stamp for t in truth]]
    )
    ships = {mmsi for entry in truth for mmsi in entry.id.tolist()}
    told = [] if motion is None else [f"{len(motion.stamp)} positions of own ship"]
    told += [f"{len(ships)} ships by AIS"] if truth else []
    duration = seconds(int(stamps.max() - stamps.min()))
    summary = f"{path}: {' and '.join(told)} over {duration:.1f} s."
    unique = dict.fromkeys([*notes, *origin.notes])
    return "\n".join([summary, *unique])


def _own_ship(
    logs: list[NmeaLog], epoch: int, origin: MapOrigin, notes: list[str]
) -> OwnShipMotion | None:
    """Return own ship at its own positions; None = no log tells any."""
    told = [log for log in logs if log.fixes]
    if not told:
        return None
    tracks = []
    for log, day in zip(told, epochs_of_logs(told, epoch), strict=True):
        track, bad = own_ship_of_log(log, day, origin)
        tracks.append(track)
        notes.extend(bad)
    surveyed = joined_positions(tracks, notes)
    notes.extend(checked_coverage(surveyed, surveyed.stamp))
    return own_ship_at(surveyed, surveyed.stamp)


def _truth(
    logs: list[NmeaLog],
    epoch: int,
    origin: MapOrigin,
    notes: list[str],
) -> tuple[TruthTracks, ...]:
    """Return pictures of the other ships, one a second; none = no log has any."""
    told = [log for log in logs if log.reports]
    if not told:
        return ()
    ships, bad = ships_of_logs(told, epoch, origin)
    notes.extend(bad)
    return tuple(TrueTargets(ships, {}).pictures(_pictures(ships.values())))


def _pictures(ships: Iterable[ShipHistory]) -> IntArray:
    """Return the whole seconds at which a ship is known, ns, and one more after each run of them.

    The one more shows that nothing is known there: nobody is to interpolate over it.
    """
    runs = [run for ship in ships for run in ship.known_from_to()]
    seconds_of = [np.arange(-(-a // PERIOD), b // PERIOD + 2, dtype=np.int64) for a, b in runs]
    return np.unique(np.concatenate([np.zeros(0, np.int64), *seconds_of])) * PERIOD


def _information(
    logs: list[NmeaLog],
    motion: OwnShipMotion | None,
    origin: MapOrigin,
) -> RecordingInformation:
    names = ", ".join(log.path.name for log in logs)
    scenario = {
        "name": logs[0].path.stem,
        "description": f"imported from {names}",
        **origin.scenario(),
    }
    roles: dict[str, Any] = {} if motion is None else {ODOMETRY_TOPIC: "input"}
    roles[TRUTH_TOPIC] = "truth"
    return RecordingInformation(scenario, {}, roles)


def _write(
    path: Path,
    motion: OwnShipMotion | None,
    truth: tuple[TruthTracks, ...],
    information: RecordingInformation,
) -> None:
    states = () if motion is None else map(motion.state, range(len(motion.stamp)))
    odometry = ((state.stamp, ODOMETRY_TOPIC, odometry_cdr(state)) for state in states)
    pictures = ((entry.stamp, TRUTH_TOPIC, truth_tracks_cdr(entry)) for entry in truth)
    with new_bag(path, information) as writer:
        if motion is not None:
            writer.add_topic(ODOMETRY_TOPIC, ODOMETRY_TYPE, role="input")
        # Without ships, too: a bag without a topic of these messages is taken for a foreign one.
        quality = OfferedQuality(durability="transient_local")
        writer.add_topic(TRUTH_TOPIC, TRACKS_TYPE, role="truth", qos=quality)
        for stamp, topic, data in heapq.merge(odometry, pictures, key=lambda each: each[0]):
            writer.write(topic, stamp, data)
