"""World to sensors: scenarios, target motion, and what an array, hydrophones or a sonar receive."""

from typing import TYPE_CHECKING

from sonar_tracking.lazy_imports import lazy_exports

__all__ = [
    "ActiveSonarSimulation",
    "ArraySimulation",
    "BearingSimulation",
    "SampleSimulation",
    "Scenario",
    "WorldSimulation",
    "circular_gaussian",
    "load_scenario",
    "scenario_from_mapping",
    "scenario_names",
    "scenario_to_yaml",
    "synthesize_snapshots",
    "true_bearings",
    "true_tracks",
]

if TYPE_CHECKING:
    from sonar_tracking.simulation.scenarios.scenario import Scenario
    from sonar_tracking.simulation.scenarios.scenario_file import scenario_names
    from sonar_tracking.simulation.scenarios.scenario_mapping import (
        load_scenario,
        scenario_from_mapping,
        scenario_to_yaml,
    )
    from sonar_tracking.simulation.sensors.active_sonar_simulation import ActiveSonarSimulation
    from sonar_tracking.simulation.sensors.array_simulation import ArraySimulation
    from sonar_tracking.simulation.sensors.bearing_simulation import BearingSimulation
    from sonar_tracking.simulation.sensors.sample_simulation import SampleSimulation
    from sonar_tracking.simulation.sensors.scene_truth import true_bearings
    from sonar_tracking.simulation.signals.snapshot_synthesis import (
        circular_gaussian,
        synthesize_snapshots,
    )
    from sonar_tracking.simulation.world.world_simulation import WorldSimulation
    from sonar_tracking.simulation.world.world_state import true_tracks
else:
    __getattr__, __dir__ = lazy_exports(
        __name__,
        {
            "scenarios.scenario": ["Scenario"],
            "scenarios.scenario_file": ["scenario_names"],
            "scenarios.scenario_mapping": [
                "load_scenario",
                "scenario_from_mapping",
                "scenario_to_yaml",
            ],
            "sensors.active_sonar_simulation": ["ActiveSonarSimulation"],
            "sensors.array_simulation": ["ArraySimulation"],
            "sensors.bearing_simulation": ["BearingSimulation"],
            "sensors.sample_simulation": ["SampleSimulation"],
            "sensors.scene_truth": ["true_bearings"],
            "signals.snapshot_synthesis": ["circular_gaussian", "synthesize_snapshots"],
            "world.world_simulation": ["WorldSimulation"],
            "world.world_state": ["true_tracks"],
        },
    )
