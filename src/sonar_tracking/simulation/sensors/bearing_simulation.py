"""Measurement-level simulation: stations that report bearings and frequency lines of the targets.

Every station has its own generator, and every frame draws numbers for all targets and all lines in
it, so that neither schedules nor other stations change what a station measures.

References
----------
Cheong (2011), eqs. 6, 7; scenes S1 to S3 are scenarios of this simulation.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.records.bearings import BearingTracks
from sonar_tracking.records.lines import FrequencyLines
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.positions import TruthTracks
from sonar_tracking.records.time import END_OF_DATA, nanoseconds
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.sensors.bearing_station import BearingStation
from sonar_tracking.simulation.world.world_state import own_ship_at, true_tracks

RANDOM_STREAM = 101
"""Of the stations among those of the seed, beside an array, which has the first ones."""


@dataclass(frozen=True)
class StationReport:
    """What one station tells at one instant, and what is true there.

    Attributes
    ----------
    station : int
        Number of the station in the scenario, from 0.
    bearings : BearingTracks or None
        Measured; None = the frame is missing.
    lines : FrequencyLines or None
        Measured, of the same frame.
    truth : BearingTracks
        True angles; identifiers are the numbers of the targets, from 1.
    """

    station: int
    bearings: BearingTracks | None
    lines: FrequencyLines | None
    truth: BearingTracks


@dataclass(frozen=True)
class SimulatedFrame:
    """Everything that belongs to one instant.

    Attributes
    ----------
    start_stamp : int
        The instant, ns.
    due_stamp : int
        When it is reported, ns.
    own_ship : OwnShipState
        At the stamp.
    truth_tracks : TruthTracks
        At the stamp.
    reports : tuple of StationReport
        Of the stations whose frame it is.
    """

    start_stamp: int
    due_stamp: int
    own_ship: OwnShipState
    truth_tracks: TruthTracks
    reports: tuple[StationReport, ...]


class BearingSimulation:
    """Makes the frames of all stations, in the order of their stamps.

    Parameters
    ----------
    scenario : Scenario
        With stations (``bearing_sensors``) and targets of kinematic motion.
    """

    def __init__(self, scenario: Scenario) -> None:
        sensors = scenario.bearing_sensors
        self._scenario = scenario
        self._step = nanoseconds(min(sensor.frame_interval for sensor in sensors))
        self._end = scenario.stamp(scenario.start + scenario.duration)
        streams = (RANDOM_STREAM,) if scenario.array_given else ()
        seeds = np.random.SeedSequence(scenario.seed, spawn_key=streams).spawn(len(sensors))
        self._frames = [sensor.number_of_frames(scenario.duration) for sensor in sensors]
        self._stations = [
            BearingStation(
                sensor,
                sensor.trajectory(scenario.platforms),
                scenario.targets,
                np.random.default_rng(seed),
                scenario.start + np.arange(count, dtype=np.float64) * sensor.frame_interval,
            )
            for sensor, seed, count in zip(sensors, seeds, self._frames, strict=True)
        ]
        self._next = [0] * len(sensors)

    def next_frame(self) -> SimulatedFrame | None:
        """Return the next frame, or None after the last one."""
        stamp = self._earliest()
        if stamp == END_OF_DATA:
            return None
        time = next(
            self._time_of(station)
            for station in reversed(range(len(self._stations)))
            if self._stamp_of(station) == stamp
        )
        reports = self.next_reports()
        return SimulatedFrame(
            start_stamp=stamp,
            due_stamp=max(min(stamp + self._step, self._end), stamp + 1),
            own_ship=own_ship_at(self._scenario, time),
            truth_tracks=true_tracks(self._scenario, time, self._earliest()),
            reports=reports,
        )

    def next_reports(self) -> tuple[StationReport, ...]:
        """Return what the stations tell in the next frame, one at least; none after the last."""
        stamp = self._earliest()
        if stamp == END_OF_DATA:
            return ()
        due = [one for one in range(len(self._stations)) if self._stamp_of(one) == stamp]
        return tuple(self._report(station, stamp) for station in due)

    def _earliest(self) -> int:
        return min(self._stamp_of(station) for station in range(len(self._stations)))

    def _time_of(self, station: int) -> float:
        interval = self._scenario.bearing_sensors[station].frame_interval
        return self._scenario.start + self._next[station] * interval

    def _stamp_of(self, station: int) -> int:
        """Stamp of the next frame of a station; END_OF_DATA after its last one."""
        if self._next[station] >= self._frames[station]:
            return END_OF_DATA
        return self._scenario.stamp(self._time_of(station))

    def _report(self, station: int, stamp: int) -> StationReport:
        frame = self._next[station]
        self._next[station] += 1
        next_stamp = self._stamp_of(station)
        made = self._stations[station]
        truth = made.truth(frame, stamp, next_stamp)
        measured = made.measure(frame, truth, last=next_stamp == END_OF_DATA)
        bearings, lines = measured if measured is not None else (None, None)
        return StationReport(station, bearings, lines, truth)
