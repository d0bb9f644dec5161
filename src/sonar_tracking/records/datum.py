"""The datum: which place on the Earth is the origin of the frame ``map``.

A scenario may name one, ``datum: {latitude_deg, longitude_deg, height}``. It travels with the
resolved scenario in a recording, so that no message needs a field of its own.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from sonar_tracking.configuration import from_mapping, parameter
from sonar_tracking.errors import ConfigurationError

DATUM = "datum"
"""Section of the datum in a scenario."""

ADVICE = "give e.g. 54.18,7.89 (latitude and longitude, degrees, north and east positive)"


@dataclass(frozen=True)
class Datum:
    """Origin of ``map``: x points east there, y north, z up; on the ellipsoid of WGS 84."""

    latitude_deg: float = parameter(
        math.nan, "of the origin of map, north positive", unit="deg", minimum=-90.0, maximum=90.0
    )
    longitude_deg: float = parameter(
        math.nan, "the same, east positive", unit="deg", minimum=-180.0, maximum=180.0
    )
    height: float = parameter(
        0.0, "of the origin above the ellipsoid", unit="m", minimum=-12_000.0, maximum=9_000.0
    )

    def to_mapping(self) -> dict[str, float]:
        """Return names and values as a scenario has them."""
        return asdict(self)

    def to_text(self) -> str:
        """Return it as a person types it, see :func:`datum_from_text`."""
        return f"{self.latitude_deg!r},{self.longitude_deg!r},{self.height!r}"


_DIGITS = 7
"""Of degrees: 1 cm."""


def datum_at(latitude_deg: float, longitude_deg: float) -> Datum:
    """Return the datum at a place (deg), to a centimetre, so that people can type it."""
    return Datum(round(latitude_deg, _DIGITS), round(longitude_deg, _DIGITS))


def datum_from_mapping(values: Any, where: str) -> Datum:
    """Read a datum from names and values.

    Parameters
    ----------
    values : mapping
        ``latitude_deg``, ``longitude_deg`` and, if not 0, ``height``.
    where : str
        Where it comes from, named in errors.

    Raises
    ------
    ConfigurationError
        If latitude or longitude is missing, or a value cannot be used.
    """
    if not isinstance(values, Mapping):
        raise ConfigurationError(
            f"{where} is {values!r}; it must be a mapping: latitude_deg, longitude_deg, height."
        )
    for name in ("latitude_deg", "longitude_deg"):
        if name not in values:
            raise ConfigurationError(
                f"{where} has no {name}; give latitude_deg and longitude_deg of the origin of map."
            )
    return from_mapping(Datum, values, where)


def datum_from_text(text: str, where: str = "--datum") -> Datum:
    """Read a datum as typed: ``LATITUDE,LONGITUDE`` or ``LATITUDE,LONGITUDE,HEIGHT``.

    Parameters
    ----------
    text : str
        Degrees, north and east positive, and m.
    where : str
        What it was typed for, named in errors.

    Raises
    ------
    ConfigurationError
        If the text is no datum.
    """
    names = ("latitude_deg", "longitude_deg", "height")
    parts = text.split(",")
    try:
        numbers = [float(part) for part in parts]
    except ValueError:
        numbers = []
    if len(numbers) not in (2, 3) or not all(map(math.isfinite, numbers)):
        raise ConfigurationError(f"{where} is {text!r}; {ADVICE}.")
    return datum_from_mapping(dict(zip(names, numbers, strict=False)), where)


def datum_if_told(text: str, where: str = "--datum") -> Datum | None:
    """Read a datum as typed, or as a parameter has it; None = the text is empty.

    Parameters and errors are those of :func:`datum_from_text`.
    """
    return datum_from_text(text, where) if text else None


def datum_of(scenario: Mapping[str, Any], where: str) -> Datum | None:
    """Return the datum of a scenario as a recording keeps it; None = it has none.

    Parameters
    ----------
    scenario : mapping
        Names and values of the resolved scenario, ``Bag.recording.scenario``.
    where : str
        Where it comes from, named in errors.

    Raises
    ------
    ConfigurationError
        If there is one that cannot be used.
    """
    values = scenario.get(DATUM)
    return None if values is None else datum_from_mapping(values, f"{where}: {DATUM}")
