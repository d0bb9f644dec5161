"""What is known of a simulated scene at one instant: own ship, sensor, targets.

Every simulator of a sensor reports the same truth in the same way.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import BearingTracks, Sensor, TrackStatus
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.positions import TruthTracks
from sonar_tracking.records.time import UNKNOWN_STAMP
from sonar_tracking.simulation.scenarios.kinematic_motion import KinematicMotion
from sonar_tracking.simulation.scenarios.scenario import Scenario


def own_ship_at(scenario: Scenario, time: float) -> OwnShipState:
    """Return the state of own ship at a scenario time, s."""
    state = scenario.own_ship.trajectory().state(time)
    return OwnShipState(
        stamp=scenario.stamp(time),
        position=(float(state.position[0]), float(state.position[1])),
        yaw=float(wrap_angle(state.azimuth)),
        velocity=(scenario.own_ship.speed, 0.0),
        yaw_rate=float(state.turn_rate),
    )


def array_sensor_at(scenario: Scenario, time: float) -> Sensor:
    """Return the array with its pose and velocity at a scenario time, s."""
    receiver = scenario.receiver()
    state = receiver.trajectory.state(time)
    half_yaw = 0.5 * float(wrap_angle(state.azimuth + receiver.mounting_yaw))
    return Sensor(
        sensor_id=scenario.array.sensor_id,
        position=(float(state.position[0]), float(state.position[1]), 0.0),
        orientation=(0.0, 0.0, float(np.sin(half_yaw)), float(np.cos(half_yaw))),
        velocity=(float(state.velocity[0]), float(state.velocity[1]), 0.0),
    )


def true_bearings(
    scenario: Scenario,
    time: float,
    arrivals: tuple[FloatArray, FloatArray],
    next_stamp: int = UNKNOWN_STAMP,
) -> BearingTracks:
    """Return the arrival angles of the targets heard at a scenario time.

    Parameters
    ----------
    scenario : Scenario
        The world.
    time : float
        s.
    arrivals : tuple of two ndarray, shape (n_targets,)
        Arrival angle and its rate of every target then, rad and rad/s.
    next_stamp : int
        Watermark, ns.
    """
    targets = scenario.targets
    rows = [index for index, target in enumerate(targets) if target.is_present(time)]
    levels = np.array([10.0 ** (targets[index].level_db / 10.0) for index in rows])
    unknown = np.full(len(rows), np.nan)
    return BearingTracks(
        stamp=scenario.stamp(time),
        id=np.array(rows, dtype=np.uint64) + np.uint64(1),
        status=np.full(len(rows), TrackStatus.CONFIRMED, dtype=np.uint8),
        arrival_angle=arrivals[0][rows],
        arrival_angle_rate=arrivals[1][rows],
        covariance=np.zeros((len(rows), 2, 2)),
        measurement=unknown,
        measurement_variance=unknown,
        innovation=unknown,
        signal_to_noise_ratio=levels,
        existence_probability=np.ones(len(rows)),
        ambiguous=np.full(len(rows), scenario.receiver().ambiguous),
        next_stamp=next_stamp,
        sensor=array_sensor_at(scenario, time),
    )


def true_tracks(scenario: Scenario, time: float, next_stamp: int = UNKNOWN_STAMP) -> TruthTracks:
    """Return the states of the present targets that move in ``map``, at a scenario time, s."""
    rows, states = [], []
    for index, target in enumerate(scenario.targets):
        if isinstance(target.motion, KinematicMotion) and target.is_present(time):
            rows.append(index + 1)
            states.append(target.motion.trajectory.state(time))
    return TruthTracks(
        stamp=scenario.stamp(time),
        id=np.array(rows, dtype=np.uint64),
        position=np.array([state.position for state in states]).reshape(-1, 2),
        velocity=np.array([state.velocity for state in states]).reshape(-1, 2),
        next_stamp=next_stamp,
    )
