"""The launch file, with stand-ins for the launch packages, which are not needed otherwise."""

import runpy
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.catalogue.node_catalogue import NODES

PROJECT = Path(__file__).resolve().parents[2]
LAUNCH_FILE = PROJECT / "launch" / "pipeline.launch.py"
SCENARIOS = PROJECT / "config" / "scenarios"


class Recorded:
    """Stands in for any class of the launch packages: keeps what it was made with."""

    def __init__(self, *arguments: Any, **keywords: Any) -> None:
        self.arguments = arguments
        self.keywords = keywords


class Configuration(Recorded):
    """Stands in for a substitution: performed, it is the value given or the default."""

    def perform(self, context: dict[str, str]) -> str:
        return context[self.arguments[0]]


@pytest.fixture
def launched(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Run the launch file as ros2 launch would, and return the nodes for given arguments."""
    classes: dict[str, dict[str, type]] = {
        "launch": {"LaunchContext": Recorded, "LaunchDescription": Recorded},
        "launch.actions": {"DeclareLaunchArgument": Recorded, "OpaqueFunction": Recorded},
        "launch.substitutions": {"LaunchConfiguration": Configuration},
        "launch_ros": {},
        "launch_ros.actions": {"Node": Recorded},
    }
    for name, members in classes.items():
        module = ModuleType(name)
        vars(module).update(members)
        monkeypatch.setitem(sys.modules, name, module)

    def launch(**given: str) -> dict[str, Recorded]:
        description = runpy.run_path(str(LAUNCH_FILE))["generate_launch_description"]()
        *arguments, opaque = description.arguments[0]
        context = {entry.arguments[0]: entry.keywords["default_value"] for entry in arguments}
        assert set(given) <= set(context)
        nodes = opaque.keywords["function"](context | given)
        return {node.keywords["executable"]: node for node in nodes}

    return launch


def test_every_node_gets_the_parameters_of_the_scenario(launched: Any) -> None:
    nodes = launched()
    assert list(nodes) == ["array_simulator", "subspace_estimator", "bearing_tracker"]
    first = {name: node.keywords["parameters"][0] for name, node in nodes.items()}
    assert first["array_simulator"]["scenario"] == "doa_fusion"
    assert first["subspace_estimator"]["n_subspaces"] == 7
    assert first["bearing_tracker"]["method"] == "ml_fusion"
    assert all({"use_sim_time": False} in node.keywords["parameters"] for node in nodes.values())


def test_parameter_file_comes_last(launched: Any, tmp_path: Path) -> None:
    mine = tmp_path / "mine.yaml"
    mine.write_text("bearing_tracker: {ros__parameters: {method: coherent}}\n")
    for node in launched(parameters=str(mine), use_sim_time="true").values():
        assert node.keywords["parameters"][1:] == [{"use_sim_time": True}, str(mine)]


@pytest.mark.parametrize("text", [None, "", "bearing_tracker: [1"])
def test_a_parameter_file_that_cannot_be_read_is_an_error_before_any_node_starts(
    launched: Any, tmp_path: Path, text: str | None
) -> None:
    mine = tmp_path / "mine.yaml"
    if text is not None:
        mine.write_text(text)
    with pytest.raises(ConfigurationError, match=r"mine\.yaml"):
        launched(parameters=str(mine))


@pytest.mark.parametrize("scenario", sorted(path.stem for path in SCENARIOS.glob("*.yaml")))
def test_every_scenario_is_launched_with_programs_and_parameters_that_exist(
    launched: Any, scenario: str
) -> None:
    nodes = launched(scenario=scenario)
    assert set(nodes) <= set(NODES)
    assert any(NODES[name].serves_clock for name in nodes)
    for name, node in nodes.items():
        known = {entry.name for entry in NODES[name].parameters}
        given = node.keywords["parameters"][0]
        assert set(given) <= known
        for value in given.values():
            assert isinstance(value, (str, bool, int, float)) or (value and list(value))


def test_stations_of_a_scenario_reach_the_tracker_behind_them(launched: Any) -> None:
    given = launched(scenario="cross_fix")["tma_tracker"].keywords["parameters"][0]
    assert len(given["bearing_topics"]) == len(given["line_topics"]) == 2
