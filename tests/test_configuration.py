"""Configurations are what users type: every wrong entry must be named, none silently changed."""

from __future__ import annotations

from dataclasses import FrozenInstanceError, dataclass, field
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sonar_tracking.configuration import (
    SECTION,
    checked_value,
    describe,
    from_mapping,
    parameter,
    range_text,
)
from sonar_tracking.errors import ConfigurationError, unknown_name_text


@dataclass(frozen=True)
class Part:
    """A nested configuration."""

    size: int = parameter(1, "how large", minimum=0)


@dataclass(frozen=True)
class Example:
    """Parameters of every kind."""

    flag: bool = parameter(False, "whether")
    count: int = parameter(3, "how many", minimum=1, maximum=9)
    gain: float = parameter(0.5, "how much", unit="V", minimum=0.0)
    loss: float = parameter(0.0, "how little", maximum=1.0)
    method: str = parameter("fast", "which", choices=("fast", "good"))
    angles_deg: tuple[float, ...] = parameter((), "where", unit="deg", minimum=-90, maximum=90)
    topics: tuple[str, ...] = parameter(("a",), "which")
    part: Part = field(default=Part(), metadata=SECTION)


DESCRIPTIONS = {description.name: description for description in describe(Example)}


def test_descriptions_hold_what_was_declared() -> None:
    assert list(DESCRIPTIONS) == ["flag", "count", "gain", "loss", "method", "angles_deg", "topics"]
    kinds = [description.kind for description in DESCRIPTIONS.values()]
    assert kinds == [bool, int, float, float, str, tuple, tuple]
    gain = DESCRIPTIONS["gain"]
    assert (gain.default, gain.unit, gain.minimum, gain.maximum) == (0.5, "V", 0.0, None)
    assert DESCRIPTIONS["method"].choices == ("fast", "good")


@pytest.mark.parametrize(
    ("name", "value", "expected"),
    [
        ("flag", True, True),
        ("count", 9, 9),
        ("gain", 2, 2.0),
        ("method", "good", "good"),
        ("angles_deg", [1, -90.0], (1.0, -90.0)),
        ("angles_deg", [], ()),
        ("topics", ["b", "c"], ("b", "c")),
    ],
)
def test_good_values_get_the_type_of_the_parameter(name: str, value: Any, expected: Any) -> None:
    found = checked_value(DESCRIPTIONS[name], value, "node")
    assert found == expected and type(found) is type(expected)


@pytest.mark.parametrize(
    ("name", "value", "sentence"),
    [
        ("flag", 1, "node.flag is 1; it must be true or false."),
        ("count", True, "node.count is True; it must be a whole number."),
        ("count", 3.0, "node.count is 3.0; it must be a whole number."),
        ("count", 10, "node.count is 10; it must be between 1 and 9."),
        ("gain", -1, "node.gain is -1.0; it must be at least 0 V."),
        ("gain", "1", "node.gain is '1'; it must be a number."),
        ("gain", float("inf"), "node.gain is inf; give a finite number."),
        ("loss", 2.0, "node.loss is 2.0; it must be at most 1."),
        ("method", "best", "node.method is 'best'; it must be one of fast, good."),
        ("method", 3, "node.method is 3; it must be a text."),
        ("angles_deg", 3.0, "node.angles_deg is 3.0; it must be a list of numbers."),
        ("topics", [1.0], "node.topics is [1.0]; it must be a list of texts."),
        ("angles_deg", [0.0, True], "it must be a list of numbers."),
        ("angles_deg", [0.0, 91.0], "node.angles_deg is 91.0; it must be between -90 and 90 deg."),
    ],
)
def test_wrong_values_are_named_with_the_remedy(name: str, value: Any, sentence: str) -> None:
    with pytest.raises(ConfigurationError) as error:
        checked_value(DESCRIPTIONS[name], value, "node")
    assert sentence in str(error.value)


@given(st.integers())
def test_a_whole_number_is_taken_exactly_when_it_is_in_range(value: int) -> None:
    if 1 <= value <= 9:
        assert checked_value(DESCRIPTIONS["count"], value, "node") == value
    else:
        with pytest.raises(ConfigurationError):
            checked_value(DESCRIPTIONS["count"], value, "node")


def test_a_mapping_changes_only_what_it_names() -> None:
    read = from_mapping(Example, {"count": 4}, "nodes.example", {"part": Part(size=7)})
    assert read == Example(count=4, part=Part(size=7))
    assert from_mapping(Example, {}, "nodes.example") == Example()


def test_an_unknown_name_gets_the_nearest_known_one() -> None:
    with pytest.raises(
        ConfigurationError, match=r"nodes\.a\.cuont is not known; did you mean count"
    ):
        from_mapping(Example, {"cuont": 4}, "nodes.a")


def test_a_name_like_no_other_gets_the_list() -> None:
    text = unknown_name_text("nodes.a.zzz", "zzz", ["count", "gain"])
    assert text == "nodes.a.zzz is not known; known are count, gain."


def test_ranges_in_words() -> None:
    words = {name: range_text(description) for name, description in DESCRIPTIONS.items()}
    assert words["count"] == "between 1 and 9"
    assert words["gain"] == "at least 0 V"
    assert words["loss"] == "at most 1"
    assert words["flag"] == "a number"


def test_configurations_cannot_be_changed() -> None:
    with pytest.raises(FrozenInstanceError):
        Example().count = 5  # type: ignore[misc]
