"""A log of NMEA 0183: own ship's track, and other ships by their AIS.

Sentences may be mixed, of any talkers, and with noise between them: what cannot be used is counted
by kind. See :mod:`sonar_tracking.bags.nmea`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sonar_tracking.bags.nmea.ais_reports import FORMATS, AisReport, AisReports, is_ais
from sonar_tracking.bags.nmea.own_ship_fixes import OwnShipFix, OwnShipFixes
from sonar_tracking.bags.nmea.own_ship_sentences import READERS, own_ship_report
from sonar_tracking.bags.nmea.sentence_time import DAY, SentenceTime
from sonar_tracking.bags.nmea.sentences import NO_CHECKSUM, lines_of, parts_of, read_sentence
from sonar_tracking.bags.tables.line_notes import LineNotes
from sonar_tracking.errors import ConfigurationError, InputError, shown
from sonar_tracking.records.arrays import IntArray
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

    def check_own_ship(self) -> None:
        """Refuse a log that does not tell where own ship was.

        Raises
        ------
        ConfigurationError
            With what it has.
        """
        if self.fixes:
            return
        told = ", ".join(f"{n} {name}" for name, n in self.formats.most_common(8))
        raise ConfigurationError(
            f"{self.path} does not tell where own ship was: it has {told}, but no GGA or RMC that "
            "can be used; headings have no times of their own, log them together with positions. "
            f"{' '.join(self.wrong[:2])}".strip()
        )

    def check_ships(self) -> None:
        """Refuse a log that does not tell where other ships were.

        Raises
        ------
        ConfigurationError
            With what is wrong with it.
        """
        if not self.reports:
            raise ConfigurationError(
                f"{self.path} has no AIS report of another ship that can be used (VDM, message 1, "
                f"2, 3, 18 or 19). {' '.join(self.wrong[:2])}".strip()
            )


class NmeaLogs:
    """Logs that were read, so that none is read twice."""

    def __init__(self) -> None:
        self._read: dict[Path, NmeaLog] = {}

    def read(self, path: Path | str) -> NmeaLog:
        """Return a log; see :func:`read_nmea_log`."""
        path = Path(path)
        if path not in self._read:
            self._read[path] = read_nmea_log(path)
        return self._read[path]


def epochs_of_logs(logs: Sequence[NmeaLog], epoch: int) -> list[int]:
    """Return the instant whose date is taken for each log, if it has none.

    A log without a date follows the one before it: it is of that day, or of the next.

    Parameters
    ----------
    logs : sequence of NmeaLog
        In the order in which they follow.
    epoch : int
        Its date is that of the first of them, ns.

    Returns
    -------
    list of int
        ns.
    """
    epochs, end, day = [], 0, round(DAY) * NANOSECONDS
    for log in logs:
        instants = [*(fix.instant for fix in log.fixes), *(one.instant for one in log.reports)]
        first, last = (log.time.stamp(f(instants), epoch // day) for f in (min, max))
        if not log.time.is_dated and first < end - day // 2:
            days = -((first - end + day // 2) // day)
            epoch, last = epoch + days * day, last + days * day
        epochs.append(epoch)
        end = last
    return epochs


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
    if ais.n_open:
        notes.say(f"{ais.n_open} AIS messages are not whole: the log ends before their last part.")
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


def _is_sentence(line: bytes) -> bool:
    """Return whether a line is a sentence, or would be with a checksum."""
    try:
        read_sentence(line)
    except InputError as error:
        return str(error) == NO_CHECKSUM
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
