"""Rows of a table from the records of a bag: one row a track, or own ship, and instant."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from datetime import datetime, timezone
from typing import Any

import numpy as np

from sonar_tracking.geodesy import surface_places
from sonar_tracking.motion import compass_from_azimuth, compass_from_vector
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import AngleKind, BearingTracks, TrackStatus
from sonar_tracking.records.datum import Datum
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.positions import (
    MAP_FRAME,
    PositionTracks,
    TrackHypothesis,
    TrackSource,
)
from sonar_tracking.records.time import NANOSECONDS

STATE_NAMES = ("x", "y", "vx", "vy")
COVARIANCES = {
    f"covariance_{STATE_NAMES[row]}_{STATE_NAMES[column]}": (row, column)
    for row in range(4)
    for column in range(row, 4)
}
"""Upper triangle of the covariance of a position, SI units."""

COLUMNS = (
    *("topic", "role", "time", "stamp_ns", "kind", "id", "name", "status", "source", "sensor"),
    "frame",
    *("latitude_deg", "longitude_deg", "x_m", "y_m", "z_m", "vx_m_s", "vy_m_s"),
    *("speed_m_s", "course_deg", "heading_deg", *COVARIANCES, "z_standard_deviation_m"),
    *("existence_probability", "initiated_s", "updated_s", "observability", "hypothesis"),
    *("hypothesis_probability", "bearing_track_id", "contributors", "angle_kind", "angle_deg"),
    *("angle_rate_deg_s", "angle_standard_deviation_deg", "elevation_deg", "ambiguous"),
    "signal_to_noise_ratio",
)
"""Of the table; what a row does not know is empty."""


@dataclass(frozen=True)
class ExportRow:
    """One track at one instant.

    Attributes
    ----------
    stamp : int
        ns.
    position : tuple of float
        x, y in ``frame``, m; NaN = it has none.
    place : tuple of float
        Latitude and longitude, degrees; NaN = not known.
    is_established : bool
        Whether the track claims a target: confirmed, coasted, true, or own ship.
    values : mapping of str to object
        Cells by the name of the column; what is missing is empty.
    """

    stamp: int
    position: tuple[float, float]
    place: tuple[float, float]
    is_established: bool
    values: dict[str, Any] = field(default_factory=dict)


def rows_of(record: Any, datum: Datum | None) -> Iterator[ExportRow]:
    """Yield the rows of a record: position tracks, bearing tracks, or own ship.

    Parameters
    ----------
    record : PositionTracks, BearingTracks or OwnShipState
        From a bag.
    datum : Datum or None
        Of ``map``; None = places are not known.
    """
    if isinstance(record, PositionTracks):
        yield from _position_rows(record, datum)
    elif isinstance(record, BearingTracks):
        yield from _bearing_rows(record)
    elif isinstance(record, OwnShipState):
        yield _own_ship_row(record, datum)


def utc_text(stamp: int) -> str:
    """Return a stamp (ns) as UTC in ISO 8601, to the microsecond."""
    whole, rest = divmod(stamp, NANOSECONDS)
    instant = datetime.fromtimestamp(whole, tz=timezone.utc).replace(microsecond=rest // 1000)
    return instant.isoformat(timespec="microseconds").replace("+00:00", "Z")


def _position_rows(tracks: PositionTracks, datum: Datum | None) -> Iterator[ExportRow]:
    places = _places(tracks.state[:, :2], datum if tracks.frame_id == MAP_FRAME else None)
    speed = np.hypot(tracks.state[:, 2], tracks.state[:, 3])
    course = compass_from_vector(tracks.state[:, 2:])
    contributors = _contributors(tracks)
    established = tracks.established
    for row in range(len(tracks)):
        x, y, vx, vy = tracks.state[row].tolist()
        covariance = tracks.covariance[row]
        values = {
            **_head(tracks.stamp, "position", tracks.status[row]),
            "id": int(tracks.id[row]),
            "source": _name(TrackSource, tracks.source[row]),
            "frame": tracks.frame_id,
            **{"x_m": x, "y_m": y, "z_m": float(tracks.z[row]), "vx_m_s": vx, "vy_m_s": vy},
            "speed_m_s": float(speed[row]),
            "course_deg": float(course[row]),
            **{name: float(covariance[entry]) for name, entry in COVARIANCES.items()},
            "z_standard_deviation_m": float(tracks.z_standard_deviation[row]),
            "existence_probability": float(tracks.existence_probability[row]),
            "initiated_s": float(tracks.initiated[row]),
            "updated_s": float(tracks.updated[row]),
            "observability": float(tracks.observability[row]),
            "hypothesis": _name(TrackHypothesis, tracks.hypothesis[row]),
            "hypothesis_probability": float(tracks.hypothesis_probability[row]),
            "bearing_track_id": int(tracks.bearing_track_id[row]) or "",
            "contributors": contributors[row],
        }
        yield _row(tracks.stamp, (x, y), places[row], bool(established[row]), values)


def _bearing_rows(tracks: BearingTracks) -> Iterator[ExportRow]:
    deviation = np.degrees(np.sqrt(tracks.covariance[:, 0, 0]))
    kind = AngleKind(tracks.angle_kind).name.lower()
    established = tracks.established
    nowhere = (math.nan, math.nan)
    for row in range(len(tracks.id)):
        values = {
            **_head(tracks.stamp, "bearing", tracks.status[row]),
            "id": int(tracks.id[row]),
            "sensor": tracks.sensor.sensor_id,
            "frame": tracks.sensor.frame_id,
            "existence_probability": float(tracks.existence_probability[row]),
            "angle_kind": kind,
            "angle_deg": math.degrees(tracks.arrival_angle[row]),
            "angle_rate_deg_s": math.degrees(tracks.arrival_angle_rate[row]),
            "angle_standard_deviation_deg": float(deviation[row]),
            "ambiguous": str(bool(tracks.ambiguous[row])).lower(),
            "signal_to_noise_ratio": float(tracks.signal_to_noise_ratio[row]),
        }
        if len(tracks.elevation):
            values["elevation_deg"] = math.degrees(tracks.elevation[row])
        yield ExportRow(tracks.stamp, nowhere, nowhere, bool(established[row]), values)


def _own_ship_row(state: OwnShipState, datum: Datum | None) -> ExportRow:
    forward, port = state.velocity
    cosine, sine = math.cos(state.yaw), math.sin(state.yaw)
    velocity = np.array([cosine * forward - sine * port, sine * forward + cosine * port])
    x, y = state.position
    values = {
        **_head(state.stamp, "own_ship", TrackStatus.CONFIRMED),
        **{"status": "", "frame": MAP_FRAME, "x_m": x, "y_m": y},
        **{"vx_m_s": float(velocity[0]), "vy_m_s": float(velocity[1])},
        "speed_m_s": float(np.hypot(*velocity)),
        "course_deg": float(compass_from_vector(velocity)),
        "heading_deg": float(compass_from_azimuth(state.yaw)),
    }
    place = _places(np.array([state.position]), datum)[0]
    return _row(state.stamp, (x, y), place, True, values)


def _head(stamp: int, kind: str, status: int) -> dict[str, Any]:
    return {
        "time": utc_text(stamp),
        "stamp_ns": stamp,
        "kind": kind,
        "status": _name(TrackStatus, status),
    }


def _row(
    stamp: int,
    position: tuple[float, float],
    place: FloatArray,
    is_established: bool,
    values: dict[str, Any],
) -> ExportRow:
    # 1e-8 degrees are 1 mm.
    latitude, longitude = (round(float(angle), 8) for angle in place)
    values |= {"latitude_deg": latitude, "longitude_deg": longitude}
    return ExportRow(stamp, position, (latitude, longitude), is_established, values)


def _places(positions: FloatArray, datum: Datum | None) -> FloatArray:
    if datum is None or not len(positions):
        return np.full((len(positions), 2), np.nan)
    return surface_places(positions, datum)


def _contributors(tracks: PositionTracks) -> list[str]:
    """Return the tracks each row was made from, e.g. ``tma:array:3;active:sonar:1``."""
    parts: list[list[str]] = [[] for _ in range(len(tracks))]
    for row, source, sensor, track in zip(
        tracks.contributor_track,
        tracks.contributor_source,
        tracks.contributor_sensor,
        tracks.contributor_id,
        strict=True,
    ):
        parts[row].append(f"{_name(TrackSource, source)}:{sensor}:{track}")
    return [";".join(entries) for entries in parts]


def _name(codes: Any, code: int) -> str:
    """Return the name of a code; of one that is not known the number."""
    return str(codes(code).name).lower() if code in list(codes) else str(int(code))
