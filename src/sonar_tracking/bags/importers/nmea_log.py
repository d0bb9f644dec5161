"""A log of NMEA 0183: own ship's track, and other ships by their AIS.

Sentences may be mixed, of any talkers, and with noise between them: what cannot be used is counted
by kind. See :mod:`sonar_tracking.bags.nmea`.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sonar_tracking.bags.importers.line_notes import LineNotes
from sonar_tracking.bags.importers.map_origin import MapOrigin
from sonar_tracking.bags.importers.surveyed_positions import SurveyedPositions
from sonar_tracking.bags.nmea.ais_reports import FORMATS, AisReport, AisReports, is_ais
from sonar_tracking.bags.nmea.own_ship_fixes import SLOW, OwnShipFix, OwnShipFixes
from sonar_tracking.bags.nmea.own_ship_sentences import READERS, own_ship_report
from sonar_tracking.bags.nmea.sentence_time import DAY, SentenceTime
from sonar_tracking.bags.nmea.sentences import lines_of, parts_of, read_sentence
from sonar_tracking.bags.nmea.ship_histories import FAR, LEAPS, ShipHistory, vectors
from sonar_tracking.errors import ConfigurationError, InputError, shown
from sonar_tracking.geodesy import north_azimuths
from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import FloatArray, IntArray
from sonar_tracking.records.time import NANOSECONDS

_READ_AT_ONCE = 65_536


@dataclass(frozen=True)
class NmeaLog:
    """What a log holds.

    Attributes
    ----------
    path : Path
        The log.
    fixes : tuple of OwnShipFix
        Own ship, in the order of the log.
    reports : tuple of AisReport
        Other ships, in the order of the log.
    time : SentenceTime
        The time line of both.
    formats : Counter of str
        How many good sentences of each format there are.
    wrong : list of str
        What was not used, a sentence a kind.
    course_for_heading : int
        Fixes without a heading.
    """

    path: Path
    fixes: tuple[OwnShipFix, ...]
    reports: tuple[AisReport, ...]
    time: SentenceTime
    formats: Counter[str]
    wrong: list[str]
    course_for_heading: int

    def stamps(self, epoch: int, notes: list[str], ships: bool = False) -> IntArray:
        """Return the stamps of the fixes, or of the reports of other ships.

        Parameters
        ----------
        epoch : int
            Its date is that of the first sentence where none is told, ns.
        notes : list of str
            Told if that is so.
        ships : bool
            Whether those of the reports are asked for.

        Returns
        -------
        ndarray of int, shape (n,)
            ns, in the order of the log.
        """
        day = epoch // (round(DAY) * NANOSECONDS)
        if not self.time.is_dated:
            date = np.datetime64(int(day), "D")
            sentence = (
                f"{self.path} has times of day but no date (RMC or ZDA): its first sentence is "
                f"taken to be of {date}; give --epoch of that day, or log RMC too."
            )
            if sentence not in notes:
                notes.append(sentence)
        instants = [each.instant for each in (self.reports if ships else self.fixes)]
        return np.array([self.time.stamp(each, day) for each in instants], dtype=np.int64)


def looks_like_nmea(path: Path | str) -> bool:
    """Return whether one of the first lines of a file is a sentence."""
    if Path(path).suffix == ".npz":
        return False
    try:
        with Path(path).open("rb") as file:
            return any(_is_sentence(line) for line in lines_of(file.read(8192)))
    except OSError:
        return False


def read_nmea_log(path: Path | str) -> NmeaLog:
    """Read a log.

    Parameters
    ----------
    path : Path or str
        The file.

    Raises
    ------
    ConfigurationError
        If it cannot be read, or holds no sentence.
    """
    path = Path(path)
    notes, formats, time = LineNotes(path), Counter[str](), SentenceTime()
    own_ship, ais = OwnShipFixes(time), AisReports(time)
    fixes: list[OwnShipFix | None] = []
    reports: list[AisReport | None] = []
    for number, line in _numbered_lines(path):
        try:
            sentence = read_sentence(line)
            formats[shown(sentence.format, 8)] += 1
            report = own_ship_report(sentence)
            if report is not None:
                fixes.append(own_ship.take(report))
            elif is_ais(sentence):
                reports.append(ais.take(sentence))
        except InputError as error:
            notes.line(number, str(error))
    fixes.append(own_ship.close())
    if not formats:
        told = " ".join(notes.sentences()[:3])
        raise ConfigurationError(f"The file {path} holds no sentence of NMEA 0183. {told}".strip())
    wrong = notes.sentences()
    others = {name: n for name, n in formats.items() if name not in (*READERS, *FORMATS)}
    if others:
        told = ", ".join(f"{n} {name}" for name, n in Counter(others).most_common(8))
        wrong.append(f"{path}: sentences of other kinds are not used: {told}.")
    return NmeaLog(
        path,
        tuple(fix for fix in fixes if fix is not None),
        tuple(report for report in reports if report is not None and report.mmsi != ais.own),
        time,
        formats,
        wrong,
        own_ship.course_for_heading,
    )


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
    if not log.fixes:
        told = ", ".join(f"{n} {name}" for name, n in log.formats.most_common(8))
        raise ConfigurationError(
            f"{log.path} does not tell where own ship was: it has {told}, but no GGA or RMC that "
            f"can be used. {' '.join(log.wrong[:2])}".strip()
        )
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


def ships_of_log(
    log: NmeaLog, epoch: int, origin: MapOrigin
) -> tuple[dict[int, ShipHistory], tuple[str, ...]]:
    """Return the reports of other ships in ``map`` by their MMSI, and what was not used.

    Parameters and errors are those of :func:`own_ship_of_log`.
    """
    if not log.reports:
        raise ConfigurationError(
            f"{log.path} has no AIS report of another ship that can be used (VDM, message 1, 2, 3, "
            f"18 or 19). {' '.join(log.wrong[:2])}".strip()
        )
    notes = list(log.wrong)
    stamp = log.stamps(epoch, notes, ships=True)
    columns = np.array(
        [(r.latitude_deg, r.longitude_deg, r.speed, r.course_deg) for r in log.reports]
    )
    latitude, longitude, speed, course = columns.T
    position = origin.positions(latitude, longitude, str(log.path))
    assert origin.datum is not None
    velocity = vectors(speed, course, north_azimuths(latitude, longitude, origin.datum))
    states = np.concatenate([position, velocity], axis=1)
    ships, faults = _histories([r.mmsi for r in log.reports], stamp, states)
    notes += [f"{log.path}: {count} times {sentence}." for sentence, count in faults.items()]
    gaps = sum(len(ship.known_from_to()) - 1 for ship in ships.values() if ship.stamps)
    if gaps:
        notes.append(
            f"{log.path}: {gaps} times a ship is not heard for more than 90 s (7 min where it lies "
            "still): it is in no truth meanwhile."
        )
    return ships, tuple(notes)


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


def _is_sentence(line: bytes) -> bool:
    try:
        read_sentence(line)
    except InputError:
        return False
    return True


def _numbered_lines(path: Path) -> Iterator[tuple[int, bytes]]:
    """Yield the number of each line of a file, and each part of it that may be a sentence."""
    number, rest = 1, b""
    try:
        with path.open("rb") as file:
            while data := file.read(_READ_AT_ONCE):
                lines = (rest + data).splitlines(keepends=True)
                ends = lines[-1].endswith(b"\n") or len(lines[-1]) > _READ_AT_ONCE
                rest = b"" if ends else lines.pop()
                for line in lines:
                    yield from ((number, part) for part in parts_of(line))
                    number += 1
    except OSError as error:
        raise ConfigurationError(f"The file {path} cannot be read ({error.strerror}).") from error
    yield from ((number, part) for part in parts_of(rest))
