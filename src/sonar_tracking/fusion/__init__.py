"""One picture of all others: track lists and bearing tracks in, one row a target out.

``TrackFusionStage`` is the stage of the node ``track_fusion``; it takes a ``FusionFrame`` and gives
a ``FusionUpdate``.
"""

from sonar_tracking.fusion.fusion_records import FusionFrame, FusionUpdate
from sonar_tracking.fusion.inverse_covariance_intersection import inverse_covariance_intersection
from sonar_tracking.fusion.track_fusion_configuration import TrackFusionConfiguration
from sonar_tracking.fusion.track_fusion_stage import TrackFusionStage

__all__ = [
    "FusionFrame",
    "FusionUpdate",
    "TrackFusionConfiguration",
    "TrackFusionStage",
    "inverse_covariance_intersection",
]
