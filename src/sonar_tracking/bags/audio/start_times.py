"""When a recorder began a file, from the name it gave to it.

Names of the usual recorders hold a date and a time of day, taken as UTC: SoundTrap
(``5146.220101123000.wav``), AudioMoth (``20220101_123000.WAV``, earlier ``61D04728.WAV``), Song
Meter (``SM4_20220101_123000.wav``), icListen (``SBW1234_20220101_123000.wav``), PAMGuard
(``PAM_20220101_123000_000.wav``), HARP (``SITE_220101_123000.x.wav``), AMAR
(``AMAR173.20220101T123000Z.wav``), and the like.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from datetime import datetime, timezone

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.records.time import NANOSECONDS

_LONG = re.compile(
    r"(?<!\d)(?P<date>(?:19|20)\d\d[-_.]?\d\d[-_.]?\d\d)[T _.-]?"
    r"(?P<clock>\d\d[-_:.]?\d\d[-_:.]?\d\d)"
    r"(?:[._](?P<fraction>\d{6}|\d{3})(?!\d))?Z?(?!\d)"
)
_SHORT = re.compile(r"(?<!\d)(?P<date>\d{6})[T _-]?(?P<clock>\d{6})(?P<fraction>)(?!\d)")
_HEXADECIMAL = re.compile(r"[0-9A-F]{8}", re.IGNORECASE)
_EARLIEST, _LATEST = 1_400_000_000, 2_200_000_000
"""Instants an AudioMoth name of eight hexadecimal digits may mean, s since 1970."""

_DIRECTIVES = {
    "Y": r"\d{4}", "y": r"\d\d", "m": r"\d\d", "d": r"\d\d", "j": r"\d{3}", "H": r"\d\d",
    "I": r"\d\d", "M": r"\d\d", "S": r"\d\d", "f": r"\d{1,6}", "p": r"[AaPp][Mm]",
    "b": r"[A-Za-z]{3}", "B": r"[A-Za-z]+", "z": r"(?:Z|[+-]\d\d:?\d\d)", "%": "%",
}  # fmt: skip
_DATES = ({"m", "d"}, {"b", "d"}, {"B", "d"}, {"j"})


@dataclass(frozen=True)
class NamedStart:
    """What a name says of the begin of a file.

    Attributes
    ----------
    instant : int
        ns since 1970.
    resolution : float
        Of the time in the name, s.
    rest : str
        The name without the time: the same for the files of one recorder.
    """

    instant: int
    resolution: float
    rest: str


def start_in_name(name: str, pattern: str | None = None) -> NamedStart | None:
    """Return the time in a name, or None if there is none.

    Parameters
    ----------
    name : str
        Of the file, without its ending.
    pattern : str, optional
        How the time stands in it, in directives of strftime; default: those of usual recorders.

    Raises
    ------
    ConfigurationError
        If the pattern has no date, or a directive that is not known.
    """
    if pattern is not None:
        return _by_pattern(name, pattern)
    for known in (_LONG, _SHORT):
        for match in known.finditer(name):
            found = _instant(match)
            if found is not None:
                return found
    if _HEXADECIMAL.fullmatch(name) and _EARLIEST <= int(name, 16) <= _LATEST:
        return NamedStart(int(name, 16) * NANOSECONDS, 1.0, "")
    return None


def _instant(match: re.Match[str]) -> NamedStart | None:
    date, clock = (re.sub(r"\D", "", match[part]) for part in ("date", "clock"))
    century = "" if len(date) == 8 else "20"
    try:
        begin = datetime.strptime(century + date + clock, "%Y%m%d%H%M%S")
    except ValueError:
        return None
    fraction = match["fraction"] or ""
    parts = int(fraction.ljust(9, "0")) if fraction else 0
    instant = int(begin.replace(tzinfo=timezone.utc).timestamp()) * NANOSECONDS + parts
    return NamedStart(instant, 10.0 ** -len(fraction), _rest(match))


def _by_pattern(name: str, pattern: str) -> NamedStart | None:
    match = re.search(_expression(pattern), name)
    if match is None:
        return None
    # strptime would take more digits for a fraction than there are here.
    try:
        begin = datetime.strptime(match[0], pattern)
    except ValueError:
        return None
    begin = begin if begin.tzinfo else begin.replace(tzinfo=timezone.utc)
    resolution = 1e-3 if "%f" in pattern else 1.0 if "%S" in pattern else 60.0
    since_1970 = begin - datetime(1970, 1, 1, tzinfo=timezone.utc)
    whole = since_1970.days * 86400 + since_1970.seconds
    instant = whole * NANOSECONDS + since_1970.microseconds * 1000
    return NamedStart(instant, resolution, _rest(match))


def _expression(pattern: str) -> str:
    """Return the regular expression of a pattern in directives of strftime."""
    used = re.findall(r"%(.?)", pattern)
    unknown = [f"%{each}" for each in used if each not in _DIRECTIVES]
    dated = {"Y", "y"} & set(used) and any(needed <= set(used) for needed in _DATES)
    if unknown or not dated:
        reason = f"{unknown[0]} is not known" if unknown else "it has no whole date"
        raise ConfigurationError(
            f"--time-pattern is {pattern!r}: {reason}; give e.g. '%Y%m%d_%H%M%S' (known are "
            f"{', '.join('%' + each for each in _DIRECTIVES)})."
        )
    parts = re.split(r"%(.)", pattern)
    return "".join(
        _DIRECTIVES[part] if index % 2 else re.escape(part) for index, part in enumerate(parts)
    )


def _rest(match: re.Match[str]) -> str:
    return match.string[: match.start()] + "*" + match.string[match.end() :]
