"""True positions at the instants of the data: of tables, or of ships by their AIS."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from sonar_tracking.bags.nmea.ship_histories import ShipHistory
from sonar_tracking.bags.positions.given_files import Files, files_text, logs_beside_tables
from sonar_tracking.bags.positions.joined_positions import joined_positions
from sonar_tracking.bags.positions.map_origin import MapOrigin
from sonar_tracking.bags.positions.nmea_log import NmeaLog, NmeaLogs
from sonar_tracking.bags.positions.nmea_tracks import ships_of_logs
from sonar_tracking.bags.positions.own_ship_track import check_overlap, interpolated
from sonar_tracking.bags.positions.position_tables import true_positions_of_table
from sonar_tracking.bags.positions.surveyed_positions import SurveyedPositions
from sonar_tracking.errors import shown
from sonar_tracking.records.arrays import FloatArray, IntArray
from sonar_tracking.records.positions import TruthTracks
from sonar_tracking.records.time import END_OF_DATA, seconds

_States = Mapping[int, FloatArray]
"""Target, its x, y, vx, vy in ``map``, m and m/s."""

_AT_ONCE = 1024
"""Instants whose states are held at once."""


class TrueTargets:
    """Where targets were.

    Targets of a table are numbered from 1 and go straight between two positions, from the first to
    the last. Ships have their MMSI for a number, follow their course and speed between two reports,
    and are left out of gaps.

    Parameters
    ----------
    ships : mapping of int to ShipHistory
        By MMSI.
    targets : mapping of int to SurveyedPositions
        By number.
    """

    def __init__(
        self, ships: Mapping[int, ShipHistory], targets: Mapping[int, SurveyedPositions]
    ) -> None:
        self._ships = {mmsi: ship for mmsi, ship in ships.items() if ship.stamps}
        self._targets = targets

    def known(self) -> IntArray:
        """Return the instants at which any target was seen, shape (n,), ascending, ns."""
        told = [np.array(ship.stamps, np.int64) for ship in self._ships.values()]
        told += [surveyed.stamp for surveyed in self._targets.values()]
        return np.unique(np.concatenate([np.zeros(0, np.int64), *told]))

    def pictures(self, stamps: IntArray) -> Iterator[TruthTracks]:
        """Yield the targets at some instants (ascending, ns) as they stand in messages."""
        for begin in range(0, len(stamps), _AT_ONCE):
            some = stamps[begin : begin + _AT_ONCE]
            following = [*stamps[begin + 1 : begin + _AT_ONCE + 1].tolist(), END_OF_DATA]
            for here, stamp, next_stamp in zip(
                self._at(some), some.tolist(), following, strict=False
            ):
                rows = np.array(list(here.values())).reshape(-1, 4)
                yield TruthTracks(
                    stamp=stamp,
                    id=np.array(list(here), dtype=np.uint64),
                    position=rows[:, :2],
                    velocity=rows[:, 2:],
                    next_stamp=next_stamp,
                )

    def _at(self, stamps: IntArray) -> Sequence[_States]:
        """Return the targets that are known at each instant (ns), with their states."""
        found: list[dict[int, FloatArray]] = [{} for _ in stamps]
        for target, surveyed in self._targets.items():
            known, wanted = seconds(surveyed.stamp - stamps[0]), seconds(stamps - stamps[0])
            states = np.concatenate(interpolated(known, surveyed.position, wanted), axis=1)
            there = (stamps >= surveyed.stamp[0]) & (stamps <= surveyed.stamp[-1])
            for index in np.flatnonzero(there):
                found[index][target] = states[index]
        for mmsi, ship in self._ships.items():
            for here, stamp in zip(found, stamps.tolist(), strict=True):
                if (one := ship.at(stamp)) is not None:
                    here[mmsi] = one.state
        return found


def read_true_targets(
    given: Files,
    epoch: int,
    notes: list[str],
    origin: MapOrigin | None = None,
    logs: NmeaLogs | None = None,
) -> TrueTargets:
    """Read files of true positions; several follow one another, in any order.

    Parameters
    ----------
    given : Path, str, or sequence of them
        CSV, npz, or logs of NMEA 0183 with AIS.
    epoch : int
        Instant of ``time_s`` = 0, and date of a log that has none, ns.
    notes : list of str
        Told what was left out.
    origin : MapOrigin, optional
        The datum; default: of these files alone.
    logs : NmeaLogs, optional
        Logs that were read already.

    Raises
    ------
    ConfigurationError
        If a file cannot be used.
    """
    origin, logs = origin or MapOrigin(), logs or NmeaLogs()
    named: dict[str, list[SurveyedPositions]] = {}

    def take_table(path: Path) -> None:
        targets, told = true_positions_of_table(path, epoch, origin)
        notes.extend(told)
        for name, surveyed in targets.items():
            named.setdefault(name, []).append(surveyed)

    with_ships = logs_beside_tables(given, take_table, NmeaLog.check_ships, logs, notes)
    ships: dict[int, ShipHistory] = {}
    if with_ships:
        ships, told = ships_of_logs(with_ships, epoch, origin)
        notes.extend(told)
    tables = {
        number: joined_positions(parts, notes, f"the target {shown(name)}")
        for number, (name, parts) in enumerate(named.items(), start=1)
    }
    return TrueTargets(ships, tables)


def true_tracks_at(
    given: Files | None,
    stamps: IntArray,
    epoch: int,
    notes: list[str],
    origin: MapOrigin | None = None,
    logs: NmeaLogs | None = None,
) -> tuple[TruthTracks, ...]:
    """Return the true states at some instants; see :class:`TrueTargets`.

    Parameters
    ----------
    given : Path, str, or sequence of them, optional
        As of :func:`read_true_targets`; without it there is no truth.
    stamps : ndarray of int, shape (n,)
        Of the data, ascending, ns.
    epoch, notes, origin, logs
        As of :func:`read_true_targets`.

    Raises
    ------
    ConfigurationError
        If a file cannot be used, or they have no instant in common with the data.
    """
    if given is None:
        return ()
    targets = read_true_targets(given, epoch, notes, origin, logs)
    check_overlap(files_text(given), targets.known(), stamps)
    return tuple(targets.pictures(stamps))
