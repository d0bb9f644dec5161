"""The ROS 2 graph: nodes, messages, quality of service, orchestration.

For a node of one's own: :class:`SonarNode`, described by a :class:`NodeDescription` and run by
:func:`run_node`, between topics of the graph or its own. These and the nodes need ROS; the topics
and the nodes' descriptions do not.
"""

import os
from typing import TYPE_CHECKING

from sonar_tracking.lazy_imports import lazy_exports

# Results are bit-identical only with one linear algebra thread, set before numpy loads.
for _variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_variable, "1")

__all__ = [
    "ACTIVE_THRESHOLD",
    "ACTIVE_TRACKS",
    "BEARING_TRACKS",
    "CONTACTS",
    "FREQUENCY_LINES",
    "NODES",
    "ODOMETRY",
    "PASSIVE_TRACKS",
    "SAMPLES",
    "SNAPSHOTS",
    "SUBSPACES",
    "ArraySimulator",
    "BandDemodulator",
    "BearingSimulator",
    "BearingTracker",
    "ContactSimulator",
    "HpdaTracker",
    "HydrophoneSimulator",
    "JoinedItem",
    "LineTracker",
    "NodeDescription",
    "Recorder",
    "SonarNode",
    "SubspaceEstimator",
    "TmaTracker",
    "Topic",
    "TopicKind",
    "TopicRole",
    "WorldSimulator",
    "run_node",
]

if TYPE_CHECKING:
    from sonar_tracking.graph.catalogue.node_catalogue import NODES
    from sonar_tracking.graph.catalogue.node_description import NodeDescription
    from sonar_tracking.graph.catalogue.topics import (
        ACTIVE_THRESHOLD,
        ACTIVE_TRACKS,
        BEARING_TRACKS,
        CONTACTS,
        FREQUENCY_LINES,
        ODOMETRY,
        PASSIVE_TRACKS,
        SAMPLES,
        SNAPSHOTS,
        SUBSPACES,
        Topic,
        TopicKind,
        TopicRole,
    )
    from sonar_tracking.graph.node_base.event_time_join import JoinedItem
    from sonar_tracking.graph.node_base.node_process import run_node
    from sonar_tracking.graph.node_base.sonar_node import SonarNode
    from sonar_tracking.graph.nodes.array_simulator import ArraySimulator
    from sonar_tracking.graph.nodes.band_demodulator import BandDemodulator
    from sonar_tracking.graph.nodes.bearing_simulator import BearingSimulator
    from sonar_tracking.graph.nodes.bearing_tracker import BearingTracker
    from sonar_tracking.graph.nodes.contact_simulator import ContactSimulator
    from sonar_tracking.graph.nodes.hpda_tracker import HpdaTracker
    from sonar_tracking.graph.nodes.hydrophone_simulator import HydrophoneSimulator
    from sonar_tracking.graph.nodes.line_tracker import LineTracker
    from sonar_tracking.graph.nodes.recorder import Recorder
    from sonar_tracking.graph.nodes.subspace_estimator import SubspaceEstimator
    from sonar_tracking.graph.nodes.tma_tracker import TmaTracker
    from sonar_tracking.graph.nodes.world_simulator import WorldSimulator
else:
    __getattr__, __dir__ = lazy_exports(
        __name__,
        {
            "catalogue.node_catalogue": ["NODES"],
            "catalogue.node_description": ["NodeDescription"],
            "catalogue.topics": [
                "ACTIVE_THRESHOLD",
                "ACTIVE_TRACKS",
                "BEARING_TRACKS",
                "CONTACTS",
                "FREQUENCY_LINES",
                "ODOMETRY",
                "PASSIVE_TRACKS",
                "SAMPLES",
                "SNAPSHOTS",
                "SUBSPACES",
                "Topic",
                "TopicKind",
                "TopicRole",
            ],
            "node_base.event_time_join": ["JoinedItem"],
            "node_base.node_process": ["run_node"],
            "node_base.sonar_node": ["SonarNode"],
            "nodes.array_simulator": ["ArraySimulator"],
            "nodes.band_demodulator": ["BandDemodulator"],
            "nodes.bearing_simulator": ["BearingSimulator"],
            "nodes.bearing_tracker": ["BearingTracker"],
            "nodes.contact_simulator": ["ContactSimulator"],
            "nodes.hpda_tracker": ["HpdaTracker"],
            "nodes.hydrophone_simulator": ["HydrophoneSimulator"],
            "nodes.line_tracker": ["LineTracker"],
            "nodes.recorder": ["Recorder"],
            "nodes.subspace_estimator": ["SubspaceEstimator"],
            "nodes.tma_tracker": ["TmaTracker"],
            "nodes.world_simulator": ["WorldSimulator"],
        },
    )
