"""ROS parameters of a node, declared from configuration dataclasses.

A node never dies of a wrong parameter: the sentence is reported, the default is used.
"""

from __future__ import annotations

import array
from collections.abc import Iterable, Mapping
from typing import Any, TypeVar

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.node import Node

from sonar_tracking.configuration import (
    ParameterDescription,
    Value,
    checked_value,
    describe,
    range_text,
)
from sonar_tracking.errors import ConfigurationError, unknown_name_text

ConfigurationType = TypeVar("ConfigurationType")

_LARGEST_FLOAT = 1.7976931348623157e308
_LARGEST_INTEGER = 2**63 - 1
_OVERRIDES_OF_ROS = ("use_sim_time", "start_type_description_service")
_PREFIX_OF_ROS = "qos_overrides."


def resolve(
    configuration: type[ConfigurationType], overrides: Mapping[str, Any], where: str
) -> tuple[ConfigurationType, list[str]]:
    """Return a configuration with the valid overrides, and a sentence for each invalid one.

    Parameters
    ----------
    configuration : type
        Configuration dataclass.
    overrides : mapping
        Names and values given by the user; names of other configurations are passed over.
    where : str
        Name of the node, for the sentences.
    """
    values: dict[str, Value] = {}
    problems = []
    for description in describe(configuration):
        if description.name not in overrides:
            continue
        value = _plain(description, overrides[description.name])
        try:
            values[description.name] = checked_value(description, value, where)
        except ConfigurationError as error:
            problems.append(f"{error} The default {_text(description.default)} is used.")
    try:
        return configuration(**values), problems
    except ConfigurationError as error:
        problems.append(f"{error} The defaults of these parameters are used.")
        return configuration(), problems


def unknown_overrides(
    configurations: Iterable[type], overrides: Iterable[str], where: str
) -> list[str]:
    """Return a sentence for each override that is no parameter of the node."""
    known = {d.name for configuration in configurations for d in describe(configuration)}
    return [
        unknown_name_text(f"{where}.{name}", name, known) + " It was ignored."
        for name in sorted(overrides)
        if name not in known
        and name not in _OVERRIDES_OF_ROS
        and not name.startswith(_PREFIX_OF_ROS)
    ]


def declare(node: Node, configuration: Any) -> None:
    """Declare all fields of a configuration as read-only parameters with their ranges."""
    for description in describe(type(configuration)):
        value = getattr(configuration, description.name)
        node.declare_parameter(
            description.name,
            _sent(value),
            descriptor(description),
            ignore_override=True,
        )


def descriptor(description: ParameterDescription) -> ParameterDescriptor:
    """Return the ROS descriptor of a parameter: text, range, read-only."""
    unit = f" [{description.unit}]" if description.unit else ""
    result = ParameterDescriptor(description=description.description + unit, read_only=True)
    if description.choices:
        result.additional_constraints = f"one of {', '.join(description.choices)}"
    if description.minimum is None and description.maximum is None:
        return result
    low, high = description.minimum, description.maximum
    if description.kind is int:
        result.integer_range = [
            IntegerRange(
                from_value=-_LARGEST_INTEGER if low is None else int(low),
                to_value=_LARGEST_INTEGER if high is None else int(high),
                step=1,
            )
        ]
    elif description.kind is float:
        result.floating_point_range = [
            FloatingPointRange(
                from_value=-_LARGEST_FLOAT if low is None else float(low),
                to_value=_LARGEST_FLOAT if high is None else float(high),
            )
        ]
    else:
        result.additional_constraints = f"each {range_text(description)}"
    return result


def overrides_of(node: Node) -> dict[str, Any]:
    """Return the parameter values given to a node from outside, by name."""
    return {name: parameter.value for name, parameter in node._parameter_overrides.items()}


def _sent(value: Value) -> Any:
    """Return a value as rclpy takes it: it refuses an empty array, but not an empty list."""
    if isinstance(value, tuple):
        if value and isinstance(value[0], str):
            return list(value)
        return array.array("d", value) if value else []
    return value


def _plain(description: ParameterDescription, value: Any) -> Any:
    """Undo what ROS makes of lists; an empty one arrives without a type."""
    if description.kind is tuple:
        return () if value is None else _entries(value)
    return _entries(value)


def _entries(value: Any) -> Any:
    return list(value) if isinstance(value, array.array | tuple) else value


def _text(value: Any) -> str:
    return repr(list(value)) if isinstance(value, tuple) else repr(value)
