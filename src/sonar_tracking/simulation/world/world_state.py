"""What is known of a scenario's world at one instant: own ship, and where the targets are."""

from __future__ import annotations

import numpy as np

from sonar_tracking.motion import wrap_angle
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.positions import TruthTracks
from sonar_tracking.records.time import UNKNOWN_STAMP
from sonar_tracking.simulation.scenarios.kinematic_motion import KinematicMotion
from sonar_tracking.simulation.scenarios.platforms import OwnShipConfiguration
from sonar_tracking.simulation.scenarios.scenario import Scenario


def own_ship_at(scenario: Scenario, time: float) -> OwnShipState:
    """Return the state of own ship at a scenario time, s."""
    return _ship_at(scenario.own_ship, time, scenario.stamp(time))


def consort_at(scenario: Scenario, time: float) -> OwnShipState | None:
    """Return the state of the second ship at a scenario time, s; None = there is none."""
    if scenario.consort is None:
        return None
    return _ship_at(scenario.consort, time, scenario.stamp(time))


def _ship_at(ship: OwnShipConfiguration, time: float, stamp: int) -> OwnShipState:
    state = ship.trajectory().state(time)
    return OwnShipState(
        stamp=stamp,
        position=(float(state.position[0]), float(state.position[1])),
        yaw=float(wrap_angle(state.azimuth)),
        velocity=(ship.speed, 0.0),
        yaw_rate=float(state.turn_rate),
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
