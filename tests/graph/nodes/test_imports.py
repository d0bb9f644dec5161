"""A node imports what it runs and nothing else, so that a graph starts at once.

Every case is a process of its own: a copy of one that has imported what all need and no module of
this package, since loading that takes longer than the case itself.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Sequence

import pytest

from sonar_tracking.graph.catalogue.node_catalogue import NODES
from sonar_tracking.graph.orchestration.forked_node import SHARED

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
    "tma_tracker": "sonar_tracking.tma.tracker.tma_tracker_stage",
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


COPIES = """
import importlib, json, os, sys
loaded = {{}}
for common, codes in {groups}:
    for each in common:
        importlib.import_module(each)
    loaded[",".join(common)] = list(sys.modules)
    for code in codes:
        end, begin = os.pipe()
        if not os.fork():
            with os.fdopen(begin, "w") as answer:
                exec(code, {{}})
                json.dump(list(sys.modules), answer)
            os._exit(0)
        os.close(begin)
        with os.fdopen(end) as answer:
            loaded[code] = json.loads(answer.read() or "null")
        os.wait()
print(json.dumps(loaded))
"""
COMMON = tuple(each for each in SHARED if not each.startswith("sonar_tracking."))
"""What all nodes need: messages, with numpy."""
NODE_COMMON = ("rclpy.node", "rclpy.executors", "rclpy.serialization")
"""What they need besides, and a run loads after they have begun."""
RUN = "import sonar_tracking.graph.verbs.run_scenario"


def import_of(node: str) -> str:
    """Return the code that imports a node."""
    return f"import {NODE_MODULES[node]}"


def warm_up_of(stage: str) -> str:
    """Return the code that warms a stage up, which has not loaded before what it needs then."""
    module, _, made = stage.partition(":")
    make = f"import sys, {module}; stage = eval({made!r}, vars({module}))"
    return f"{make}; assert {WARM[stage]!r} not in sys.modules; stage.warm_up()"


def loaded_after(*groups: tuple[Sequence[str], Sequence[str]]) -> dict[str, set[str]]:
    """Return the modules that are loaded once a fresh process has run each code.

    Parameters
    ----------
    groups : tuples of sequences of str
        What the process imports first, one group after the other, and codes that copies run then.
        What is loaded then is told, too, under the names of the imports with commas between.
    """
    done = subprocess.run(
        [sys.executable, "-c", COPIES.format(groups=list(groups))],
        capture_output=True,
        text=True,
        check=True,
    )
    return {code: set(modules or ()) for code, modules in json.loads(done.stdout).items()}


@pytest.fixture(scope="module")
def imported() -> dict[str, set[str]]:
    """Modules that are loaded once a fresh process has run each code."""
    codes = [*map(import_of, NODE_MODULES), *map(warm_up_of, WARM)]
    loaded = loaded_after((COMMON, [RUN]), (NODE_COMMON, codes))
    assert not within(loaded[",".join(COMMON)], {"sonar_tracking", "rclpy", "scipy", *PEOPLE})
    assert not within(loaded[",".join(NODE_COMMON)], {"sonar_tracking", "scipy", *PEOPLE})
    return loaded


def within(modules: set[str], packages: set[str]) -> set[str]:
    """Return the modules that are one of the packages, or below it."""
    return {name for name in modules if any(f"{name}.".startswith(f"{p}.") for p in packages)}


@pytest.mark.parametrize("node", NODE_MODULES)
def test_a_node_imports_what_it_runs(imported: dict[str, set[str]], node: str) -> None:
    modules = imported[import_of(node)]
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
def test_what_a_stage_loads_later_is_loaded_by_its_warm_up(
    imported: dict[str, set[str]], stage: str
) -> None:
    assert WARM[stage] in imported[warm_up_of(stage)]


def test_a_run_starts_its_nodes_before_it_loads_what_nodes_run(
    imported: dict[str, set[str]],
) -> None:
    modules = imported[RUN]
    assert "sonar_tracking.graph.verbs.run_scenario" in modules
    stages = {name for node, name in STAGES.items() if not node.endswith("_simulator")}
    assert not within(modules, {"scipy", "rclpy", "matplotlib", "rosbags", *stages})
    scores = {
        "sonar_tracking.evaluation.metrics.bearing_score",
        "sonar_tracking.evaluation.studies",
    }
    assert not within(modules, {"sonar_tracking.simulation.sensors", *scores})
