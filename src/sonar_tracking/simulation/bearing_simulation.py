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

from sonar_tracking.motion import wrap_angle
from sonar_tracking.passive.line_records import FrequencyLines
from sonar_tracking.passive.records import END_OF_DATA, BearingTracks
from sonar_tracking.simulation.bearing_sensor_configuration import BearingSensorConfiguration
from sonar_tracking.simulation.bearing_station import BearingStation
from sonar_tracking.simulation.kinematic_motion import KinematicMotion
from sonar_tracking.simulation.platforms import OwnShipConfiguration
from sonar_tracking.simulation.records import OwnShipState, TruthTracks
from sonar_tracking.simulation.target import TargetConfiguration


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
    stamp : int
        ns.
    own_ship : OwnShipState
        At the stamp.
    truth_tracks : TruthTracks
        At the stamp.
    reports : tuple of StationReport
        Of the stations whose frame it is.
    """

    stamp: int
    own_ship: OwnShipState
    truth_tracks: TruthTracks
    reports: tuple[StationReport, ...]


@dataclass(frozen=True)
class BearingScene:
    """What the stations are, and what they listen to.

    Attributes
    ----------
    sensors : tuple of BearingSensorConfiguration
        The stations.
    own_ship : OwnShipConfiguration
        Carries some of them.
    targets : tuple of TargetConfiguration
        Their motions are kinematic.
    start, duration : float
        Scenario time of the first frames, and length, s.
    seed : int
        Of all random numbers.
    epoch : int
        Stamp of scenario time 0, ns.
    """

    sensors: tuple[BearingSensorConfiguration, ...]
    own_ship: OwnShipConfiguration
    targets: tuple[TargetConfiguration, ...]
    start: float
    duration: float
    seed: int
    epoch: int

    def stamp(self, time: float) -> int:
        """Return the stamp (ns) of a scenario time (s)."""
        return self.epoch + round(time * 1e9)


class BearingSimulation:
    """Makes the frames of all stations, in the order of their stamps.

    Parameters
    ----------
    scene : BearingScene
        What to simulate.
    """

    def __init__(self, scene: BearingScene) -> None:
        self._scene = scene
        self._own_ship = scene.own_ship.trajectory()
        seeds = np.random.SeedSequence(scene.seed).spawn(len(scene.sensors))
        self._stations = [
            BearingStation(
                sensor,
                sensor.trajectory(scene.own_ship),
                scene.targets,
                np.random.default_rng(seed),
            )
            for sensor, seed in zip(scene.sensors, seeds, strict=True)
        ]
        self._frames = [
            max(1, int(np.ceil(scene.duration / sensor.frame_interval - 1e-9)))
            for sensor in scene.sensors
        ]
        self._next = [0] * len(scene.sensors)

    def next_frame(self) -> SimulatedFrame | None:
        """Return the next frame, or None after the last one."""
        stamp = self._earliest()
        if stamp == END_OF_DATA:
            return None
        reports = []
        time = (stamp - self._scene.epoch) * 1e-9
        for station in range(len(self._stations)):
            if self._stamp_of(station) == stamp:
                time = self._time_of(station)
                reports.append(self._report(station, time))
        return SimulatedFrame(
            stamp=stamp,
            own_ship=self._own_ship_at(stamp, time),
            truth_tracks=self._truth_tracks(stamp, time),
            reports=tuple(reports),
        )

    def _earliest(self) -> int:
        return min(self._stamp_of(station) for station in range(len(self._stations)))

    def _time_of(self, station: int) -> float:
        interval = self._scene.sensors[station].frame_interval
        return self._scene.start + self._next[station] * interval

    def _stamp_of(self, station: int) -> int:
        """Stamp of the next frame of a station; END_OF_DATA after its last one."""
        if self._next[station] >= self._frames[station]:
            return END_OF_DATA
        return self._scene.stamp(self._time_of(station))

    def _report(self, station: int, time: float) -> StationReport:
        stamp = self._scene.stamp(time)
        self._next[station] += 1
        next_stamp = self._stamp_of(station)
        made = self._stations[station]
        truth = made.truth(time, stamp, next_stamp)
        measured = made.measure(time, truth, last=next_stamp == END_OF_DATA)
        bearings, lines = measured if measured is not None else (None, None)
        return StationReport(station, bearings, lines, truth)

    def _own_ship_at(self, stamp: int, time: float) -> OwnShipState:
        state = self._own_ship.state(time)
        return OwnShipState(
            stamp=stamp,
            position=(float(state.position[0]), float(state.position[1])),
            yaw=float(wrap_angle(state.azimuth)),
            velocity=(self._scene.own_ship.speed, 0.0),
            yaw_rate=float(state.turn_rate),
        )

    def _truth_tracks(self, stamp: int, time: float) -> TruthTracks:
        rows, states = [], []
        for index, target in enumerate(self._scene.targets):
            if isinstance(target.motion, KinematicMotion) and target.is_present(time):
                rows.append(index + 1)
                states.append(target.motion.trajectory.state(time))
        return TruthTracks(
            stamp=stamp,
            id=np.array(rows, dtype=np.uint64),
            position=np.array([state.position for state in states]).reshape(-1, 2),
            velocity=np.array([state.velocity for state in states]).reshape(-1, 2),
            next_stamp=self._earliest(),
        )
