"""Positions that ships tell by AIS (sentences VDM), and own ship's own (VDO).

A report tells the second of the minute it is of, but neither minute nor date: these are of the
latest time in the stream, of other sentences, of TAG blocks, or of a shore station (message 4).

References
----------
International Telecommunication Union (2014). Recommendation ITU-R M.1371-5: messages 1 to 4, 11,
18 and 19.
"""

from __future__ import annotations

import math
from collections import OrderedDict
from dataclasses import dataclass
from datetime import date

from sonar_tracking.bags.nmea.sentence_time import SentenceTime
from sonar_tracking.bags.nmea.sentences import Sentence
from sonar_tracking.errors import InputError
from sonar_tracking.scene.nmea_format import KNOT

FORMATS = ("VDM", "VDO")

NO_TIME = (
    "an AIS report came before any date and time were known (RMC, ZDA, a TAG block with c:, or a "
    "shore station); it is not used"
)
NO_POSITION = "an AIS report tells no position; it is not used"
OTHER_MESSAGE = "an AIS message is no position report of a ship; it is not used"
CUT_OFF = "an AIS message is shorter than its kind, or not of six-bit characters; it is not used"
PARTS = "an AIS message in several sentences is not whole; it is not used"
NO_SHIP = "an AIS report has a number (MMSI) that is none of a ship; it is not used"

_SHIPS = range(200_000_000, 800_000_000)
_TIMES = (4, 11)
_CLASS_A, _CLASS_B = {1: 50, 2: 50, 3: 50}, {18: 46, 19: 46}
_BEGINS = {**_CLASS_A, **_CLASS_B}
"""Of the speed in each kind of position report; all that follows is alike, bits."""

_LEAST_BITS = {1: 143, 2: 143, 3: 143, 18: 139, 19: 139, 4: 78, 11: 78}
_MOST_OPEN = 64
"""Messages of which parts are awaited."""

_AHEAD = 10.0
"""By so much the second of a report may be later than the time of the stream, s."""


def is_ais(sentence: Sentence) -> bool:
    """Return whether a sentence carries AIS, and is not a maker's own of that name."""
    return sentence.format in FORMATS and sentence.talker != "P"


@dataclass(frozen=True, slots=True)
class AisReport:
    """Where a ship was.

    Attributes
    ----------
    mmsi : int
        Its number, Maritime Mobile Service Identity.
    instant : float
        On the time line of the sentences, s.
    latitude_deg, longitude_deg : float
        deg, north and east positive.
    speed : float
        Over ground, m/s; NaN = unknown.
    course_deg : float
        Made good, from true north, deg; NaN = unknown.
    """

    mmsi: int
    instant: float
    latitude_deg: float
    longitude_deg: float
    speed: float
    course_deg: float


class AisReports:
    """Reads the AIS sentences of a stream.

    Parameters
    ----------
    time : SentenceTime
        The time line of the stream; shore stations and TAG blocks tell it, too.

    Attributes
    ----------
    own : int
        Number of own ship, which is in no report; 0 = unknown.
    """

    def __init__(self, time: SentenceTime) -> None:
        self.time = time
        self.own = 0
        self._open: OrderedDict[tuple[str, ...], list[str]] = OrderedDict()

    @property
    def n_open(self) -> int:
        """Messages of which parts are still awaited."""
        return len(self._open)

    def take(self, sentence: Sentence) -> AisReport | None:
        """Return the report that a sentence VDM or VDO completes; None = more of it is to come.

        Raises
        ------
        InputError
            If it cannot be used; with the same words for all sentences of a kind.
        """
        if not math.isnan(sentence.heard):
            self.time.take_instant(sentence.heard)
        payload = self._whole(sentence)
        if payload is None:
            return None
        bits = _bits(payload)
        kind, mmsi = _unsigned(bits, 0, 6), _unsigned(bits, 8, 30)
        if len(bits) < max(_LEAST_BITS.get(kind, 0), 38):
            raise InputError(CUT_OFF)
        if kind in _TIMES:
            self._take_time(bits)
        if kind not in _BEGINS:
            raise InputError(OTHER_MESSAGE)
        if sentence.format == "VDO":
            self.own = mmsi
        if mmsi == self.own:
            return None
        return self._report(bits, _BEGINS[kind], mmsi)

    def _whole(self, sentence: Sentence) -> str | None:
        """Return the payload of a message that is whole; None = it is not yet."""
        total, number, group, channel, payload = (sentence.field(i) for i in range(5))
        if not (total.isdecimal() and number.isdecimal() and 1 <= int(number) <= int(total) <= 9):
            raise InputError(CUT_OFF)
        if total == "1":
            return payload
        key = (sentence.talker, sentence.format, total, group, channel)
        parts = self._open.pop(key, [])
        if number == "1":
            parts = []
        if int(number) != len(parts) + 1:
            raise InputError(PARTS)
        parts.append(payload)
        if number == total:
            return "".join(parts)
        self._open[key] = parts
        if len(self._open) > _MOST_OPEN:
            self._open.popitem(last=False)
            raise InputError(PARTS)
        return None

    def _take_time(self, bits: str) -> None:
        year, month, day = _unsigned(bits, 38, 14), _unsigned(bits, 52, 4), _unsigned(bits, 56, 5)
        hour, minute, second = (_unsigned(bits, b, n) for b, n in ((61, 5), (66, 6), (72, 6)))
        if hour > 23 or minute > 59 or second > 59:
            return
        try:
            days = (date(year, month, day) - date(1970, 1, 1)).days
        except ValueError:
            return
        self.time.take(3600.0 * hour + 60.0 * minute + second, days)

    def _report(self, bits: str, begin: int, mmsi: int) -> AisReport:
        speed, course = _unsigned(bits, begin, 10), _unsigned(bits, begin + 66, 12)
        longitude = _signed(bits, begin + 11, 28) / 600_000.0
        latitude = _signed(bits, begin + 39, 27) / 600_000.0
        if mmsi not in _SHIPS:
            raise InputError(NO_SHIP)
        if abs(longitude) > 180.0 or abs(latitude) > 90.0:
            raise InputError(NO_POSITION)
        return AisReport(
            mmsi,
            self._instant(_unsigned(bits, begin + 87, 6)),
            latitude,
            longitude,
            speed=0.1 * KNOT * speed if speed <= 1022 else math.nan,
            course_deg=0.1 * course if course < 3600 else math.nan,
        )

    def _instant(self, second: int) -> float:
        """Return the instant of a report from the second it tells; 60 and more = it tells none."""
        now = self.time.now
        if math.isnan(now):
            raise InputError(NO_TIME)
        if second >= 60:
            return now
        before = (now - second) % 60.0
        instant = now - before if before <= 60.0 - _AHEAD else now + 60.0 - before
        self.time.advance(instant)
        return instant


def _bits(payload: str) -> str:
    """Return six bits a character, as text of zeros and ones."""
    values = [ord(each) - 48 for each in payload]
    if not all(0 <= value <= 39 or 48 <= value <= 71 for value in values):
        raise InputError(CUT_OFF)
    return "".join(f"{value - 8 if value >= 48 else value:06b}" for value in values)


def _unsigned(bits: str, begin: int, count: int) -> int:
    return int(bits[begin : begin + count] or "0", 2)


def _signed(bits: str, begin: int, count: int) -> int:
    value = _unsigned(bits, begin, count)
    return value - (1 << count) if value >> (count - 1) else value
