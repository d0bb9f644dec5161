"""The launch files, with stand-ins for the launch packages: what would be started, and how."""

from pathlib import Path

import pytest

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.catalogue.launch_plan import CHAINS
from sonar_tracking.graph.catalogue.node_catalogue import NODES
from sonar_tracking.graph.catalogue.node_configuration import NodeConfiguration
from sonar_tracking.graph.verbs.run_options import RunOptions
from sonar_tracking.graph.verbs.run_scenario import plan_scenario
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario
from tests.system.launch_stand_ins import launched_nodes

PROJECT = Path(__file__).resolve().parents[2]
SCENARIOS = PROJECT / "config" / "scenarios"
USUAL_DEPTH = NodeConfiguration().flow_depth


def test_every_node_gets_the_parameters_of_the_scenario() -> None:
    assert {"track_fusion", "hydrophone_simulator"} <= set(launched_nodes("pipeline"))
    nodes = launched_nodes("pipeline", scenario="doa_fusion")
    assert list(nodes) == [
        "world_simulator",
        "array_simulator",
        "subspace_estimator",
        "bearing_tracker",
        "scene_publisher",
    ]
    first = {name: node.keywords["parameters"][0] for name, node in nodes.items()}
    assert first["array_simulator"]["scenario"] == "doa_fusion"
    assert first["subspace_estimator"]["n_subspaces"] == 7
    assert first["bearing_tracker"]["method"] == "ml_fusion"
    assert all({"use_sim_time": False} in node.keywords["parameters"] for node in nodes.values())


def test_parameter_file_comes_last(tmp_path: Path) -> None:
    mine = tmp_path / "mine.yaml"
    mine.write_text("bearing_tracker: {ros__parameters: {method: coherent}}\n")
    given = {"scenario": "doa_fusion", "parameters": str(mine), "use_sim_time": "true"}
    for node in launched_nodes("pipeline", **given).values():
        assert node.keywords["parameters"][1:] == [{"use_sim_time": True}, str(mine)]


@pytest.mark.parametrize("text", [None, "", "bearing_tracker: [1"])
def test_a_parameter_file_that_cannot_be_read_is_an_error_before_any_node_starts(
    tmp_path: Path, text: str | None
) -> None:
    mine = tmp_path / "mine.yaml"
    if text is not None:
        mine.write_text(text)
    with pytest.raises(ConfigurationError, match=r"mine\.yaml"):
        launched_nodes("pipeline", parameters=str(mine))


@pytest.mark.parametrize("scenario", sorted(path.stem for path in SCENARIOS.glob("*.yaml")))
def test_every_scenario_is_launched_with_programs_and_parameters_that_exist(
    scenario: str,
) -> None:
    nodes = launched_nodes("pipeline", scenario=scenario)
    assert set(nodes) <= set(NODES)
    assert any(NODES[name].serves_clock for name in nodes)
    for name, node in nodes.items():
        known = {entry.name for entry in NODES[name].parameters}
        given = node.keywords["parameters"][0]
        assert set(given) <= known
        for value in given.values():
            assert isinstance(value, (str, bool, int, float)) or (value and list(value))


def test_stations_of_a_scenario_reach_the_tracker_behind_them() -> None:
    given = launched_nodes("pipeline", scenario="cross_fix")["tma_tracker"].keywords["parameters"][
        0
    ]
    assert len(given["bearing_topics"]) == len(given["line_topics"]) == 2


def test_a_method_goes_before_scenario_and_file(tmp_path: Path) -> None:
    mine = tmp_path / "mine.yaml"
    mine.write_text("bearing_tracker: {ros__parameters: {method: coherent}}\n")
    given = {
        "scenario": "doa_fusion",
        "bearing_tracker_method": "ryu",
        "parameters": str(mine),
    }
    nodes = launched_nodes("pipeline", **given)
    assert nodes["bearing_tracker"].keywords["parameters"][-2:] == [str(mine), {"method": "ryu"}]
    assert nodes["subspace_estimator"].keywords["parameters"][-1] == str(mine)


@pytest.mark.parametrize("file", ["pipeline", "trackers"])
def test_topics_and_namespace_reach_every_node(file: str) -> None:
    remap = "active/contacts:=/sonar/contacts, active/tracks:=picture"
    given = {"scenario": "active"} if file == "pipeline" else {"chain": "contacts"}
    nodes = launched_nodes(file, namespace="ship_a", remap=remap, **given)
    assert "hpda_tracker" in nodes
    for node in nodes.values():
        assert node.keywords["namespace"] == "ship_a"
        assert node.keywords["remappings"] == [
            ("active/contacts", "/sonar/contacts"),
            ("active/tracks", "picture"),
        ]


