"""A node imports what it runs and nothing else, so that a graph starts at once.

Every case is a process of its own, in which nothing else has imported anything.
"""

from __future__ import annotations

import subprocess
import sys

import pytest

from sonar_tracking.graph.catalogue.node_catalogue import NODES

PEOPLE = {"matplotlib", "rich", "typer", "pydantic", "dask", "rosbags"}
"""Packages that show things to people or read foreign files."""

NO_NODE = {"sonar_tracking.evaluation", "sonar_tracking.display", "sonar_tracking.cli"}

NODE_MODULES = {node.name: node.module for node in NODES.values()}
NODE_MODULES["recorder"] = "sonar_tracking.graph.nodes.recorder"

STAGES = {
    "world_simulator": "sonar_tracking.simulation.world",
    "array_simulator": "sonar_tracking.simulation",
    "hydrophone_simulator": "sonar_tracking.simulation",
    "bearing_simulator": "sonar_tracking.simulation",
    "contact_simulator": "sonar_tracking.simulation",
    "band_demodulator": "sonar_tracking.passive.lines.band_demodulator_stage",
    "subspace_estimator": "sonar_tracking.passive.subspaces.subspace_stage",
    "bearing_tracker": "sonar_tracking.passive.bearings.bearing_tracker_stage",
    "line_tracker": "sonar_tracking.passive.lines.line_tracker_stage",
    "tma_tracker": "sonar_tracking.tma.targets.tma_tracker_stage",
    "hpda_tracker": "sonar_tracking.active.contact_tracker",
    "track_fusion": "sonar_tracking.fusion.track_fusion_stage",
    "own_ship_nmea": "sonar_tracking.bags.nmea.live_own_ship",
    "ais_truth": "sonar_tracking.bags.nmea.live_ships",
    "nmea_output": "sonar_tracking.scene.nmea_sentences",
    "scene_publisher": "sonar_tracking.scene.scene_frames",
    "operator_display": "sonar_tracking.display.page.page_feed",
    "recorder": "sonar_tracking.bags.storage.writer",
}
"""What each node runs."""

WARM = {
    "sonar_tracking.passive.lines.line_tracker_stage:LineTrackerStage()": "_lsap",
    "sonar_tracking.active.contact_tracker:"
    "make_contact_tracker(ContactTrackerConfiguration(method='hpda_kalman'))": "scipy.special",
    "sonar_tracking.active.contact_tracker:"
    "make_contact_tracker(ContactTrackerConfiguration(method='smc_phd'))": "_lsap",
}
"""What is loaded later than the stage that needs it."""


def imported(code: str) -> set[str]:
    """Return the modules that are loaded once a fresh process has run some code."""
    code += "\nimport sys; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return set(done.stdout.split())


def within(modules: set[str], packages: set[str]) -> set[str]:
    """Return the modules that are one of the packages, or below it."""
    return {name for name in modules if any(f"{name}.".startswith(f"{p}.") for p in packages)}


@pytest.mark.parametrize("node", NODE_MODULES)
def test_a_node_imports_what_it_runs(node: str) -> None:
    modules = imported(f"import {NODE_MODULES[node]}")
    assert STAGES[node] in modules
    needless = {"scipy", *PEOPLE, *NO_NODE}
    if node == "operator_display":
        needless.discard("sonar_tracking.display")
    assert not within(modules, needless)
    assert not within(modules, set(NODE_MODULES.values()) - {NODE_MODULES[node]})
    others = {stage for name, stage in STAGES.items() if name != node} - {STAGES[node]}
    if not node.endswith("_simulator"):
        assert not within(modules, others)


@pytest.mark.parametrize("stage", WARM, ids=lambda stage: stage.partition(":")[2])
def test_what_a_stage_loads_later_is_loaded_by_its_warm_up(stage: str) -> None:
    module, _, made = stage.partition(":")
    make = f"import sys, {module}; stage = eval({made!r}, vars({module}))"
    assert WARM[stage] in imported(
        f"{make}; assert {WARM[stage]!r} not in sys.modules; stage.warm_up()"
    )


def test_a_run_starts_its_nodes_before_it_loads_what_nodes_run() -> None:
    modules = imported("import sonar_tracking.graph.verbs.run_scenario")
    stages = {name for node, name in STAGES.items() if not node.endswith("_simulator")}
    assert not within(modules, {"scipy", "rclpy", "matplotlib", "rosbags", *stages})
    scores = {
        "sonar_tracking.evaluation.metrics.bearing_score",
        "sonar_tracking.evaluation.studies",
    }
    assert not within(modules, {"sonar_tracking.simulation.sensors", *scores})
