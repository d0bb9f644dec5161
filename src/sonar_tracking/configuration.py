"""Frozen configuration dataclasses: the one source of every stage's parameters.

A stage declares its parameters once, as a frozen dataclass whose fields are made with
:func:`parameter`. Nodes declare their ROS parameters from it, scenario files are read into it,
and the tables of the documentation are printed from it.
"""

from __future__ import annotations

import dataclasses
import math
import typing
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypeVar

from sonar_tracking.errors import ConfigurationError, unknown_name_text
from sonar_tracking.method_registry import MethodRegistry

SECTION = {"section": True}
"""Metadata of a dataclass field that holds nested configurations and is no parameter itself."""

Value = bool | int | float | str | tuple[float, ...] | tuple[str, ...]


@dataclass(frozen=True)
class ParameterDescription:
    """What is known of one parameter: see :func:`parameter`.

    Attributes
    ----------
    name : str
        Field name, which is also the ROS parameter name.
    kind : type
        ``bool``, ``int``, ``float``, ``str`` or ``tuple``.
    entry_kind : type
        ``float`` or ``str``: of the entries of a tuple.
    default : Value
        Default value.
    description : str
        One line of what it does.
    unit : str
        Unit, empty for pure numbers.
    minimum, maximum : float or None
        Inclusive range of a number, or of each entry of a tuple.
    choices : tuple of str
        Allowed values of a string; empty = any.
    methods : MethodRegistry or None
        Where the choices are methods of a stage: what is known of them.
    changeable : bool
        Whether a running stage takes another value at its next datum.
    """

    name: str
    kind: type
    default: Value
    description: str
    unit: str
    minimum: float | None
    maximum: float | None
    choices: tuple[str, ...]
    entry_kind: type = float
    methods: MethodRegistry[Any] | None = None
    changeable: bool = False


def parameter(
    default: Any,
    description: str,
    *,
    unit: str = "",
    minimum: float | None = None,
    maximum: float | None = None,
    choices: tuple[str, ...] = (),
    methods: MethodRegistry[Any] | None = None,
    changeable: bool = False,
) -> Any:
    """Declare one field of a configuration dataclass.

    Parameters
    ----------
    default : bool, int, float, str, tuple of float or tuple of str
        Default value.
    description : str
        One line of what it does.
    unit : str
        Unit, empty for pure numbers.
    minimum, maximum : float, optional
        Inclusive range.
    choices : tuple of str
        Allowed values of a string, or of each entry of a tuple.
    methods : MethodRegistry, optional
        Instead of choices: the methods whose names are allowed. They are looked up whenever the
        parameter is described, and the text goes on with what each of them does.
    changeable : bool
        The stage reads the value at every datum and keeps nothing made from it, so that it may be
        changed while the stage runs.
    """
    metadata = {
        "description": description,
        "unit": unit,
        "minimum": minimum,
        "maximum": maximum,
        "choices": choices,
        "methods": methods,
        "changeable": changeable,
    }
    return dataclasses.field(default=default, metadata=metadata)


def describe(configuration: type) -> tuple[ParameterDescription, ...]:
    """Return the descriptions of all parameters of a configuration dataclass, in order.

    Fields with the metadata :data:`SECTION` are no parameters and are left out.
    """
    hints = typing.get_type_hints(configuration)
    descriptions = []
    for field in dataclasses.fields(configuration):
        if field.metadata.get("section"):
            continue
        hint = hints[field.name]
        kind = typing.get_origin(hint) or hint
        default: Any = field.default
        described = ParameterDescription(
            name=field.name,
            kind=kind,
            default=default,
            entry_kind=typing.get_args(hint)[0] if kind is tuple else float,
            **field.metadata,
        )
        descriptions.append(_with_methods(described))
    return tuple(descriptions)


