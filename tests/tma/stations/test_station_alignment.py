"""Protects that stations which are turned are found, and spoil positions no longer."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest

from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.simulation.scenarios.bearing_sensor_configuration import (
    BearingSensorConfiguration,
)
from sonar_tracking.simulation.scenarios.kinematic_motion import KinematicMotion
from sonar_tracking.simulation.scenarios.platforms import TurnConfiguration
from sonar_tracking.simulation.scenarios.target import LineConfiguration, TargetConfiguration
from sonar_tracking.simulation.sensors.bearing_simulation import SimulatedFrame
from sonar_tracking.tma.targets.passive_frame import PassiveFrame, TmaUpdate
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration
from sonar_tracking.tma.tracker.tma_tracker_stage import TmaTrackerStage
from tests.tma.passive_scene import (
    DIRECTIONS,
    FAR,
    NEAR,
    TURNING,
    fed_together,
    listed,
    running,
    scene,
    simulated,
)

ABOARD = replace(DIRECTIONS, frame_interval=8.0)
BUOY = BearingSensorConfiguration(
    sensor_id="buoy",
    namespace="buoy",
    platform="fixed",
    position=(3000.0, -500.0),
    angle_kind="azimuth",
    frame_interval=8.0,
)
TOLD = TmaTrackerConfiguration()
"""Stations are taken to be aligned, whatever their bearings tell."""

SOUGHT = TmaTrackerConfiguration(alignment_deviation_deg=2.0)

SCORED = 600.0
"""From when on positions are scored, s."""

SEEDS = {0.0: (1, 2), 1.0: (1, 2), 3.0: (1,)}
"""Of the runs in which a station is turned by so many degrees; by the most, one shows it."""

MISALIGNED = "from what its data tell"
"""Said of a station that is turned."""


@dataclass(frozen=True)
class Run:
    """One run: root mean square error of positions, m, and what is said of the stations."""

    rmse: float
    sensors: tuple[str, ...]
    misalignment: FloatArray
    deviation: FloatArray
    notices: tuple[str, ...]


def scored(frames: list[tuple[PassiveFrame, SimulatedFrame]], updates: list[TmaUpdate]) -> Run:
    """Return what came of a run."""
    begin, squares = frames[0][0].stamp, []
    for (frame, truth), update in zip(frames, updates, strict=True):
        if frame.stamp - begin < SCORED * 1e9:
            continue
        found = running(listed(update)).state[:, :2]
        for position in truth.truth_tracks.position:
            squares.append(np.min(np.sum((found - position) ** 2, axis=1)))
    notices = tuple(notice.text for update in updates for notice in update.notices)
    rmse, told = float(np.sqrt(np.mean(squares))), updates[-1].alignments
    if told is None:
        return Run(rmse, (), np.empty(0), np.empty(0), notices)
    columns = told.misalignment, told.misalignment_standard_deviation
    return Run(rmse, told.sensor_id, *columns, notices)


@cache
def followed() -> dict[tuple[float, bool], list[Run]]:
    """Return how two targets are followed by own ship and a buoy that is turned, seed by seed.

    By how many degrees it is turned, and whether that is sought.
    """
    cases, stages, seen = [], [], []
    for misalignment_deg, seeds in SEEDS.items():
        stations = (ABOARD, replace(BUOY, misalignment_deg=misalignment_deg))
        for seed in seeds:
            sea = scene(*stations, targets=(NEAR, FAR), duration=700.0, seed=seed)
            frames = simulated(sea)
            for sought, configuration in ((True, SOUGHT), (False, TOLD)):
                cases.append((misalignment_deg, sought))
                stages.append(TmaTrackerStage(configuration, n_stations=2))
                seen.append(frames)
    updates = fed_together(stages, [[frame for frame, _ in frames] for frames in seen])
    runs: dict[tuple[float, bool], list[Run]] = {}
    for case, frames, own in zip(cases, seen, updates, strict=True):
        runs.setdefault(case, []).append(scored(frames, own))
    return runs


def together(runs: list[Run]) -> float:
    return float(np.sqrt(np.mean([run.rmse**2 for run in runs])))


@pytest.mark.slow
@pytest.mark.parametrize(("misalignment_deg", "part"), [(1.0, 0.5), (3.0, 0.3)])
def test_a_turned_station_is_found_and_spoils_positions_no_longer(
    misalignment_deg: float, part: float
) -> None:
    runs, told = (followed()[misalignment_deg, sought] for sought in (True, False))
    assert together(runs) < part * together(told)
    errors = []
    for run in runs:
        own = run.sensors.index("buoy")
        errors.append((run.misalignment[own] - np.radians(misalignment_deg)) / run.deviation[own])
        assert any(MISALIGNED in text for text in run.notices)
    assert np.mean(np.square(errors)) < 2.5


@pytest.mark.slow
def test_aligned_stations_lose_nothing() -> None:
    for run, told in zip(followed()[0.0, True], followed()[0.0, False], strict=True):
        assert run.rmse == told.rmse
        assert not any(MISALIGNED in text for text in run.notices)
        assert np.all(np.abs(run.misalignment) < run.deviation)


def test_one_station_alone_tells_nothing_of_its_alignment() -> None:
    stage = TmaTrackerStage(SOUGHT, n_stations=1)
    turned = replace(ABOARD, misalignment_deg=3.0)
    for frame, _ in simulated(scene(turned, targets=(NEAR,), duration=60.0)):
        alignments = stage.update(frame).alignments
    assert alignments is not None
    assert alignments.misalignment == pytest.approx([0.0])
    assert np.degrees(alignments.misalignment_standard_deviation[0]) > 0.5


def test_nothing_is_told_of_misalignments_that_are_not_estimated() -> None:
    stage = TmaTrackerStage(TOLD, n_stations=2)
    for frame, _ in simulated(scene(ABOARD, BUOY, targets=(NEAR,), duration=20.0)):
        assert stage.update(frame).alignments is None


def ship(
    position: tuple[float, float], course_deg: float, speed: float, *turns: tuple[float, ...]
) -> TargetConfiguration:
    """Return a ship that turns at times, s, to courses, deg, by so many degrees a second."""
    motion = KinematicMotion(
        position=position,
        course_deg=course_deg,
        speed=speed,
        turns=tuple(TurnConfiguration(*one) for one in turns),
    )
    lines = (LineConfiguration(150.0), LineConfiguration(260.0))
    return TargetConfiguration(name="ship", lines=lines, motion=motion)


TURNING_SHIPS = (
    ship((-2458.0, 1552.0), 90.0, 3.9, (527.0, 184.0, 0.8)),
    ship((1320.0, 1868.0), 183.0, 4.0, (163.0, 273.0, 1.1), (401.0, 321.0, 0.7)),
    ship((1748.0, 3034.0), 123.0, 4.4, (252.0, 220.0, 0.4), (402.0, 237.0, 0.8)),
)
"""One near the line between own ship and the buoy, one that passes close to own ship."""


@pytest.mark.slow
def test_ships_that_turn_near_two_aligned_stations_turn_none() -> None:
    near = replace(BUOY, position=(4000.0, -500.0))
    stations = tuple(
        replace(one, frequency_standard_deviation=0.1, frame_interval=4.0) for one in (ABOARD, near)
    )
    stage = TmaTrackerStage(SOUGHT, n_stations=2)
    slow = replace(TURNING, speed=3.0)
    sea = scene(*stations, own_ship=slow, targets=TURNING_SHIPS, duration=560.0, seed=4)
    for frame, _ in simulated(sea):
        update = stage.update(frame)
        assert not any(MISALIGNED in notice.text for notice in update.notices)
    known = update.alignments
    assert known is not None
    assert np.all(np.abs(known.misalignment) < known.misalignment_standard_deviation)
