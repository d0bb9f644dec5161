"""Where own ship and other ships were, of logs of NMEA 0183."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence

import numpy as np

from sonar_tracking.bags.nmea.own_ship_fixes import SLOW
from sonar_tracking.bags.nmea.ship_histories import FAR, LEAPS, ShipHistory, vectors
from sonar_tracking.bags.positions.given_files import files_text
from sonar_tracking.bags.positions.map_origin import MapOrigin
from sonar_tracking.bags.positions.nmea_log import NmeaLog, epochs_of_logs
from sonar_tracking.bags.positions.surveyed_positions import SurveyedPositions
from sonar_tracking.errors import InputError
from sonar_tracking.geodesy import north_azimuths
from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import FloatArray, IntArray


def own_ship_of_log(
    log: NmeaLog, epoch: int, origin: MapOrigin
) -> tuple[SurveyedPositions, tuple[str, ...]]:
    """Return own ship's track in ``map``, and what was not used or assumed.

    Parameters
    ----------
    log : NmeaLog
        The log.
    epoch : int
        Its date is taken where the log tells none, ns.
    origin : MapOrigin
        The datum.

    Raises
    ------
    ConfigurationError
        If the log does not tell where own ship was.
    """
    log.check_own_ship()
    notes = list(log.wrong)
    stamp = log.stamps(epoch, notes)
    if (np.diff(stamp) < 0).any():
        notes.append(f"{log.path}: times go back; the positions are sorted by time.")
    stamp, order = np.unique(stamp, return_index=True)
    columns = np.array(
        [(f.latitude_deg, f.longitude_deg, f.heading_deg, f.course_deg, f.speed) for f in log.fixes]
    )[order]
    latitude, longitude, heading, course, speed = columns.T
    position = origin.positions(latitude, longitude, str(log.path))
    near = np.isfinite(position[:, 0])
    if not near.all():
        notes.append(
            f"{log.path}: {np.sum(~near)} positions lie farther than 200 km from the datum; they "
            "are not used."
        )
    assert origin.datum is not None
    north = north_azimuths(latitude, longitude, origin.datum)
    if log.course_for_heading:
        notes.append(
            f"{log.path}: {log.course_for_heading} of {len(log.fixes)} positions come without a "
            "heading (HDT or VHW): that around, or else the course made good, is taken."
        )
    if np.isnan(heading).all():
        heading = np.where(speed >= SLOW, course, np.nan)
    azimuth = wrap_angle(north - np.radians(heading))
    velocity = vectors(speed, course, north)
    surveyed = SurveyedPositions(
        stamp[near], position[near], azimuth[near], str(log.path), velocity[near]
    )
    return surveyed, tuple(notes)


def ships_of_logs(
    logs: Sequence[NmeaLog], epoch: int, origin: MapOrigin
) -> tuple[dict[int, ShipHistory], tuple[str, ...]]:
    """Return the reports of other ships in ``map`` by their MMSI, and what was not used.

    Parameters
    ----------
    logs : sequence of NmeaLog
        At least one; several follow one another.
    epoch : int
        Its date is taken where the first log tells none, ns.
    origin : MapOrigin
        The datum.

    Raises
    ------
    ConfigurationError
        If a log does not tell where other ships were.
    """
    for log in logs:
        log.check_ships()
    notes: list[str] = []
    stamps, states = [], []
    for log, day in zip(logs, epochs_of_logs(logs, epoch), strict=True):
        notes += log.wrong
        stamps.append(log.stamps(day, notes, ships=True))
        states.append(_report_states(log, origin))
    stamp = np.concatenate(stamps)
    order = np.argsort(stamp, kind="stable")
    numbers = [report.mmsi for log in logs for report in log.reports]
    numbers = [numbers[row] for row in order]
    ships, faults = _histories(numbers, stamp[order], np.concatenate(states)[order])
    source = files_text([log.path for log in logs])
    notes += [f"{source}: {count} times {sentence}." for sentence, count in faults.items()]
    gaps = sum(len(ship.known_from_to()) - 1 for ship in ships.values() if ship.stamps)
    if gaps:
        notes.append(
            f"{source}: {gaps} times a ship is not heard for more than 90 s (7 min where it lies "
            "still): it is in no truth meanwhile."
        )
    return ships, tuple(notes)


def _report_states(log: NmeaLog, origin: MapOrigin) -> FloatArray:
    """Return x, y, vx, vy of the reports of a log in ``map``, shape (n, 4), m and m/s."""
    columns = np.array(
        [(r.latitude_deg, r.longitude_deg, r.speed, r.course_deg) for r in log.reports]
    )
    latitude, longitude, speed, course = columns.T
    position = origin.positions(latitude, longitude, str(log.path))
    assert origin.datum is not None
    velocity = vectors(speed, course, north_azimuths(latitude, longitude, origin.datum))
    return np.concatenate([position, velocity], axis=1)


def _histories(
    numbers: list[int], stamp: IntArray, states: FloatArray
) -> tuple[dict[int, ShipHistory], Counter[str]]:
    ships: dict[int, ShipHistory] = {}
    faults: Counter[str] = Counter()
    for index, mmsi in enumerate(numbers):
        if math.isnan(states[index, 0]):
            faults[FAR] += 1
            continue
        try:
            ships.setdefault(mmsi, ShipHistory()).add(int(stamp[index]), states[index])
        except InputError:
            faults[LEAPS] += 1
    return ships, faults
