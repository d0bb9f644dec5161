"""True positions at the instants of the data: of a table, or of ships by their AIS."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from sonar_tracking.bags.importers.map_origin import MapOrigin
from sonar_tracking.bags.importers.nmea_log import looks_like_nmea, read_nmea_log, ships_of_log
from sonar_tracking.bags.importers.own_ship_track import check_overlap, interpolated
from sonar_tracking.bags.importers.position_tables import true_positions_of_table
from sonar_tracking.bags.importers.surveyed_positions import SurveyedPositions
from sonar_tracking.bags.nmea.ship_histories import ShipHistory
from sonar_tracking.records.arrays import FloatArray, IntArray
from sonar_tracking.records.positions import TruthTracks
from sonar_tracking.records.time import END_OF_DATA, seconds

_States = Mapping[int, FloatArray]
"""Target, its x, y, vx, vy in ``map``, m and m/s."""


def true_tracks_at(
    path: Path | str | None,
    stamps: IntArray,
    epoch: int,
    notes: list[str],
    origin: MapOrigin | None = None,
) -> tuple[TruthTracks, ...]:
    """Return the true states at some instants, each target from its first to its last position.

    Targets of a table are numbered from 1 and go straight between two positions. Ships have their
    MMSI for a number, follow their course and speed between two reports, and are left out of gaps.

    Parameters
    ----------
    path : Path or str, optional
        CSV, npz, or a log of NMEA 0183 with AIS; without it there is no truth.
    stamps : ndarray of int, shape (n,)
        Of the data, ascending, ns.
    epoch : int
        Instant of ``time_s`` = 0, and date of a log that has none, ns.
    notes : list of str
        Told what was left out.
    origin : MapOrigin, optional
        The datum; default: of this file alone.

    Raises
    ------
    ConfigurationError
        If the file cannot be used, or has no instant in common with the data.
    """
    if path is None:
        return ()
    origin = origin or MapOrigin()
    if looks_like_nmea(path):
        ships, told = ships_of_log(read_nmea_log(path), epoch, origin)
        whole = np.unique(np.concatenate([np.array(ship.stamps) for ship in ships.values()]))
        states = ship_states(ships, stamps)
    else:
        targets, told = true_positions_of_table(path, epoch, origin)
        whole = np.unique(np.concatenate([surveyed.stamp for surveyed in targets.values()]))
        states = _table_states(targets, stamps)
    notes.extend(told)
    check_overlap(str(path), whole, stamps)
    return truth_pictures(states, stamps)


def ship_states(ships: Mapping[int, ShipHistory], stamps: IntArray) -> list[_States]:
    """Return the ships that are known at each instant, with their states.

    Parameters
    ----------
    ships : mapping of int to ShipHistory
        By MMSI.
    stamps : ndarray of int, shape (n,)
        ns.
    """
    pictures: list[_States] = []
    for stamp in stamps.tolist():
        known = {mmsi: ship.at(stamp) for mmsi, ship in ships.items()}
        pictures.append({mmsi: one.state for mmsi, one in known.items() if one is not None})
    return pictures


def truth_pictures(states: Sequence[_States], stamps: IntArray) -> tuple[TruthTracks, ...]:
    """Return true states as they stand in messages.

    Parameters
    ----------
    states : sequence of mapping of int to ndarray, shape (4,)
        The targets at each instant.
    stamps : ndarray of int, shape (n,)
        ns.
    """
    following = [*stamps[1:].tolist(), END_OF_DATA]
    truth = []
    for here, stamp, next_stamp in zip(states, stamps.tolist(), following, strict=True):
        rows = np.array(list(here.values())).reshape(-1, 4)
        truth.append(
            TruthTracks(
                stamp=stamp,
                id=np.array(list(here), dtype=np.uint64),
                position=rows[:, :2],
                velocity=rows[:, 2:],
                next_stamp=next_stamp,
            )
        )
    return tuple(truth)


def _table_states(targets: Mapping[int, SurveyedPositions], stamps: IntArray) -> list[_States]:
    begin = stamps[0]
    rows = {
        target: np.concatenate(
            interpolated(
                seconds(surveyed.stamp - begin), surveyed.position, seconds(stamps - begin)
            ),
            axis=1,
        )
        for target, surveyed in targets.items()
    }
    return [
        {t: rows[t][i] for t, s in targets.items() if s.stamp[0] <= stamp <= s.stamp[-1]}
        for i, stamp in enumerate(stamps)
    ]
