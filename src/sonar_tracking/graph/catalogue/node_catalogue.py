"""All nodes of the graph: names, inputs, outputs and parameters (no ROS import).

The documentation, the launch file and the orchestration read it. A node reads its own description
alone: it starts without the parameters of the others.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from sonar_tracking.graph.catalogue.active_nodes import HPDA_TRACKER
from sonar_tracking.graph.catalogue.display_nodes import SCENE_PUBLISHER
from sonar_tracking.graph.catalogue.fusion_nodes import TRACK_FUSION
from sonar_tracking.graph.catalogue.nmea_nodes import AIS_TRUTH, NMEA_OUTPUT, OWN_SHIP_NMEA
from sonar_tracking.graph.catalogue.node_description import NodeDescription
from sonar_tracking.graph.catalogue.page_nodes import OPERATOR_DISPLAY
from sonar_tracking.graph.catalogue.passive_nodes import (
    BAND_DEMODULATOR,
    BEARING_TRACKER,
    LINE_TRACKER,
    SUBSPACE_ESTIMATOR,
)
from sonar_tracking.graph.catalogue.planned_node import PlannedNode
from sonar_tracking.graph.catalogue.simulator_nodes import SENSOR_SIMULATORS, WORLD_SIMULATOR
from sonar_tracking.graph.catalogue.tma_nodes import TMA_TRACKER
from sonar_tracking.records.station_name import station_name

NODES = {
    description.name: description
    for description in (
        WORLD_SIMULATOR,
        *SENSOR_SIMULATORS,
        OWN_SHIP_NMEA,
        AIS_TRUTH,
        BAND_DEMODULATOR,
        SUBSPACE_ESTIMATOR,
        BEARING_TRACKER,
        LINE_TRACKER,
        TMA_TRACKER,
        HPDA_TRACKER,
        TRACK_FUSION,
        NMEA_OUTPUT,
        SCENE_PUBLISHER,
        OPERATOR_DISPLAY,
    )
}
"""Every node by its name, sources first, in the order data flow."""

STATION = "station"
"""Parameter of a node that names the sensor or ship it is for."""


def described(name: str, parameters: Mapping[str, Any]) -> NodeDescription | None:
    """Return what is known of a node; None = there is no such one.

    Parameters
    ----------
    name : str
        Of the node, which begins with its station, e.g. ``"bow_bearing_tracker"``.
    parameters : mapping
        Of the node: they name the station.
    """
    station = str(parameters.get(STATION, ""))
    prefix = f"{station_name(station)}_" if station else ""
    node = NODES.get(name.removeprefix(prefix)) if name.startswith(prefix) else None
    return None if node is None else node.at_station(station)


def description_of(node: PlannedNode) -> NodeDescription:
    """Return what is known of a planned node of the catalogue."""
    description = described(node.name, node.parameters)
    assert description is not None
    return description
