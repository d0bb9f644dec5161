"""ROS parameters of a node, declared from configuration dataclasses.

A node is not started with a parameter it cannot use: it says why and ends.
"""

from __future__ import annotations

import array
from collections.abc import Collection, Iterable, Mapping
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

_OVERRIDES_OF_ROS = ("use_sim_time", "start_type_description_service")
_PREFIX_OF_ROS = "qos_overrides."


def check_overrides(
    configurations: Iterable[type], overrides: Mapping[str, Any], where: str
) -> None:
    """Refuse parameters the node does not have, and values they cannot take, all at once.

    Parameters
    ----------
    configurations : iterable of type
        All configuration dataclasses of the node.
    overrides : mapping
        Names and values given by the user.
    where : str
        Name of the node, for the sentences.

    Raises
    ------
    ConfigurationError
        With one sentence for each parameter that cannot be used.
    """
    known = {d.name: d for configuration in configurations for d in describe(configuration)}
    problems = unknown_overrides(known, overrides, where)
    for name in known.keys() & overrides.keys():
        try:
            checked_value(known[name], _plain(known[name], overrides[name]), where)
        except ConfigurationError as error:
            problems.append(str(error))
    if problems:
        raise ConfigurationError("\n".join(sorted(problems)))


def resolve(
    configuration: type[ConfigurationType], overrides: Mapping[str, Any], where: str
) -> ConfigurationType:
    """Return a configuration with what was given; names of other configurations are passed over.

    Raises
    ------
    ConfigurationError
        On a value that cannot be used, or values that do not go together.
    """
    return configuration(**checked_values(configuration, overrides, where))


def checked_values(configuration: type, given: Mapping[str, Any], where: str) -> dict[str, Value]:
    """Return those of the given values that belong to a configuration, in its types.

    Raises
    ------
    ConfigurationError
        On a value that cannot be used.
    """
    return {
        description.name: checked_value(
            description, _plain(description, given[description.name]), where
        )
        for description in describe(configuration)
        if description.name in given
    }


def unknown_overrides(known: Collection[str], overrides: Iterable[str], where: str) -> list[str]:
    """Return a sentence for each override that is no parameter of the node."""
    return [
        unknown_name_text(f"{where}.{name}", name, known)
        for name in sorted(overrides)
        if name not in known
        and name not in _OVERRIDES_OF_ROS
        and not name.startswith(_PREFIX_OF_ROS)
    ]


def declare(node: Node, configuration: Any) -> None:
    """Declare all fields of a configuration as parameters with their ranges."""
    for description in describe(type(configuration)):
        value = getattr(configuration, description.name)
        node.declare_parameter(
            description.name,
            _sent(value),
            descriptor(description),
            ignore_override=True,
        )


def descriptor(description: ParameterDescription) -> ParameterDescriptor:
    """Return the ROS descriptor of a parameter: text, range, and whether it can be changed.

    A descriptor knows closed ranges of single numbers alone; whatever else limits a value is said
    in words.
    """
    unit = f" [{description.unit}]" if description.unit else ""
    result = ParameterDescriptor(
        description=description.description + unit, read_only=not description.changeable
    )
    low, high = description.minimum, description.maximum
    if description.choices:
        result.additional_constraints = f"one of {', '.join(description.choices)}"
    elif low is None and high is None:
        pass
    elif description.kind is tuple:
        result.additional_constraints = f"each {range_text(description)}"
    elif low is None or high is None:
        result.additional_constraints = range_text(description)
    elif description.kind is int:
        whole = IntegerRange(from_value=int(low), to_value=int(high), step=1)
        result.integer_range = [whole]
    else:
        limits = FloatingPointRange(from_value=float(low), to_value=float(high))
        result.floating_point_range = [limits]
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
