"""All nodes of the graph: names, inputs, outputs and parameters (no ROS import).

The documentation, the launch file and the orchestration read it. A node reads its own description
alone: it starts without the parameters of the others.
"""

from __future__ import annotations

from sonar_tracking.graph.catalogue.active_nodes import HPDA_TRACKER
from sonar_tracking.graph.catalogue.display_nodes import SCENE_PUBLISHER
from sonar_tracking.graph.catalogue.fusion_nodes import TRACK_FUSION
from sonar_tracking.graph.catalogue.nmea_nodes import AIS_TRUTH, NMEA_OUTPUT, OWN_SHIP_NMEA
from sonar_tracking.graph.catalogue.page_nodes import OPERATOR_DISPLAY
from sonar_tracking.graph.catalogue.passive_nodes import (
    BAND_DEMODULATOR,
    BEARING_TRACKER,
    LINE_TRACKER,
    SUBSPACE_ESTIMATOR,
)
from sonar_tracking.graph.catalogue.simulator_nodes import SENSOR_SIMULATORS, WORLD_SIMULATOR
from sonar_tracking.graph.catalogue.tma_nodes import TMA_TRACKER

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
