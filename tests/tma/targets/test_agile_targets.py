"""Protects that two stations agree on a target that never goes straight for long."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import TrackStatus
from sonar_tracking.records.positions import PositionTracks
from sonar_tracking.simulation.scenarios.bearing_sensor_configuration import (
    BearingSensorConfiguration,
)
from sonar_tracking.tma.targets.passive_frame import PassiveFrame
from sonar_tracking.tma.targets.station_view import station_view
from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration
from sonar_tracking.tma.tracker.tma_tracker_stage import TmaTrackerStage
from tests.tma.passive_scene import NEAR, fed_together, frames_of, listed, running, scene

PLACES = {"west": (0.0, 0.0), "east": (1500.0, 0.0)}
HOME = np.array([700.0, 900.0])
DEVIATION = float(np.radians(0.5))
CONFIGURATION = TmaTrackerConfiguration(minimum_range=50.0, maximum_range=3000.0, maximum_speed=5.0)


def wandering_path(
    n_frames: int, acceleration: float, generator: np.random.Generator
) -> FloatArray:
    """Return where an animal is that turns as it likes and stays about its home, m."""
    position, velocity = HOME - [100.0, 0.0], np.array([1.5, 0.0])
    path = []
    for _ in range(n_frames):
        path.append(position)
        velocity = velocity + acceleration * generator.standard_normal(2)
        velocity = velocity * min(1.0, 3.0 / np.hypot(*velocity)) - 1e-4 * (position - HOME)
        position = position + velocity
    return np.array(path)


def seen(frame: PassiveFrame, place: FloatArray, generator: np.random.Generator) -> PassiveFrame:
    """Return a frame in which every station has the bearing of a place."""
    lists = []
    for one in frame.bearings:
        view = station_view(one.sensor, None, CONFIGURATION)
        (axis,) = view.azimuths(0.0, one.angle_kind, ambiguous=False)
        azimuth = np.arctan2(*(place - PLACES[one.sensor.sensor_id])[::-1])
        measured = wrap_angle(azimuth - axis + DEVIATION * generator.standard_normal())
        variance = np.array([DEVIATION**2])
        lists.append(replace(one, measurement=np.array([measured]), measurement_variance=variance))
    return replace(frame, bearings=tuple(lists), lines=())


SEEDS = (0, 3)


@cache
def followed() -> dict[int, tuple[FloatArray, PositionTracks]]:
    """Return where an animal is at last, m, and what the list says of it, by the seed."""
    stations = [
        BearingSensorConfiguration(
            sensor_id=name, namespace=name, platform="fixed", position=place, angle_kind="azimuth"
        )
        for name, place in PLACES.items()
    ]
    frames = frames_of(scene(*stations, targets=(replace(NEAR, lines=()),), duration=300.0))
    paths, told = [], []
    for seed in SEEDS:
        generator = np.random.default_rng(seed)
        paths.append(wandering_path(len(frames), 0.03, generator))
        pairs = zip(frames, paths[-1], strict=True)
        told.append([seen(frame, place, generator) for frame, place in pairs])
    updates = fed_together([TmaTrackerStage(CONFIGURATION, n_stations=2) for _ in SEEDS], told)
    return {
        seed: (path[-1], running(listed(own[-1])))
        for seed, path, own in zip(SEEDS, paths, updates, strict=True)
    }


@pytest.mark.slow
@pytest.mark.parametrize("seed", SEEDS)
def test_an_animal_at_two_stations_is_one_target_within_five_minutes(seed: int) -> None:
    place, tracks = followed()[seed]
    assert len(tracks) == 1
    assert sorted(tracks.contributor_sensor) == ["east", "west"]
    assert tracks.status.tolist() == [TrackStatus.CONFIRMED]
    assert np.hypot(*(tracks.state[0, :2] - place)) < 20.0
