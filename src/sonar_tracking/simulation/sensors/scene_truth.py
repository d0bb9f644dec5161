"""What an array hears in truth at one instant: where it is, and the angles of the targets."""

from __future__ import annotations

import numpy as np

from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.bearings import BearingTracks, Sensor, TrackStatus
from sonar_tracking.records.time import UNKNOWN_STAMP
from sonar_tracking.simulation.scenarios.scenario import Scenario


def array_sensor_at(scenario: Scenario, time: float) -> Sensor:
    """Return the array with its pose, as its data tell it, and velocity at a scenario time, s."""
    receiver = scenario.receiver()
    state = receiver.trajectory.state(time)
    told = state.azimuth + receiver.mounting_yaw - scenario.array.misalignment
    half_yaw = 0.5 * float(wrap_angle(told))
    return Sensor(
        sensor_id=scenario.array.sensor_id,
        frame_id=f"{scenario.carrier}/array",
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
    rows = [index for index, target in enumerate(targets) if target.is_heard(time)]
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
