"""Latitudes and longitudes as charts and people write them: degrees, minutes, seconds, side."""

from __future__ import annotations

import re

_ANGLE = re.compile(
    r"(?P<ahead>[NSEW])?\s*(?P<sign>[+-])?(?P<degrees>\d{1,3}(?:\.\d+)?)\s*[°d:]?"
    r"(?:\s*(?P<minutes>\d{1,2}(?:\.\d+)?)\s*['′’m:]?)?"
    r"(?:\s*(?P<seconds>\d{1,2}(?:\.\d+)?)\s*(?:\"|″|”|''|s)?)?\s*(?P<behind>[NSEW])?",
    re.IGNORECASE,
)


def written_angle(text: str, sides: str) -> float | None:
    """Return an angle, deg; None = the text is none.

    Parameters
    ----------
    text : str
        E.g. ``54°10.8'N``, ``54 10 48 N``, ``7.89 E``.
    sides : str
        Letters of the positive and of the negative side, ``NS`` or ``EW``.
    """
    match = _ANGLE.fullmatch(text.strip())
    if match is None:
        return None
    letters = [letter.upper() for letter in (match["ahead"], match["behind"]) if letter]
    if len(letters) > 1 or (letters and (letters[0] not in sides or match["sign"])):
        return None
    parts = [match[name] for name in ("degrees", "minutes", "seconds")]
    whole = [part is not None and "." not in part for part in parts]
    if any(parts[index + 1] is not None and not whole[index] for index in (0, 1)):
        return None
    degrees, minutes, seconds = (float(part or 0.0) for part in parts)
    if minutes >= 60.0 or seconds >= 60.0:
        return None
    negative = match["sign"] == "-" or letters == [sides[1]]
    return (-1.0 if negative else 1.0) * (degrees + minutes / 60.0 + seconds / 3600.0)
