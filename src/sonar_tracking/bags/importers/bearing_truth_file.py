"""Surveyed bearings of the targets of a recording, from a CSV file.

Columns ``time_s`` (since the first sample), ``target`` (any name), ``arrival_angle_deg`` (from
broadside, positive towards increasing element x), one row a target and instant.
"""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.records.arrays import FloatArray, IdArray

_COLUMNS = ("time_s", "target", "arrival_angle_deg")


@dataclass(frozen=True)
class SurveyedBearings:
    """True bearings at one instant.

    Attributes
    ----------
    time : float
        Since the first sample, s.
    target : ndarray of uint64, shape (n_targets,)
        Numbers from 1, in the order in which the targets first appear in the file.
    angle, rate : ndarray, shape (n_targets,)
        Arrival angle, rad, and its rate by differences of the neighbouring instants, rad/s.
    """

    time: float
    target: IdArray
    angle: FloatArray
    rate: FloatArray


def read_surveyed_bearings(path: Path | str) -> list[SurveyedBearings]:
    """Read a truth file.

    Returns
    -------
    list of SurveyedBearings
        In order of time.

    Raises
    ------
    ConfigurationError
        If it cannot be read; file and line are named.
    """
    path = Path(path)
    try:
        with path.open(encoding="utf-8", newline="") as file:
            reader = csv.DictReader(file)
            if not set(_COLUMNS) <= set(reader.fieldnames or ()):
                raise ConfigurationError(
                    f"The truth file {path} has the columns {reader.fieldnames}; it needs "
                    f"{', '.join(_COLUMNS)}."
                )
            rows = [_row(values, f"{path}, line {reader.line_num}") for values in reader]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise ConfigurationError(f"The truth file {path} cannot be read ({error}).") from error
    if not rows:
        raise ConfigurationError(f"The truth file {path} holds no bearings.")
    return _by_time(rows)


def _row(values: dict[str, str], where: str) -> tuple[float, str, float]:
    try:
        time, angle = float(values["time_s"]), float(values["arrival_angle_deg"])
    except (TypeError, ValueError):
        raise ConfigurationError(
            f"{where}: time_s and arrival_angle_deg must be numbers."
        ) from None
    if not math.isfinite(time) or not abs(angle) <= 90.0:
        raise ConfigurationError(
            f"{where}: the arrival angle {angle:g} deg at {time:g} s is none from broadside; it "
            "must lie between -90 and 90."
        )
    return time, values["target"], math.radians(angle)


def _by_time(rows: list[tuple[float, str, float]]) -> list[SurveyedBearings]:
    names = list(dict.fromkeys(name for _, name, _ in rows))
    seen: dict[float, list[tuple[int, float, float]]] = {}
    for number, name in enumerate(names, start=1):
        history = sorted({time: angle for time, n, angle in rows if n == name}.items())
        times, angles = np.array(history).T
        rates = np.gradient(angles, times) if len(times) > 1 else np.zeros(1)
        for time, angle, rate in zip(times, angles, rates, strict=True):
            seen.setdefault(float(time), []).append((number, angle, rate))
    return [
        SurveyedBearings(
            time,
            np.array([entry[0] for entry in entries], np.uint64),
            np.array([entry[1] for entry in entries]),
            np.array([entry[2] for entry in entries]),
        )
        for time, entries in sorted(seen.items())
    ]
