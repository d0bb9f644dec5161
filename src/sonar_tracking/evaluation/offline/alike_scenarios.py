"""Scenarios in which ships, echoes and odometry are the same: they are simulated once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from sonar_tracking.simulation.scenarios.scenario import Scenario


def first_alike(scenarios: Sequence[Scenario]) -> list[int]:
    """Return the place of the first scenario that is like each of several scenarios.

    Alike are those that differ in how bearing sensors are turned alone: neither an active sonar
    nor odometry knows of that.
    """
    aligned = [_aligned(scenario) for scenario in scenarios]
    return [aligned.index(one) for one in aligned]


def _aligned(scenario: Scenario) -> Scenario:
    sensors = [replace(one, misalignment_deg=0.0) for one in scenario.bearing_sensors]
    return replace(scenario, bearing_sensors=tuple(sensors))
