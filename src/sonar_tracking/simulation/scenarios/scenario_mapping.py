"""Scenarios from names and values and back: YAML files, recordings."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from datetime import date, datetime, timezone
from pathlib import Path
from typing import Any

import yaml

from sonar_tracking.configuration import from_mapping
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.records.datum import DATUM, datum_of
from sonar_tracking.records.time import NANOSECONDS
from sonar_tracking.simulation.scenarios.array_configuration import (
    ArrayConfiguration,
    NoiseConfiguration,
)
from sonar_tracking.simulation.scenarios.bearing_sensor_configuration import (
    BearingSensorConfiguration,
)
from sonar_tracking.simulation.scenarios.contact_configuration import ContactSensorConfiguration
from sonar_tracking.simulation.scenarios.hydrophone_configuration import HydrophoneConfiguration
from sonar_tracking.simulation.scenarios.platforms import (
    CONSORT,
    OwnShipConfiguration,
    TurnConfiguration,
)
from sonar_tracking.simulation.scenarios.scenario import (
    ACTIVE_SONAR,
    ARRAY,
    BEARING_SENSORS,
    DEFAULT_EPOCH,
    HYDROPHONES,
    LATEST_EPOCH_SECONDS,
    OTHER_SENSORS,
    STATIONS,
    Configuration,
    NodeParameters,
    Scenario,
)
from sonar_tracking.simulation.scenarios.scenario_checks import check_scenario
from sonar_tracking.simulation.scenarios.scenario_file import find_scenario, read_yaml_mapping
from sonar_tracking.simulation.scenarios.station_configuration import (
    StationConfiguration,
    with_sensor_names,
)
from sonar_tracking.simulation.scenarios.target import (
    MOTIONS,
    LineConfiguration,
    TargetConfiguration,
    TargetMotion,
)
from sonar_tracking.yaml_reading import DUMPER


def load_scenario(name_or_path: str | Path) -> Scenario:
    """Read a scenario.

    Parameters
    ----------
    name_or_path : str or Path
        Name of a scenario of the package, or path of a YAML file.

    Raises
    ------
    ConfigurationError
        If there is none, or one of its values cannot be used.
    """
    path = find_scenario(name_or_path)
    mapping = read_yaml_mapping(path)
    return scenario_from_mapping({"name": path.stem, **mapping}, str(path))


def scenario_from_mapping(mapping: Mapping[str, Any], where: str) -> Scenario:
    """Make a scenario from names and values, as read from YAML or from a recording.

    Parameters
    ----------
    mapping : mapping
        As in the YAML file; what is not given keeps its default.
    where : str
        Where it comes from, named in errors.

    Raises
    ------
    ConfigurationError
        On an unknown name (the nearest known one is suggested) or a value that cannot be used.
    """
    values = dict(mapping)
    prefix = f"{where}: "
    others = any(values.get(name, []) not in (None, [], ()) for name in (*OTHER_SENSORS, STATIONS))
    sections = {
        "array_given": not others or not {ARRAY, HYDROPHONES}.isdisjoint(values),
        "epoch": checked_epoch(values.pop("epoch", DEFAULT_EPOCH // NANOSECONDS), prefix),
        DATUM: datum_of(values, where),
        "array": _section(ArrayConfiguration, values.pop("array", {}), f"{prefix}array"),
        "noise": _section(NoiseConfiguration, values.pop("noise", {}), f"{prefix}noise"),
        "own_ship": _moving(OwnShipConfiguration, values.pop("own_ship", {}), f"{prefix}own_ship"),
        CONSORT: None
        if (consort := values.pop(CONSORT, None)) is None
        else _moving(OwnShipConfiguration, consort, f"{prefix}{CONSORT}"),
        "targets": _targets(values.pop("targets", []), f"{prefix}targets"),
        **_optional_sensors(values, prefix),
        BEARING_SENSORS: tuple(
            _section(BearingSensorConfiguration, sensor, f"{prefix}{BEARING_SENSORS}[{index}]")
            for index, sensor in enumerate(
                _list(values.pop(BEARING_SENSORS, []), f"{prefix}{BEARING_SENSORS}")
            )
        ),
        STATIONS: tuple(
            _station(station, f"{prefix}{STATIONS}[{index}]")
            for index, station in enumerate(_list(values.pop(STATIONS, []), f"{prefix}{STATIONS}"))
        ),
        "nodes": _nodes(values.pop("nodes", {}), f"{prefix}nodes"),
    }
    values.pop(DATUM, None)
    scenario = from_mapping(Scenario, values, f"{prefix}scenario", sections)
    if scenario.stamp(scenario.start) <= 0:
        raise ConfigurationError(f"{prefix}epoch + start must lie after 1970; give a later epoch.")
    check_scenario(scenario, prefix)
    return scenario


def scenario_to_mapping(scenario: Scenario) -> dict[str, Any]:
    """Return the resolved scenario as plain names and values, for YAML, JSON and recordings."""
    mapping = _plain(dataclasses.asdict(scenario))
    del mapping["array_given"], mapping["carrier"]
    optional = (*OTHER_SENSORS, HYDROPHONES, CONSORT, DATUM, STATIONS)
    absent = {name for name in optional if not mapping[name]}
    absent |= set() if scenario.array_given else {"array", "noise"}
    mapping = {name: value for name, value in mapping.items() if name not in absent}
    for station in mapping.get(STATIONS, ()):
        for name in (ARRAY, HYDROPHONES, ACTIVE_SONAR):
            if station[name] is None:
                del station[name]
    instant = datetime.fromtimestamp(scenario.epoch // NANOSECONDS, tz=timezone.utc)
    mapping["epoch"] = instant.strftime("%Y-%m-%dT%H:%M:%SZ")
    return mapping


def scenario_to_yaml(scenario: Scenario) -> str:
    """Return the text of a YAML file that :func:`load_scenario` reads as the same scenario."""
    mapping = scenario_to_mapping(scenario)
    text: str = yaml.dump(mapping, Dumper=DUMPER, sort_keys=False, allow_unicode=True)
    return text


def _mapping(values: Any, where: str) -> dict[str, Any]:
    if not isinstance(values, Mapping):
        raise ConfigurationError(f"{where} is {values!r}; it must be a mapping of names to values.")
    return dict(values)


def _list(values: Any, where: str) -> list[Any]:
    if not isinstance(values, list | tuple):
        raise ConfigurationError(f"{where} is {values!r}; it must be a list.")
    return list(values)


def _section(configuration: type[Configuration], values: Any, where: str) -> Configuration:
    return from_mapping(configuration, _mapping(values, where), where)


def _optional(configuration: type[Configuration], values: Any, where: str) -> Configuration | None:
    return None if values is None else _section(configuration, values, where)


def _optional_sensors(values: dict[str, Any], prefix: str) -> dict[str, Any]:
    """Return the time series of an array and an active sonar, each as far as it is given."""
    kinds: dict[str, type] = {
        HYDROPHONES: HydrophoneConfiguration,
        ACTIVE_SONAR: ContactSensorConfiguration,
    }
    return {
        name: _optional(kind, values.pop(name, None), f"{prefix}{name}")
        for name, kind in kinds.items()
    }


def _station(values: Any, where: str) -> StationConfiguration:
    values = _mapping(values, where)
    named = [
        name
        for name in (ARRAY, ACTIVE_SONAR)
        if isinstance(values.get(name), Mapping) and "sensor_id" in values[name]
    ]
    sections = {
        ARRAY: _optional(ArrayConfiguration, values.pop(ARRAY, None), f"{where}.{ARRAY}"),
        "noise": _section(NoiseConfiguration, values.pop("noise", {}), f"{where}.noise"),
        **_optional_sensors(values, f"{where}."),
    }
    return with_sensor_names(from_mapping(StationConfiguration, values, where, sections), named)


def _moving(configuration: type[Configuration], values: Any, where: str) -> Configuration:
    values = _mapping(values, where)
    turns = tuple(
        _section(TurnConfiguration, turn, f"{where}.turns[{index}]")
        for index, turn in enumerate(_list(values.pop("turns", []), f"{where}.turns"))
    )
    return from_mapping(configuration, values, where, {"turns": turns})


def _targets(values: Any, where: str) -> tuple[TargetConfiguration, ...]:
    targets = []
    for index, entry in enumerate(_list(values, where)):
        name = f"{where}[{index}]"
        entry = _mapping(entry, name)
        motion = _motion(entry.pop("motion", None), f"{name}.motion")
        lines = tuple(
            _section(LineConfiguration, line, f"{name}.lines[{number}]")
            for number, line in enumerate(_list(entry.pop("lines", []), f"{name}.lines"))
        )
        entry["name"] = entry.get("name") or f"target_{index + 1}"
        sections = {"lines": lines, "motion": motion}
        targets.append(from_mapping(TargetConfiguration, entry, name, sections))
    return tuple(targets)


def _motion(values: Any, where: str) -> TargetMotion:
    kinds = ", ".join(MOTIONS)
    if values is None:
        raise ConfigurationError(f"{where} is missing; give a motion with kind: one of {kinds}.")
    values = _mapping(values, where)
    kind = values.get("kind")
    if kind not in MOTIONS:
        raise ConfigurationError(f"{where}.kind is {kind!r}; it must be one of {kinds}.")
    read = _moving if kind == "kinematic" else _section
    return read(MOTIONS[kind], values, where)


def _nodes(values: Any, where: str) -> NodeParameters:
    nodes: NodeParameters = {}
    for node, parameters in _mapping(values, where).items():
        checked = _mapping(parameters, f"{where}.{node}")
        for name, value in checked.items():
            entries = value if isinstance(value, list | tuple) else [value]
            if not all(isinstance(entry, bool | int | float | str) for entry in entries):
                raise ConfigurationError(
                    f"{where}.{node}.{name} is {value!r}; it must be a number, a text, true, false "
                    "or a list of numbers."
                )
        nodes[str(node)] = {
            str(name): tuple(value) if isinstance(value, list) else value
            for name, value in checked.items()
        }
    return nodes


def checked_epoch(value: Any, prefix: str) -> int:
    """Return an instant given as ISO 8601 text, YAML timestamp or whole seconds, in ns.

    Raises
    ------
    ConfigurationError
        Naming ``prefix`` and what may be given.
    """
    advice = "give e.g. 2026-01-01T00:00:00Z, or whole seconds since 1970"
    if isinstance(value, str):
        try:
            value = datetime.fromisoformat(value.replace("Z", "+00:00"))
        except ValueError as error:
            raise ConfigurationError(f"{prefix}epoch is {value!r}; {advice}.") from error
    if isinstance(value, date) and not isinstance(value, datetime):
        value = datetime(value.year, value.month, value.day)
    if isinstance(value, datetime):
        value = (value if value.tzinfo else value.replace(tzinfo=timezone.utc)).timestamp()
    number = isinstance(value, int | float) and not isinstance(value, bool)
    if not number or not 0 < value <= LATEST_EPOCH_SECONDS or value != int(value):
        raise ConfigurationError(
            f"{prefix}epoch is {value!r}; {advice}, between 1970 and {LATEST_EPOCH_SECONDS} s."
        )
    return int(value) * NANOSECONDS


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _plain(entry) for name, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(entry) for entry in value]
    return value
