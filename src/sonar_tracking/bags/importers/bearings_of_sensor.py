"""The bearings of one sensor of a file, turned into ``map``, each with its track and its lines."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.bags.importers.bearing_association import associate_bearings
from sonar_tracking.bags.importers.bearing_file import CONES, BearingLines, StationPlace
from sonar_tracking.bags.importers.bearing_pictures import SensorBearings
from sonar_tracking.bags.positions.own_ship_track import OwnShipMotion
from sonar_tracking.configuration import parameter
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import BoolArray, FloatArray, IndexArray, IntArray
from sonar_tracking.records.bearings import AngleKind
from sonar_tracking.simulation.scenarios.scenario import DEFAULT_EPOCH


@dataclass(frozen=True)
class BearingSensor:
    """What a file of bearings does not tell of its sensors."""

    bearing_deviation_deg: float = parameter(
        0.0,
        "standard deviation of bearings without their own; 0 = none",
        unit="deg",
        minimum=0.0,
        maximum=180.0,
    )
    frequency_deviation: float = parameter(
        0.2, "of lines without their own", unit="Hz", minimum=1e-6
    )
    epoch: int = parameter(DEFAULT_EPOCH, "instant of time_s = 0", unit="ns", minimum=1)


def bearings_of_sensor(
    lines: BearingLines,
    name: str,
    sensor: BearingSensor,
    motion: OwnShipMotion | None,
    stations: dict[str, StationPlace],
    notes: list[str],
) -> SensorBearings:
    """Return the bearings of one sensor, each with its track and its lines.

    Parameters
    ----------
    lines : BearingLines
        Of all sensors.
    name : str
        Of the sensor.
    sensor : BearingSensor
        What the file does not tell.
    motion : OwnShipMotion or None
        Own ship at the stamps of all lines, where a sensor is aboard.
    stations : dict of str to StationPlace
        Where the others are.
    notes : list of str
        Told what was left out.

    Raises
    ------
    ConfigurationError
        If deviations are not known.
    """
    rows = np.flatnonzero(lines.sensor == name)
    keys = [(int(lines.stamp[r]), str(lines.track[r]), float(lines.angle[r])) for r in rows]
    of_key: dict[tuple[int, str, float], list[int]] = {}
    for key, row in zip(keys, rows.tolist(), strict=True):
        of_key.setdefault(key, []).append(row)
    once: dict[tuple[int, str], float] = {}
    for stamp, track, direction in of_key:
        once.setdefault((stamp, track), direction)
    kept = [k for k in of_key if not k[1] or once[k[:2]] == k[2]]
    if len(kept) < len(of_key):
        notes.append(
            f"{name}: {len(of_key) - len(kept)} bearings of a track that has another one at the "
            "same time were left out; the first in the file holds."
        )
    first = np.array([of_key[key][0] for key in kept])
    deviation = _deviations(lines, first, sensor)
    angle = _turned(lines, first, name, motion, stations)
    elevation_deviation = lines.elevation_deviation[first]
    return SensorBearings(
        stamp=lines.stamp[first],
        number=_numbers(lines, first, angle, deviation),
        angle=angle,
        deviation=deviation,
        elevation=lines.elevation[first],
        elevation_deviation=np.where(elevation_deviation > 0.0, elevation_deviation, deviation),
        frequencies=tuple(_frequencies(lines, of_key[key], sensor) for key in kept),
        kind=AngleKind.CONE if lines.kind in CONES else AngleKind.AZIMUTH,
    )


def _deviations(lines: BearingLines, rows: IndexArray, sensor: BearingSensor) -> FloatArray:
    own = lines.deviation[rows]
    filled = np.where(own > 0.0, own, np.radians(sensor.bearing_deviation_deg))
    if np.any(filled <= 0.0):
        raise ConfigurationError(
            "The bearings do not tell how exact they are; give --bearing-deviation-deg, or a "
            "column bearing_deviation_deg."
        )
    return filled


def _frequencies(
    lines: BearingLines, rows: list[int], sensor: BearingSensor
) -> tuple[tuple[float, float], ...]:
    pairs = [(float(lines.frequency[r]), float(lines.frequency_deviation[r])) for r in rows]
    common = sensor.frequency_deviation
    return tuple((f, d if d > 0.0 else common) for f, d in pairs if np.isfinite(f))


def _turned(
    lines: BearingLines,
    rows: IndexArray,
    name: str,
    motion: OwnShipMotion | None,
    stations: dict[str, StationPlace],
) -> FloatArray:
    """Return angles in ``map``; those of cones stay from broadside."""
    if lines.kind != "relative_bearing_deg":
        return lines.angle[rows]
    if name in stations:
        return wrap_angle(lines.angle[rows] + stations[name].azimuth)
    assert motion is not None
    index = np.searchsorted(motion.stamp, lines.stamp[rows])
    return wrap_angle(lines.angle[rows] + motion.azimuth[index])


def _numbers(
    lines: BearingLines, rows: IndexArray, angle: FloatArray, deviation: FloatArray
) -> IntArray:
    """Return the track of each bearing: by its label, else by association."""
    labels = lines.track[rows]
    names = [name for name in dict.fromkeys(labels.tolist()) if name]
    number = np.zeros(len(rows), dtype=np.int64)
    for index, name in enumerate(names, start=1):
        number[labels == name] = index
    free: BoolArray = labels == ""
    if free.any():
        found = associate_bearings(lines.stamp[rows][free], angle[free], deviation[free])
        number[free] = np.where(found > 0, found + len(names), 0)
    return number