def _with_methods(description: ParameterDescription) -> ParameterDescription:
    """Return a parameter that chooses a method with the choices and texts of the methods."""
    methods = description.methods
    if methods is None:
        return description
    text = f"{description.description}. {methods.text}"
    return dataclasses.replace(description, choices=methods.names, description=text)


def checked_value(description: ParameterDescription, value: Any, where: str) -> Value:
    """Return ``value`` as the parameter's type, or raise a sentence that says what is wrong.

    Raises
    ------
    ConfigurationError
        On a wrong type, a value out of range, or a value that is not among the choices.
    """
    name = f"{where}.{description.name}"
    converted = _converted(description, value, name)
    entries = converted if isinstance(converted, tuple) else (converted,)
    for entry in entries:
        if isinstance(entry, bool | str):
            continue
        if not math.isfinite(entry):
            raise ConfigurationError(f"{name} is {entry}; give a finite number.")
        below = description.minimum is not None and entry < description.minimum
        above = description.maximum is not None and entry > description.maximum
        if below or above:
            raise ConfigurationError(f"{name} is {entry}; it must be {range_text(description)}.")
    if description.choices and not set(entries) <= set(description.choices):
        raise ConfigurationError(
            f"{name} is {converted!r}; it must be one of {', '.join(description.choices)}."
        )
    return converted


def range_text(description: ParameterDescription) -> str:
    """Return the allowed range of a number in words, e.g. ``"between 0 and 1"``."""
    unit = f" {description.unit}" if description.unit else ""
    low, high = description.minimum, description.maximum
    if low is not None and high is not None:
        return f"between {low:g} and {high:g}{unit}"
    if low is not None:
        return f"at least {low:g}{unit}"
    if high is not None:
        return f"at most {high:g}{unit}"
    return "a number" + unit


def _converted(description: ParameterDescription, value: Any, name: str) -> Value:
    kind = description.kind
    if kind is bool and isinstance(value, bool):
        return value
    if kind is str and isinstance(value, str):
        return value
    if not isinstance(value, bool):
        if kind is int and isinstance(value, int):
            return value
        if kind is float and isinstance(value, int | float):
            return float(value)
        if kind is tuple and isinstance(value, list | tuple):
            if description.entry_kind is str and all(isinstance(v, str) for v in value):
                return tuple(value)
            if description.entry_kind is float and _all_numbers(value):
                return tuple(float(v) for v in value)
    expected = {
        bool: "true or false",
        int: "a whole number",
        float: "a number",
        str: "a text",
        tuple: "a list of texts" if description.entry_kind is str else "a list of numbers",
    }[kind]
    raise ConfigurationError(f"{name} is {value!r}; it must be {expected}.")


def _all_numbers(values: list[Any] | tuple[Any, ...]) -> bool:
    return all(isinstance(v, int | float) and not isinstance(v, bool) for v in values)


ConfigurationType = TypeVar("ConfigurationType")


def from_mapping(
    configuration: type[ConfigurationType],
    values: Mapping[str, Any],
    where: str,
    sections: Mapping[str, Any] | None = None,
) -> ConfigurationType:
    """Make a configuration from names and values as read from a file.

    Parameters
    ----------
    configuration : type
        Frozen dataclass whose fields were made with :func:`parameter`.
    values : mapping
        Parameter names and values; what is not given keeps its default.
    where : str
        Where the values come from, named in errors, e.g. ``"nodes.bearing_tracker"``.
    sections : mapping, optional
        Values of the fields with the metadata :data:`SECTION`, already read.

    Raises
    ------
    ConfigurationError
        On an unknown name (the nearest known one is suggested), a wrong type or range.
    """
    known = {description.name: description for description in describe(configuration)}
    checked: dict[str, Any] = dict(sections or {})
    for name, value in values.items():
        if name not in known:
            names = [*known, *(sections or {})]
            raise ConfigurationError(unknown_name_text(f"{where}.{name}", name, names))
        checked[name] = checked_value(known[name], value, where)
    return configuration(**checked)
