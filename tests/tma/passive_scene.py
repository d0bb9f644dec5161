"""Frames of simulated stations, for tests of the stage."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import BearingTracks, TrackStatus
from sonar_tracking.records.positions import PositionTracks
from sonar_tracking.simulation.scenarios.bearing_sensor_configuration import (
    BearingSensorConfiguration,
)
from sonar_tracking.simulation.scenarios.kinematic_motion import KinematicMotion
from sonar_tracking.simulation.scenarios.platforms import OwnShipConfiguration, TurnConfiguration
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.scenarios.target import LineConfiguration, TargetConfiguration
from sonar_tracking.simulation.sensors.bearing_simulation import BearingSimulation, SimulatedFrame
from sonar_tracking.tma.targets.passive_frame import PassiveFrame, TmaUpdate
from sonar_tracking.tma.tracker.tma_tracker_stage import TmaTrackerStage, update_together

SECOND = 10**9
LINES = (LineConfiguration(210.0), LineConfiguration(300.0), LineConfiguration(350.0))
ARRAY = BearingSensorConfiguration(frequency_standard_deviation=0.1)
DIRECTIONS = replace(ARRAY, angle_kind="azimuth")
NEAR = TargetConfiguration(
    name="near",
    lines=LINES,
    motion=KinematicMotion(position=(4000.0, 3000.0), course_deg=270.0, speed=3.0),
)
FAR = TargetConfiguration(
    name="far",
    lines=(LineConfiguration(180.0), LineConfiguration(260.0)),
    motion=KinematicMotion(position=(-2000.0, 4500.0), course_deg=110.0, speed=7.0),
)
TURNING = OwnShipConfiguration(
    course_deg=90.0,
    speed=6.0,
    turns=(TurnConfiguration(100.0, 0.0, 5.0), TurnConfiguration(200.0, 90.0, 5.0)),
)
STRAIGHT = OwnShipConfiguration(course_deg=90.0, speed=6.0)


def scene(*sensors: BearingSensorConfiguration, **changes: Any) -> Scenario:
    """Return a scene of own ship that turns and one target, with some of it changed."""
    made = Scenario(
        array_given=False,
        bearing_sensors=sensors or (ARRAY,),
        own_ship=TURNING,
        targets=(NEAR,),
        duration=250.0,
        seed=5,
    )
    return replace(made, **changes)


def simulated(scenario: Scenario) -> list[tuple[PassiveFrame, SimulatedFrame]]:
    """Return what a stage takes, frame by frame, and the truth beside it."""
    simulation = BearingSimulation(scenario)
    frames = []
    while (frame := simulation.next_frame()) is not None:
        bearings = [one.bearings for one in frame.reports if one.bearings is not None]
        lines = [one.lines for one in frame.reports if one.lines is not None]
        if bearings:
            passive = PassiveFrame(frame.start_stamp, tuple(bearings), tuple(lines))
            frames.append((passive, frame))
    return frames


def frames_of(scenario: Scenario) -> list[PassiveFrame]:
    """Return what a stage takes, frame by frame."""
    return [frame for frame, _ in simulated(scenario)]


def fed(stage: TmaTrackerStage, frames: Sequence[PassiveFrame]) -> list[TmaUpdate]:
    """Return what follows from each frame."""
    return [stage.update(frame) for frame in frames]


def fed_together(
    stages: Sequence[TmaTrackerStage], frames: Sequence[Sequence[PassiveFrame]]
) -> list[list[TmaUpdate]]:
    """Return what follows from each frame in runs that know nothing of each other.

    All go on at once, which costs less: tests/tma/tracker/test_joint_observation.py protects that
    they give what each gives by itself.
    """
    updates = [update_together(stages, instant) for instant in zip(*frames, strict=True)]
    return [list(own) for own in zip(*updates, strict=True)]


def listed(update: TmaUpdate) -> PositionTracks:
    """Return the list of a frame that must have one."""
    assert update.tracks is not None
    return update.tracks


def running(tracks: PositionTracks) -> PositionTracks:
    """Return the rows that have not ended."""
    return tracks.selected(tracks.status != TrackStatus.TERMINATED)


def error_of(tracks: PositionTracks, frame: SimulatedFrame, target: int = 0) -> float:
    """Return the distance of the only running row from a target, m."""
    (state,) = running(tracks).state
    return float(np.hypot(*(state[:2] - frame.truth_tracks.position[target])))


def consistency(tracks: PositionTracks, frame: SimulatedFrame, row: int, target: int) -> float:
    """Return the squared normalised error of a row, 4 degrees of freedom."""
    truth = np.concatenate(
        [frame.truth_tracks.position[target], frame.truth_tracks.velocity[target]]
    )
    error = tracks.state[row] - truth
    return float(error @ np.linalg.solve(tracks.covariance[row], error))


def with_bearings(frame: PassiveFrame, **changes: Any) -> PassiveFrame:
    """Return a frame whose first station says something else."""
    return replace(frame, bearings=(replace(frame.bearings[0], **changes), *frame.bearings[1:]))


def one_value(values: FloatArray, value: float) -> FloatArray:
    """Return a column with its first entry changed."""
    changed = values.copy()
    changed[0] = value
    return changed


def without_pose(bearings: BearingTracks) -> BearingTracks:
    """Return a list that does not tell where its station is."""
    unknown = (np.nan,) * 3
    sensor = replace(bearings.sensor, position=unknown, velocity=unknown, orientation=(np.nan,) * 4)
    return replace(bearings, sensor=sensor)
