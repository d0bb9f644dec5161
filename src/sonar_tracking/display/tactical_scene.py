"""What lies on the chart: own ship, targets, tracks, contacts and bearings in ``map``."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np

from sonar_tracking.active.contacts.contact_positions import place_contacts
from sonar_tracking.display.position_history import PositionHistory
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import AngleKind, BearingTracks
from sonar_tracking.records.contacts import Contacts
from sonar_tracking.records.datum import Datum
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.time import seconds
from sonar_tracking.sensor_pose import yaw_of


def _nothing(width: int) -> FloatArray:
    return np.empty((0, width))


@dataclass(frozen=True)
class TacticalScene:
    """What is drawn on one chart.

    Attributes
    ----------
    start : int
        Stamp of time zero, ns.
    own_ship : ndarray, shape (n, 4)
        Time (s), x, y (m), yaw (rad).
    other_ships : mapping of str to ndarray, shape (n, 4)
        Time (s), x, y (m), yaw (rad) of other ships of own side, by their names.
    truth : tuple of PositionHistory
        The targets.
    tracks : mapping of str to tuple of PositionHistory
        Established tracks by topic.
    open_tracks : tuple of PositionHistory
        Positions that do not claim a target yet.
    contacts : ndarray, shape (n_contacts, 3)
        Time (s), x, y (m).
    bearings : ndarray, shape (n_bearings, 4)
        Time (s), x, y (m) of the sensor, azimuth (rad).
    stations : mapping of str to tuple of float
        x, y (m) of sensors at rest.
    datum : Datum or None
        Of ``map``; None = latitudes and longitudes are not drawn.
    """

    start: int
    own_ship: FloatArray = field(default_factory=lambda: _nothing(4))
    other_ships: Mapping[str, FloatArray] = field(default_factory=dict)
    truth: tuple[PositionHistory, ...] = ()
    tracks: Mapping[str, tuple[PositionHistory, ...]] = field(default_factory=dict)
    open_tracks: tuple[PositionHistory, ...] = ()
    contacts: FloatArray = field(default_factory=lambda: _nothing(3))
    bearings: FloatArray = field(default_factory=lambda: _nothing(4))
    stations: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    datum: Datum | None = None

    @property
    def is_empty(self) -> bool:
        """Whether there is nothing whose place is known but own ship."""
        return not (self.truth or any(self.tracks.values()) or len(self.contacts))


def own_ship_track(states: Iterable[OwnShipState], start: int) -> FloatArray:
    """Return own ship's track in order of time.

    Parameters
    ----------
    states : iterable of OwnShipState
        In any order.
    start : int
        Stamp of time zero, ns.

    Returns
    -------
    ndarray, shape (n, 4)
        Time (s), x, y (m), yaw (rad).
    """
    rows = [(seconds(state.stamp - start), *state.position, state.yaw) for state in states]
    return np.array(sorted(rows)).reshape(-1, 4)


def contact_points(pings: Iterable[Contacts], start: int, sound_speed: float) -> FloatArray:
    """Return where the contacts of all pings lie, those whose sensor's place is known.

    Parameters
    ----------
    pings : iterable of Contacts
        In order.
    start : int
        Stamp of time zero, ns.
    sound_speed : float
        m/s; 0 = the ping takes no time.

    Returns
    -------
    ndarray, shape (n_contacts, 3)
        Time (s), x, y (m).
    """
    parts = [_nothing(3)]
    for ping in pings:
        position = place_contacts(ping, sound_speed).position
        time = np.full((len(position), 1), seconds(ping.stamp - start))
        rows = np.concatenate([time, position], axis=1)
        parts.append(rows[np.all(np.isfinite(rows), axis=1)])
    return np.concatenate(parts)


def bearing_lines(lists: Iterable[BearingTracks], start: int) -> FloatArray:
    """Return the directions of established bearing tracks, both where two sides are possible.

    With azimuth psi of the array's axis, an arrival angle theta from broadside is the azimuth
    psi + (pi/2 - theta) on the left and psi - (pi/2 - theta) on the right.

    Parameters
    ----------
    lists : iterable of BearingTracks
        Lists that do not tell the sensor's pose are left out.
    start : int
        Stamp of time zero, ns.

    Returns
    -------
    ndarray, shape (n_bearings, 4)
        Time (s), x, y (m) of the sensor, azimuth (rad).
    """
    rows = []
    for entry in lists:
        time = seconds(entry.stamp - start)
        x, y = entry.sensor.position[:2]
        shown = entry.established
        for angle in entry.arrival_angle[shown & np.isfinite(entry.arrival_angle)]:
            rows += [(time, x, y, azimuth) for azimuth in _azimuths(entry, float(angle))]
    lines = np.array(rows).reshape(-1, 4)
    return lines[np.all(np.isfinite(lines), axis=1)]


def stations_at_rest(lists: Iterable[BearingTracks]) -> dict[str, tuple[float, float]]:
    """Return the places of the sensors that do not move, by name.

    Parameters
    ----------
    lists : iterable of BearingTracks
        Lists that do not tell the sensor's place are left out.
    """
    places: dict[str, set[tuple[float, float]]] = {}
    for entry in lists:
        place = entry.sensor.position[:2]
        if np.isfinite(place).all():
            places.setdefault(entry.sensor.sensor_id, set()).add(place)
    return {name: next(iter(each)) for name, each in places.items() if len(each) == 1}


def _azimuths(entry: BearingTracks, angle: float) -> tuple[float, ...]:
    if entry.angle_kind == AngleKind.AZIMUTH:
        return (angle,)
    axis = yaw_of(entry.sensor.orientation)
    return axis + (0.5 * math.pi - angle), axis - (0.5 * math.pi - angle)
