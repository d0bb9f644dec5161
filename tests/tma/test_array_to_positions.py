"""Protects the whole passive chain: snapshots of a line array become positions of two ships."""

import numpy as np
import pytest

from sonar_tracking.evaluation.offline.offline_bearing_chain import run_offline_chain
from sonar_tracking.motion import Trajectory
from sonar_tracking.simulation.scenarios.array_configuration import ArrayConfiguration
from sonar_tracking.simulation.scenarios.kinematic_motion import KinematicMotion
from sonar_tracking.simulation.scenarios.platforms import OwnShipConfiguration, TurnConfiguration
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.scenarios.target import TargetConfiguration
from sonar_tracking.tma.targets.passive_frame import PassiveFrame
from sonar_tracking.tma.tracker.tma_tracker_stage import TmaTrackerStage
from tests.tma.passive_scene import listed, running

SCENARIO = Scenario(
    name="two_ships",
    duration=150.0,
    seed=4,
    array=ArrayConfiguration(
        n_elements=24,
        spacing=0.0625,
        center_frequency=12_000.0,
        bandwidth=100.0,
        snapshot_rate=100.0,
        block_snapshots=10,
    ),
    own_ship=OwnShipConfiguration(speed=6.0, turns=(TurnConfiguration(60.0, 290.0, 2.0),)),
    targets=(
        TargetConfiguration(
            level_db=3.0,
            motion=KinematicMotion(position=(1500.0, 1200.0), course_deg=250.0, speed=4.0),
        ),
        TargetConfiguration(
            level_db=3.0,
            motion=KinematicMotion(position=(2500.0, -800.0), course_deg=0.0, speed=6.0),
        ),
    ),
    nodes={"subspace_estimator": {"period": 1.0}},
)


def own_path(target: TargetConfiguration) -> Trajectory:
    motion = target.motion
    assert isinstance(motion, KinematicMotion) and isinstance(motion.trajectory, Trajectory)
    return motion.trajectory


@pytest.mark.slow
def test_two_ships_are_located_after_one_turn() -> None:
    stage = TmaTrackerStage()
    for bearings in run_offline_chain(SCENARIO).tracks:
        tracks = running(listed(stage.update(PassiveFrame(bearings.stamp, (bearings,)))))
    seconds = (tracks.stamp - SCENARIO.epoch) * 1e-9
    assert len(tracks) == 2
    for target in SCENARIO.targets:
        truth = own_path(target).state(seconds)
        errors = tracks.state - np.concatenate([truth.position, truth.velocity])
        nearest = int(np.argmin(np.hypot(errors[:, 0], errors[:, 1])))
        assert np.hypot(*errors[nearest, :2]) < 150.0
        squared = errors[nearest] @ np.linalg.solve(tracks.covariance[nearest], errors[nearest])
        assert squared < 25.0
