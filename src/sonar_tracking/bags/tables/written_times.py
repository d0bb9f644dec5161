"""Instants as people and loggers write them: dates with times of day, with or without a zone."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta, timezone

_CLOCK = r"(?P<hour>\d{1,2}):(?P<minute>\d\d)(?::(?P<second>\d\d)(?:[.,](?P<fraction>\d+))?)?"
_ZONE = r"(?P<zone>Z|UTC|GMT|[+-]\d\d(?::?\d\d)?)?"
_DATE = (
    r"(?:(?P<year>\d{4})[-/.]?(?P<month>\d\d)[-/.]?(?P<day>\d\d)"
    r"|(?P<day_first>\d\d)\.(?P<month_next>\d\d)\.(?P<year_last>\d{4}))"
)
_INSTANT = re.compile(rf"{_DATE}(?:T|\s+|,\s*){_CLOCK}\s*{_ZONE}", re.IGNORECASE)
_TIME_OF_DAY = re.compile(rf"{_CLOCK}\s*{_ZONE}", re.IGNORECASE)
_NONE_SAID = timezone.utc
_1970 = datetime(1970, 1, 1, tzinfo=timezone.utc)


@dataclass(frozen=True)
class WrittenTimes:
    """A column of times as numbers.

    Attributes
    ----------
    cells : list of str
        Seconds; what is no time stays as it was.
    is_dated : bool
        Whether they count from 1970; else from a midnight.
    has_zone : bool
        Whether all say of which zone they are.
    """

    cells: list[str]
    is_dated: bool
    has_zone: bool


def written_times(cells: Sequence[str]) -> WrittenTimes | None:
    """Return the times in a column of text; None = the first that says anything is none.

    Parameters
    ----------
    cells : sequence of str
        As they stand in the file.
    """
    first = next((cell for cell in cells if cell.strip()), "").strip()
    dated = _INSTANT.fullmatch(first) is not None
    if not dated and _TIME_OF_DAY.fullmatch(first) is None:
        return None
    pattern, read = (_INSTANT, _since_1970) if dated else (_TIME_OF_DAY, _since_midnight)
    done, zones = [], True
    for cell in cells:
        match = pattern.fullmatch(cell.strip())
        value = None if match is None else read(match)
        done.append(cell if value is None else value)
        zones &= match is None or match["zone"] is not None
    return WrittenTimes(done, dated, zones)


def _since_1970(match: re.Match[str]) -> str | None:
    year, month, day = (
        int(match[a] or match[b])
        for a, b in (("year", "year_last"), ("month", "month_next"), ("day", "day_first"))
    )
    try:
        midnight = datetime(year, month, day, tzinfo=_zone(match["zone"]))
        whole = (midnight - _1970) // timedelta(seconds=1)
    except (ValueError, OverflowError):
        return None
    clock = _clock(match)
    return None if clock is None else _text(whole + clock[0], clock[1])


def _since_midnight(match: re.Match[str]) -> str | None:
    clock = _clock(match)
    return None if clock is None else _text(*clock)


def _clock(match: re.Match[str]) -> tuple[int, str] | None:
    """Return whole seconds and the digits behind them; None = no clock shows it."""
    hour, minute, second = (int(match[part] or 0) for part in ("hour", "minute", "second"))
    if hour > 23 or minute > 59 or second > 60:
        return None
    return 3600 * hour + 60 * minute + second, match["fraction"] or ""


def _zone(text: str | None) -> timezone:
    if text is None or text[0] not in "+-":
        return _NONE_SAID
    digits = text[1:].replace(":", "").ljust(4, "0")
    offset = timedelta(hours=int(digits[:2]), minutes=int(digits[2:]))
    return timezone(-offset if text[0] == "-" else offset)


def _text(whole: int, fraction: str) -> str:
    return f"{whole}.{fraction}" if fraction else str(whole)
