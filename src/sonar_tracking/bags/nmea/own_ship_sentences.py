"""What single sentences say of own ship: GGA, RMC, HDT, VTG, VHW, and the date of ZDA.

Of VHW the heading alone is taken: its speed is one through the water. Speeds come
in knots, angles in degrees clockwise from true north, places in degrees and minutes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from datetime import date

from sonar_tracking.bags.nmea.sentences import Sentence
from sonar_tracking.errors import InputError
from sonar_tracking.scene.nmea_format import KNOT

_EPOCH = date(1970, 1, 1)
_FIRST_CENTURY = 70
"""Two digits of a year from which on they are of the 20th century."""


@dataclass(frozen=True)
class OwnShipReport:
    """What one sentence says; NaN and None = nothing.

    Attributes
    ----------
    format : str
        Of the sentence.
    time_of_day : float
        UTC, s.
    day : int or None
        Days since 1970-01-01.
    latitude_deg, longitude_deg : float
        deg, north and east positive.
    heading_deg : float
        Of the bow, from true north, deg.
    course_deg : float
        Made good over ground, from true north, deg.
    speed : float
        Over ground, m/s.
    """

    format: str
    time_of_day: float = math.nan
    day: int | None = None
    latitude_deg: float = math.nan
    longitude_deg: float = math.nan
    heading_deg: float = math.nan
    course_deg: float = math.nan
    speed: float = math.nan

    @property
    def has_position(self) -> bool:
        """Whether it says where own ship is."""
        return not math.isnan(self.latitude_deg)


def own_ship_report(sentence: Sentence) -> OwnShipReport | None:
    """Return what a sentence says of own ship; None = it is of another format.

    Raises
    ------
    InputError
        If it is of a format that does, but cannot be used; with the same words for all of a kind.
    """
    read = READERS.get(sentence.format)
    return None if read is None or sentence.talker == "P" else read(sentence)


def _gga(sentence: Sentence) -> OwnShipReport:
    quality = sentence.field(5)
    if quality in ("", "0"):
        raise InputError("GGA says that there is no fix; it is not used")
    latitude, longitude = _place(sentence, 1)
    time = _time_of_day(sentence, 0)
    return OwnShipReport("GGA", time, latitude_deg=latitude, longitude_deg=longitude)


def _rmc(sentence: Sentence) -> OwnShipReport:
    if sentence.field(1) != "A":
        raise InputError("RMC says that its position is not valid; it is not used")
    latitude, longitude = _place(sentence, 2)
    text = sentence.field(8)
    day = None
    if text:
        if len(text) != 6 or not text.isdecimal():
            raise InputError("RMC has a date that is not ddmmyy; it is not used")
        year = int(text[4:])
        century = 1900 if year >= _FIRST_CENTURY else 2000
        day = _day(sentence, century + year, int(text[2:4]), int(text[:2]))
    return OwnShipReport(
        "RMC",
        _time_of_day(sentence, 0),
        day,
        latitude,
        longitude,
        course_deg=_angle(sentence, 7),
        speed=_knots(sentence, 6),
    )


def _zda(sentence: Sentence) -> OwnShipReport:
    parts = [sentence.field(index) for index in (3, 2, 1)]
    if not all(part.isdecimal() and len(part) <= 4 for part in parts):
        raise InputError("ZDA has no date; it is not used")
    day = _day(sentence, *(int(part) for part in parts))
    return OwnShipReport("ZDA", _time_of_day(sentence, 0), day)


def _hdt(sentence: Sentence) -> OwnShipReport:
    return OwnShipReport("HDT", heading_deg=_angle(sentence, 0))


def _vtg(sentence: Sentence) -> OwnShipReport:
    if sentence.field(8) == "N":
        raise InputError("VTG says that it is not valid; it is not used")
    return OwnShipReport("VTG", course_deg=_angle(sentence, 0), speed=_knots(sentence, 4))


def _vhw(sentence: Sentence) -> OwnShipReport:
    return OwnShipReport("VHW", heading_deg=_angle(sentence, 0))


READERS: Mapping[str, Callable[[Sentence], OwnShipReport]] = {
    "GGA": _gga,
    "RMC": _rmc,
    "ZDA": _zda,
    "HDT": _hdt,
    "VTG": _vtg,
    "VHW": _vhw,
}
"""The formats that say something of own ship."""


def _number(sentence: Sentence, index: int) -> float:
    """Return a field as a number; NaN where it is empty."""
    text = sentence.field(index)
    if not text:
        return math.nan
    try:
        value = float(text)
    except ValueError:
        value = math.inf
    if not math.isfinite(value):
        raise InputError(f"{sentence.format} has a field that is not a number; it is not used")
    return value


def _angle(sentence: Sentence, index: int) -> float:
    value = _number(sentence, index)
    if not math.isnan(value) and not -360.0 <= value <= 360.0:
        raise InputError(f"{sentence.format} has an angle beyond 360 degrees; it is not used")
    return value % 360.0


def _knots(sentence: Sentence, index: int) -> float:
    value = _number(sentence, index)
    if value < 0.0:
        raise InputError(f"{sentence.format} has a negative speed; it is not used")
    return value * KNOT


def _time_of_day(sentence: Sentence, index: int) -> float:
    text = sentence.field(index)
    whole, _, fraction = text.partition(".")
    if len(whole) != 6 or not (whole + (fraction or "0")).isdecimal():
        raise InputError(f"{sentence.format} has no time hhmmss; it is not used")
    hours, minutes, seconds = int(whole[:2]), int(whole[2:4]), int(whole[4:])
    if hours > 23 or minutes > 59 or seconds > 60:
        raise InputError(f"{sentence.format} has a time that no clock shows; it is not used")
    return 3600.0 * hours + 60.0 * minutes + float(f"{seconds}.{fraction or '0'}")


def _day(sentence: Sentence, year: int, month: int, day: int) -> int:
    try:
        return (date(year, month, day) - _EPOCH).days
    except ValueError as error:
        raise InputError(
            f"{sentence.format} has a date that no calendar has; it is not used"
        ) from error


def _place(sentence: Sentence, index: int) -> tuple[float, float]:
    """Return latitude and longitude, deg, of four fields from one on."""
    latitude = _degrees(sentence, index, 2, "NS", 90.0)
    longitude = _degrees(sentence, index + 2, 3, "EW", 180.0)
    return latitude, longitude


def _degrees(sentence: Sentence, index: int, digits: int, sides: str, most: float) -> float:
    text, side = sentence.field(index), sentence.field(index + 1)
    whole, _, fraction = text.partition(".")
    sign = {sides[0]: 1.0, sides[1]: -1.0}.get(side)
    if len(whole) != digits + 2 or not (whole + (fraction or "0")).isdecimal() or sign is None:
        raise InputError(f"{sentence.format} has no position; it is not used")
    minutes = float(text[digits:])
    value = int(text[:digits]) + minutes / 60.0
    if minutes >= 60.0 or value > most:
        raise InputError(f"{sentence.format} has a position off the Earth; it is not used")
    return sign * value
