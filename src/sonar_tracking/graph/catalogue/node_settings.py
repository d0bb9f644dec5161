"""Parameters of the nodes as people write them: checked before any node is started (no ROS)."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

from sonar_tracking.active.contacts import contact_tracker_configuration
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.configuration import (
    ConfigurationType,
    Value,
    describe,
    from_mapping,
)
from sonar_tracking.errors import ConfigurationError, unknown_name_text
from sonar_tracking.graph.catalogue.flow_window import SHORT_WINDOW
from sonar_tracking.graph.catalogue.node_catalogue import NODES, STATION, described
from sonar_tracking.graph.catalogue.node_description import NodeDescription
from sonar_tracking.graph.catalogue.passive_nodes import (
    BAND_DEMODULATOR,
    BEARING_TRACKER,
    LINE_TRACKER,
    SUBSPACE_ESTIMATOR,
)
from sonar_tracking.passive.bearings import bearing_tracker_configuration
from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    BearingTrackerConfiguration,
    check_estimator,
)
from sonar_tracking.passive.lines.line_tracker_configuration import (
    LineTrackerConfiguration,
    check_line_tracker,
)
from sonar_tracking.passive.subspaces import subspace_configuration
from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration
from sonar_tracking.simulation.scenarios.scenario_file import read_yaml_mapping
from sonar_tracking.tma.targets.tma_tracker_configuration import (
    TmaTrackerConfiguration,
    check_tma_tracker,
)

_CHECKS: Mapping[type, Callable[[Any], None]] = {
    SubspaceConfiguration: subspace_configuration.check_configuration,
    BearingTrackerConfiguration: bearing_tracker_configuration.check_configuration,
    ContactTrackerConfiguration: contact_tracker_configuration.check_configuration,
    LineTrackerConfiguration: check_line_tracker,
    TmaTrackerConfiguration: check_tma_tracker,
}
"""What refuses parameters that do not fit together, by their configuration; the stages ask the
same, but they need not be loaded for it."""

_DEEPEST = 10_000
"""Largest flow_depth that is allowed."""

NodeSettings = dict[str, dict[str, Value]]


def resolved_settings(
    given: Mapping[str, Mapping[str, Any]], nodes: tuple[NodeDescription, ...], where: str
) -> NodeSettings:
    """Return every parameter of some nodes: as given, else the default.

    Parameters
    ----------
    given : mapping
        Node name, parameter name, value; other nodes than those asked for must at least exist.
    nodes : tuple of NodeDescription
        The nodes asked for.
    where : str
        Where the values come from, named in errors.

    Raises
    ------
    ConfigurationError
        On an unknown node or parameter, a wrong type, a value out of range, or parameters that
        do not fit together.
    """
    known = {*NODES, *(node.name for node in nodes)}
    for name, values in given.items():
        if name not in known and described(name, values) is None:
            raise ConfigurationError(unknown_name_text(f"{where}: {name}", name, known))
    settings = {node.name: _settings(node, given.get(node.name, {}), where) for node in nodes}
    for station in {node.station for node in nodes}:
        _check_pair(settings, station, where)
    return settings


def with_room_for_bursts(settings: NodeSettings, block_seconds: float) -> NodeSettings:
    """Return settings whose queues hold what the blocks in the graph set off at once.

    The clock moves by whole blocks, and one block completes several estimates when their period
    is shorter: all of them are published before the next node has read the first. The line tracker
    keeps samples until their bearings are known, and publishes all frames of what has waited at
    once: at the begin, at the end, and when the estimators have fallen behind.

    Parameters
    ----------
    settings : mapping
        Of every node.
    block_seconds : float
        Step of the clock, s.
    """
    stations = {str(values.get(STATION, "")) for values in settings.values()}
    needed = max((_burst(settings, station, block_seconds) for station in stations), default=0)
    if not needed:
        return settings
    return {
        name: {**values, "flow_depth": min(max(int(str(values["flow_depth"])), needed), _DEEPEST)}
        if "flow_depth" in values and not _is_source(name, values)
        else values
        for name, values in settings.items()
    }


def _burst(settings: NodeSettings, station: str, block_seconds: float) -> int:
    """Return how many messages behind the estimator of a station may come at once; 0 = no such."""
    estimator = settings.get(SUBSPACE_ESTIMATOR.at_station(station).name, {})
    period = estimator.get("period")
    if not isinstance(period, float):
        return 0
    needed = 2 * SHORT_WINDOW * math.ceil(block_seconds / period)
    frame_length = settings.get(LINE_TRACKER.at_station(station).name, {}).get("frame_length")
    if isinstance(frame_length, float):
        # Snapshots come about once per 1 / bandwidth; an unknown bandwidth is above 1 Hz.
        demodulator = settings.get(BAND_DEMODULATOR.at_station(station).name, {})
        bandwidth = float(str(demodulator.get("bandwidth", 0.0)))
        waiting = float(str(estimator["covariance_snapshots"])) / (bandwidth or 1.0)
        waiting += 2 * SHORT_WINDOW * (block_seconds + period)
        needed = max(needed, 2 * math.ceil(waiting / (0.5 * frame_length)))
    return needed


def _is_source(name: str, values: Mapping[str, Any]) -> bool:
    node = described(name, values)
    return node is not None and bool(node.section)


def read_settings(path: Path) -> dict[str, dict[str, Any]]:
    """Read a parameter file: node, parameter, value; the form of ROS is understood too.

    Raises
    ------
    ConfigurationError
        If it cannot be read or is not such a mapping.
    """
    settings: dict[str, dict[str, Any]] = {}
    for name, values in read_yaml_mapping(path).items():
        if isinstance(values, Mapping) and set(values) == {"ros__parameters"}:
            values = values["ros__parameters"]
        if not isinstance(values, Mapping):
            raise ConfigurationError(
                f"{path}: {name} must be a mapping of parameter names to values, "
                "e.g. 'bearing_tracker: {method: ml_fusion}'."
            )
        # "/**/" is how ROS writes: in whatever namespace.
        settings[str(name).removeprefix("/").removeprefix("**/")] = dict(values)
    return settings


def _settings(node: NodeDescription, given: Mapping[str, Any], where: str) -> dict[str, Value]:
    known = {description.name for description in node.parameters}
    place = f"{where}: {node.name}"
    for name in given:
        if name not in known:
            raise ConfigurationError(unknown_name_text(f"{place}.{name}", name, known))
    settings: dict[str, Value] = {}
    for configuration in node.configurations:
        names = {field.name for field in fields(configuration)}
        own = {name: value for name, value in given.items() if name in names}
        made: Any = from_mapping(configuration, own, place)
        if configuration in _CHECKS:
            try:
                _CHECKS[configuration](made)
            except ConfigurationError as error:
                raise ConfigurationError(f"{place}: {error}") from error
        settings |= {name: getattr(made, name) for name in sorted(names)}
    if STATION in settings:
        if settings[STATION] not in ("", node.station):
            raise ConfigurationError(
                f"{place}.{STATION} is {settings[STATION]!r}, but the name of the node says "
                f"{node.station!r}; leave it out."
            )
        settings[STATION] = node.station
    return settings


def _check_pair(settings: NodeSettings, station: str, where: str) -> None:
    """Refuse a tracker and an estimator of one station that do not fit together."""
    pair = SUBSPACE_ESTIMATOR.at_station(station).name, BEARING_TRACKER.at_station(station).name
    if not {*pair} <= set(settings):
        return

    def made(kind: type[ConfigurationType], name: str) -> ConfigurationType:
        names = [description.name for description in describe(kind)]
        return from_mapping(kind, {each: settings[name][each] for each in names}, where)

    estimator = made(SubspaceConfiguration, pair[0])
    tracker = made(BearingTrackerConfiguration, pair[1])
    try:
        check_estimator(tracker, estimator)
    except ConfigurationError as error:
        raise ConfigurationError(f"{where}: {error}") from error