@pytest.mark.parametrize("chain", CHAINS)
def test_a_chain_is_complete_behind_its_sensor_and_simulates_nothing(chain: str) -> None:
    nodes = [NODES[name] for name in launched_nodes("trackers", chain=chain)]
    assert not any(node.serves_clock for node in nodes)
    # Only the first node waits for what others publish.
    made = {topic.name for node in nodes for topic in node.outputs}
    sensed = {topic.name for topic in nodes[0].inputs}
    assert all(topic.name in made | sensed for node in nodes for topic in node.inputs)


def test_positions_are_added_to_a_chain_with_all_its_topics() -> None:
    nodes = launched_nodes("trackers", chain="samples", positions="true")
    assert nodes["tma_tracker"].keywords["parameters"][0] == {
        "bearing_topics": ("passive/bearing_tracks",),
        "line_topics": ("passive/frequency_lines",),
    }
    assert "tma_tracker" not in launched_nodes("trackers", chain="samples")


@pytest.mark.parametrize(
    ("file", "argument", "value", "sentence"),
    [
        ("trackers", "chain", "contact", "did you mean contacts?"),
        ("trackers", "positions", "true", "chain:=contacts finds none"),
        (
            "trackers",
            "hpda_tracker_method",
            "best",
            "hpda_tracker.method is 'best'; it must",
        ),
        ("trackers", "tma_tracker_method", "range_bank", "tma_tracker is not started; there are"),
        ("trackers", "remap", "active/contacts=/sonar", "write from:=to"),
        ("pipeline", "use_sim_time", "yes", "use_sim_time is yes; it must be true or false."),
        ("pipeline", "scenario", "doa_fusoin", "doa_fusoin"),
    ],
)
def test_a_wrong_argument_is_an_error_before_any_node_starts(
    file: str, argument: str, value: str, sentence: str
) -> None:
    with pytest.raises(ConfigurationError) as caught:
        launched_nodes(file, **{argument: value})
    assert sentence in str(caught.value)


def launched_depths(file: str, **given: str) -> dict[str, int]:
    """Return the depth of the queues of every launched node, where it is not the default."""
    depths = {}
    for name, node in launched_nodes(file, **given).items():
        for values in node.keywords["parameters"]:
            if isinstance(values, dict) and "flow_depth" in values:
                depths[name] = values["flow_depth"]
    return depths


@pytest.mark.parametrize("scenario", sorted(path.stem for path in SCENARIOS.glob("*.yaml")))
def test_launched_nodes_have_queues_as_deep_as_those_of_a_run(
    scenario: str, tmp_path: Path
) -> None:
    plan = plan_scenario(load_scenario(scenario), RunOptions(), tmp_path, scenario)
    needed = {node.name: node.parameters["flow_depth"] for node in plan.nodes}
    depths = launched_depths("pipeline", scenario=scenario)
    assert {name: depths.get(name, USUAL_DEPTH) for name in needed} == needed
    # Frequency lines come in bursts: at the default depth the oldest of them would be lost.
    assert (depths.get("line_tracker", 0) > USUAL_DEPTH) == ("line_tracker" in needed)


@pytest.mark.parametrize("key", ["line_tracker", "/**/line_tracker", "/ship_a/line_tracker", "/**"])
def test_queues_follow_the_parameter_file(tmp_path: Path, key: str) -> None:
    mine = tmp_path / "mine.yaml"
    mine.write_text(f"{key}: {{ros__parameters: {{frame_length: 1.0, use_sim_time: true}}}}\n")
    usual = launched_depths("trackers", chain="samples")
    halved = launched_depths("trackers", chain="samples", parameters=str(mine))
    assert halved["line_tracker"] > usual["line_tracker"] > USUAL_DEPTH
    mine.write_text(f"{key}: {{ros__parameters: {{flow_depth: 500}}}}\n")
    assert "line_tracker" not in launched_depths("trackers", chain="samples", parameters=str(mine))


def test_a_file_with_a_parameter_out_of_range_is_an_error_before_any_node_starts(
    tmp_path: Path,
) -> None:
    mine = tmp_path / "mine.yaml"
    mine.write_text("/**/hpda_tracker: {ros__parameters: {seed: -1}}\n")
    with pytest.raises(ConfigurationError, match=r"hpda_tracker\.seed is -1"):
        launched_nodes("trackers", parameters=str(mine))
