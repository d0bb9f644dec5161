"""Scenario files: what they say is kept exactly, what cannot be used is refused in a sentence."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from sonar_tracking.errors import ConfigurationError
from sonar_tracking.simulation.scenarios.scenario import DEFAULT_EPOCH
from sonar_tracking.simulation.scenarios.scenario_file import scenario_names
from sonar_tracking.simulation.scenarios.scenario_mapping import (
    load_scenario,
    scenario_from_mapping,
    scenario_to_mapping,
    scenario_to_yaml,
)

LINEAR = {"kind": "linear"}


def minimal(**values: Any) -> dict[str, Any]:
    return {"array": {"n_elements": 4}, **values}


def target(**values: Any) -> dict[str, Any]:
    return minimal(targets=[{"motion": LINEAR, **values}])


@pytest.mark.parametrize("name", scenario_names())
def test_resolved_scenario_reads_back_exactly(name: str, tmp_path: Path) -> None:
    scenario = load_scenario(name)
    assert scenario.name == name
    assert scenario.description
    assert scenario_from_mapping(scenario_to_mapping(scenario), "recording") == scenario
    path = tmp_path / "copy.yaml"
    path.write_text(scenario_to_yaml(scenario), encoding="utf-8")
    assert load_scenario(path) == scenario


def test_awkward_numbers_survive_the_text() -> None:
    scenario = scenario_from_mapping(
        target(level_db=0.1 + 0.2, present=[1e-7, 1e5 / 3]) | {"start": -1e-5, "seed": 2**63}, "x"
    )
    assert scenario_from_mapping(yaml.safe_load(scenario_to_yaml(scenario)), "y") == scenario


@pytest.mark.parametrize(
    "epoch", ["2026-01-01T00:00:00Z", "2026-01-01 01:00:00+01:00", 1767225600, 1767225600.0]
)
def test_epoch_as_text_or_seconds(epoch: object) -> None:
    assert scenario_from_mapping(minimal(epoch=epoch), "x").epoch == DEFAULT_EPOCH
    text = yaml.safe_dump(minimal()) + f"epoch: {epoch}\n"
    assert scenario_from_mapping(yaml.safe_load(text), "x").epoch == DEFAULT_EPOCH


def test_stamps_follow_from_the_epoch() -> None:
    scenario = scenario_from_mapping(minimal(), "x")
    assert scenario.stamp(-0.005) == DEFAULT_EPOCH - 5_000_000


def test_spacing_in_metres_wavelengths_or_by_coordinates() -> None:
    common = {"center_frequency": 750.0, "sound_speed": 1500.0, "bandwidth": 1.0}
    arrays: list[dict[str, Any]] = [
        {"n_elements": 3, "spacing": 1.0},
        {"n_elements": 3, "spacing_wavelengths": 0.5},
        {"n_elements": 3},
        {"element_x": [0.0, 1.0, 2.0]},
    ]
    for array in arrays:
        scenario = scenario_from_mapping({"array": {**common, **array}}, "x")
        np.testing.assert_allclose(scenario.array.element_positions()[:, 0], [0.0, 1.0, 2.0])


MOTION_AWAY = {"kind": "linear", "offset_deg": 80.0, "rate_deg": 1.0}
SHIP = {"kind": "kinematic", "position": [0.0, 500.0]}

ERRORS: list[tuple[dict[str, Any], str]] = [
    (minimal(duraton=3.0), r"world: scenario\.duraton is not known; did you mean duration\?"),
    (minimal(arrray={}), r"world: scenario\.arrray is not known; did you mean array\?"),
    (minimal(duration=-1.0), r"scenario\.duration is -1\.0; it must be between"),
    (minimal(duration="long"), r"scenario\.duration is 'long'; it must be a number"),
    (minimal(seed=1.5), r"scenario\.seed is 1\.5; it must be a whole number"),
    (minimal(epoch="yesterday"), r"epoch is 'yesterday'; give e\.g\. 2026-01-01"),
    (minimal(epoch=-5), r"epoch is -5"),
    (minimal(epoch=10, start=-20.0), r"epoch \+ start must lie after 1970"),
    ({"array": [1]}, r"world: array is \[1\]; it must be a mapping"),
    ({}, r"world: array has 0 elements; give n_elements"),
    ({"array": {"n_element": 4}}, r"array\.n_element is not known; did you mean n_elements"),
    ({"array": {"n_elements": 1}}, r"array has 1 elements"),
    ({"array": {"n_elements": 4, "element_x": [0.0, 1.0]}}, r"n_elements is 4 but element_x has 2"),
    ({"array": {"element_x": [0.0, 0.1], "element_y": [0.0]}}, r"element_y has 1 entries"),
    ({"array": {"n_elements": 500}}, r"narrowband model needs less than 0\.1"),
    (minimal(noise={"correlation": 1.0}), r"noise\.correlation is 1\.0; it must be between"),
    (minimal(own_ship={"position": [1.0]}), r"own_ship\.position has 1 entries; give x and y"),
    (minimal(own_ship={"turns": {}}), r"own_ship\.turns is \{\}; it must be a list"),
    (
        minimal(own_ship={"turns": [{"time": 5.0}, {"time": 4.0}]}),
        r"own_ship\.turns: the times must ascend",
    ),
    (
        minimal(own_ship={"turns": [{"rate_deg": 0.0}]}),
        r"own_ship\.turns\[0\]\.rate_deg is 0\.0; it must be between",
    ),
    (minimal(targets=[{}]), r"targets\[0\]\.motion is missing; give a motion with kind"),
    (minimal(targets=["ship"]), r"targets\[0\] is 'ship'; it must be a mapping"),
    (target(motion={"kind": "circular"}), r"motion\.kind is 'circular'; it must be one of"),
    (
        target(motion={"kind": "linear", "rate": 1}),
        r"motion\.rate is not known; did you mean rate",
    ),
    (target(motion=MOTION_AWAY), r"takes the bearing to 90\.02 deg at t = 10\.02 s"),
    (target(motion={"kind": "table"}), r"motion has 0 times and 0 bearings_deg"),
    (
        target(motion={"kind": "table", "times": [1, 0], "bearings_deg": [0, 0]}),
        r"motion\.times: the times must ascend",
    ),
    (target(motion={**SHIP, "position": [1, 2, 3]}), r"motion\.position has 3 entries"),
    (target(motion={**SHIP, "speed": 101.0}), r"motion\.speed is 101\.0; it must be between"),
    (target(level_db=1000), r"targets\[0\]\.level_db is 1000\.0; it must be between"),
    (target(present=[1.0]), r"targets\[0\]\.present has 1 entries; give pairs"),
    (target(present=[5.0, 1.0]), r"targets\[0\]\.present: the times must ascend"),
    (target(coherent_phase="turn"), r"coherent_phase is 'turn'; it must be one of fixed"),
    (target(level=3), r"targets\[0\]\.level is not known; did you mean level_db\?"),
    (
        minimal(targets=[{"name": "a", "motion": LINEAR}] * 2),
        r"targets\[1\]\.name a is used twice",
    ),
    (
        minimal(bearing_sensors=[{"namespace": "buoy"}]),
        r"bearing_sensors\[0\]\.sensor_id is 'array' like that of array; give every sensor its own",
    ),
    (
        target(name="ghost", heard=False, echoes=False),
        r"targets\[0\]: heard and echoes are both false, so that nothing receives ghost",
    ),
    (minimal(nodes={"recorder": 3}), r"nodes\.recorder is 3; it must be a mapping"),
    (minimal(nodes={"recorder": {"a": None}}), r"nodes\.recorder\.a is None; it must be a number"),
]


@pytest.mark.parametrize(("mapping", "sentence"), ERRORS)
def test_refused_in_a_sentence(mapping: dict[str, Any], sentence: str) -> None:
    with pytest.raises(ConfigurationError, match=sentence) as raised:
        scenario_from_mapping(mapping, "world")
    assert str(raised.value).endswith((".", "?"))


FILES = [
    ("a: [1, 2\nb: 3\n", r"bad\.yaml, line 2: this is not valid YAML"),
    ("duration: 3\nduration: 4\n", r"bad\.yaml, line 2: .*duration is given twice"),
    ("a:\n\t- 1\n", r"bad\.yaml, line 2: this is not valid YAML"),
    ("just words\n", r"bad\.yaml: this must be a mapping"),
    ("", r"bad\.yaml: this must be a mapping"),
    ("a: 1\nb: \x01\n", r"bad\.yaml, line 2: this is not valid YAML"),
    ("epoch: 2026-13-41\n", r"bad\.yaml: this is not valid YAML: month must be in 1\.\.12"),
    ("a: " + "[" * 5000 + "\n", r"bad\.yaml: this is not valid YAML: nested too deeply"),
]


@pytest.mark.parametrize(("text", "sentence"), FILES)
def test_malformed_file_is_named_with_its_line(text: str, sentence: str, tmp_path: Path) -> None:
    path = tmp_path / "bad.yaml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ConfigurationError, match=sentence) as raised:
        load_scenario(path)
    assert "\n" not in str(raised.value)


def test_binary_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "binary.yaml"
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ConfigurationError, match=r"cannot be read: it is no UTF-8 text"):
        load_scenario(path)


def test_unknown_scenario_suggests_the_nearest() -> None:
    with pytest.raises(ConfigurationError, match=r"doa_fussion is not known; did you mean doa_f"):
        load_scenario("doa_fussion")
    with pytest.raises(ConfigurationError, match=r"nowhere\.yaml does not exist; give the path"):
        load_scenario("nowhere.yaml")


def test_node_parameters_pass_through() -> None:
    scenario = scenario_from_mapping(minimal(nodes={"listener": {"a": 3, "b": [1, 2.5]}}), "x")
    assert scenario.nodes == {"listener": {"a": 3, "b": (1, 2.5)}}


def test_a_scenario_without_an_array_stays_without_one() -> None:
    """What is recorded of a scenario must not bring in a sensor that was not there."""
    ship = {"motion": {"kind": "kinematic", "position": [500.0, 0.0]}}
    scenario = scenario_from_mapping({"active_sonar": {}, "targets": [ship]}, "x")
    assert scenario.sensors == ("active_sonar",)
    assert scenario.step == scenario.active_sonar.ping_interval  # type: ignore[union-attr]
    mapping = scenario_to_mapping(scenario)
    assert "array" not in mapping
    assert scenario_from_mapping(mapping, "x") == scenario


def test_bearings_alone_are_nothing_to_an_active_sonar() -> None:
    with pytest.raises(ConfigurationError, match=r"targets\[0\]\.motion gives bearings only"):
        scenario_from_mapping(
            {"active_sonar": {}, "targets": [{"motion": {"kind": "arctangent"}}]}, "x"
        )
