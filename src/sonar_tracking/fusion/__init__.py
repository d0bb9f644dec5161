"""One picture of all others: track lists and bearing tracks in, one row a target out.

``TrackFusionStage`` is the stage of the node ``track_fusion``; it takes a ``FusionFrame`` and gives
a ``FusionUpdate``.
"""

from typing import TYPE_CHECKING

from sonar_tracking.lazy_imports import lazy_exports

__all__ = [
    "FusionFrame",
    "FusionUpdate",
    "TrackFusionConfiguration",
    "TrackFusionStage",
    "inverse_covariance_intersection",
]

if TYPE_CHECKING:
    from sonar_tracking.fusion.fusion_records import FusionFrame, FusionUpdate
    from sonar_tracking.fusion.inverse_covariance_intersection import (
        inverse_covariance_intersection,
    )
    from sonar_tracking.fusion.track_fusion_configuration import TrackFusionConfiguration
    from sonar_tracking.fusion.track_fusion_stage import TrackFusionStage

__getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "fusion_records": ("FusionFrame", "FusionUpdate"),
        "inverse_covariance_intersection": ("inverse_covariance_intersection",),
        "track_fusion_configuration": ("TrackFusionConfiguration",),
        "track_fusion_stage": ("TrackFusionStage",),
    },
)
