"""Parameters of the nodes are complete, checked, and read from both forms of file."""

from pathlib import Path

import pytest

from sonar_tracking.configuration import describe
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.catalogue.node_catalogue import NODES
from sonar_tracking.graph.catalogue.node_settings import (
    read_settings,
    resolved_settings,
    with_room_for_bursts,
)
from sonar_tracking.graph.catalogue.passive_nodes import (
    BAND_DEMODULATOR,
    BEARING_TRACKER,
    LINE_TRACKER,
    SUBSPACE_ESTIMATOR,
)
from sonar_tracking.graph.catalogue.simulator_nodes import ARRAY_SIMULATOR


def test_every_parameter_has_a_value() -> None:
    nodes = tuple(NODES.values())
    given = {SUBSPACE_ESTIMATOR.name: {"period": 2}}
    settings = resolved_settings(given, nodes, "here")
    for node in nodes:
        names = {d.name for c in node.configurations for d in describe(c)}
        assert set(settings[node.name]) == names
    assert settings[SUBSPACE_ESTIMATOR.name]["period"] == 2.0
    # What was resolved can be given again, as a recording does.
    assert resolved_settings(settings, nodes, "there") == settings


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"bearing_trackr": {}}, "did you mean bearing_tracker"),
        ({"bearing_tracker": {"first_ib": 1}}, "did you mean first_id"),
        ({"bearing_tracker": {"flow_depth": 0}}, "flow_depth is 0; it must be between 1 and"),
        ({"bearing_tracker": {"start": "given"}}, "initial_bearings_deg is empty"),
    ],
)
def test_a_wrong_parameter_names_place_and_remedy(
    given: dict[str, dict[str, object]], sentence: str
) -> None:
    with pytest.raises(ConfigurationError, match="here: bearing_tr") as error:
        resolved_settings(given, (BEARING_TRACKER,), "here")
    assert sentence in str(error.value)


@pytest.mark.parametrize("method", ["coherent", "joint_map"])
def test_a_tracker_that_measures_in_the_covariance_needs_one(method: str) -> None:
    pair = (SUBSPACE_ESTIMATOR, BEARING_TRACKER)
    given: dict[str, dict[str, object]] = {"bearing_tracker": {"method": method}}
    resolved_settings(given, pair, "here")
    given["subspace_estimator"] = {"method": "past"}
    with pytest.raises(ConfigurationError, match=f"here: .*{method} needs .*but that is past"):
        resolved_settings(given, pair, "here")
    # Alone a tracker may take what it is sent.
    resolved_settings(given, (BEARING_TRACKER,), "here")
    given["subspace_estimator"] = {"covariance_snapshots": 0, "source_count": 2}
    with pytest.raises(ConfigurationError, match="covariance_snapshots above zero"):
        resolved_settings(given, pair, "here")


def test_both_forms_of_file_are_read(tmp_path: Path) -> None:
    file = tmp_path / "parameters.yaml"
    file.write_text("/one: {ros__parameters: {a: 1}}\ntwo: {b: 2.5}\n")
    assert read_settings(file) == {"one": {"a": 1}, "two": {"b": 2.5}}
    file.write_text("one: 3\n")
    with pytest.raises(ConfigurationError, match="one must be a mapping"):
        read_settings(file)


@pytest.mark.parametrize(("period", "depth"), [(1.0, 10), (0.1, 10), (0.03, 32), (0.001, 800)])
def test_queues_hold_all_estimates_the_blocks_in_the_graph_set_off(
    period: float, depth: int
) -> None:
    given = {SUBSPACE_ESTIMATOR.name: {"period": period}}
    nodes = (ARRAY_SIMULATOR, SUBSPACE_ESTIMATOR, BEARING_TRACKER)
    settings = with_room_for_bursts(resolved_settings(given, nodes, "here"), 0.1)
    # Four blocks of 0.1 s may be under way, twice over; ten messages are the default.
    assert settings[SUBSPACE_ESTIMATOR.name]["flow_depth"] == depth
    assert settings[BEARING_TRACKER.name]["flow_depth"] == depth
    assert settings["array_simulator"]["flow_depth"] == 10


def test_queues_hold_all_frames_that_wait_for_their_bearings() -> None:
    """Estimators up to four messages of 2 s behind, twice, and a covariance of 24 / 6 s = 4 s."""
    given = {
        SUBSPACE_ESTIMATOR.name: {"period": 2.0, "covariance_snapshots": 24},
        BAND_DEMODULATOR.name: {"bandwidth": 6.0},
    }
    nodes = (BAND_DEMODULATOR, SUBSPACE_ESTIMATOR, BEARING_TRACKER, LINE_TRACKER)
    settings = with_room_for_bursts(resolved_settings(given, nodes, "here"), 0.5)
    assert {values["flow_depth"] for values in settings.values()} == {2 * (4 + 8 * 2 + 8 // 2)}
