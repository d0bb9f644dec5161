"""Every parameter a user can set comes from a dataclass, and a wrong one is named."""

from __future__ import annotations

import array
from collections.abc import Mapping
from dataclasses import dataclass

import pytest

from sonar_tracking.configuration import describe, parameter
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.graph.catalogue.node_catalogue import NODES
from sonar_tracking.graph.catalogue.node_description import NodeDescription
from sonar_tracking.graph.node_base.parameters import check_overrides, descriptor, resolve


@dataclass(frozen=True)
class Example:
    """Parameters of every kind."""

    count: int = parameter(3, "how many", minimum=1, maximum=9)
    gain: float = parameter(0.5, "how much", unit="V", minimum=0.0)
    method: str = parameter("fast", "which", choices=("fast", "good"))
    angles_deg: tuple[float, ...] = parameter((1.0,), "where", unit="deg", minimum=-90, maximum=90)
    share: float = parameter(0.1, "of what", minimum=0.0, maximum=0.5)

    def __post_init__(self) -> None:
        if self.method == "good" and self.count > 5:
            raise ConfigurationError("method good needs a count of at most 5.")


def test_valid_overrides_are_taken_in_the_type_of_the_parameter() -> None:
    given = {"gain": 2, "angles_deg": array.array("q", [10, 20]), "use_sim_time": True}
    check_overrides([Example], given, "node")
    resolved = resolve(Example, given, "node")
    assert resolved == Example(gain=2.0, angles_deg=(10.0, 20.0))
    assert isinstance(resolved.gain, float)


def test_an_empty_list_arrives_without_a_type() -> None:
    assert resolve(Example, {"angles_deg": None}, "node").angles_deg == ()


@pytest.mark.parametrize(
    ("name", "value", "sentence"),
    [
        ("count", 10, "node.count is 10; it must be between 1 and 9."),
        ("count", 2.5, "node.count is 2.5; it must be a whole number."),
        ("gain", -1.0, "node.gain is -1.0; it must be at least 0 V."),
        ("gain", "high", "node.gain is 'high'; it must be a number."),
        ("gain", float("nan"), "give a finite number."),
        ("method", "best", "it must be one of fast, good."),
        ("angles_deg", [0.0, 95.0], "node.angles_deg is 95.0; it must be between -90 and 90 deg."),
        ("angles_deg", "north", "it must be a list of numbers."),
    ],
)
def test_a_wrong_value_is_refused_by_name(name: str, value: object, sentence: str) -> None:
    given = {"count": 4} | {name: value}
    for refuse in (lambda: resolve(Example, given, "node"), lambda: _check(given)):
        with pytest.raises(ConfigurationError) as caught:
            refuse()
        assert sentence in str(caught.value)


def test_a_combination_that_does_not_go_together_is_named() -> None:
    with pytest.raises(ConfigurationError, match="method good needs a count of at most 5"):
        resolve(Example, {"method": "good", "count": 6}, "node")


def test_unknown_names_get_a_suggestion_and_those_of_ros_are_left_alone() -> None:
    names = ["coutn", "use_sim_time", "qos_overrides./a.publisher.depth"]
    with pytest.raises(ConfigurationError) as caught:
        _check({"gain": 1.0} | dict.fromkeys(names, 1))
    assert str(caught.value) == "node.coutn is not known; did you mean count?"


def test_all_that_is_wrong_is_said_at_once() -> None:
    with pytest.raises(ConfigurationError) as caught:
        _check({"coutn": 1, "gain": -1.0, "count": 10})
    assert [line.split()[0] for line in str(caught.value).splitlines()] == [
        "node.count",
        "node.coutn",
        "node.gain",
    ]


def _check(given: Mapping[str, object]) -> None:
    check_overrides([Example], given, "node")


def test_descriptors_tell_range_and_unit() -> None:
    count, gain, method, angles, share = (descriptor(each) for each in describe(Example))
    assert all(each.read_only for each in (count, gain, method, angles, share))
    assert (count.integer_range[0].from_value, count.integer_range[0].to_value) == (1, 9)
    assert not gain.floating_point_range
    assert gain.additional_constraints == "at least 0 V"
    assert share.floating_point_range[0].from_value == 0.0
    assert share.floating_point_range[0].to_value == 0.5
    assert share.additional_constraints == ""
    assert gain.description == "how much [V]"
    assert "fast, good" in method.additional_constraints
    assert "-90 and 90" in angles.additional_constraints


@pytest.mark.parametrize("node", NODES.values(), ids=lambda node: node.name)
def test_the_parameters_of_every_node_are_complete(node: NodeDescription) -> None:
    descriptions = node.parameters
    names = [description.name for description in descriptions]
    assert len(set(names)) == len(names)
    assert node.is_display or {"flow_depth", "reset_after"} <= set(names)
    for description in descriptions:
        assert description.description
        described = descriptor(description)
        for each in (*described.floating_point_range, *described.integer_range):
            assert max(abs(each.from_value), abs(each.to_value)) <= 1e15
