"""Metrics, bounds, offline chains, studies: Monte Carlo over the layers below."""

from typing import TYPE_CHECKING

from sonar_tracking.lazy_imports import lazy_exports

__all__ = [
    "Assignment",
    "BearingScore",
    "PositionScore",
    "assign",
    "gospa",
    "ospa",
    "run_offline_active_chain",
    "run_offline_chain",
    "run_offline_sample_chain",
    "run_offline_tma_chain",
    "score_bag",
    "score_bearing_tracks",
    "score_position_tracks",
    "tracking_bound",
    "truth_as_tracks",
]

if TYPE_CHECKING:
    from sonar_tracking.evaluation.metrics.bearing_score import BearingScore, score_bearing_tracks
    from sonar_tracking.evaluation.metrics.ospa_gospa import Assignment, assign, gospa, ospa
    from sonar_tracking.evaluation.metrics.position_score import (
        PositionScore,
        score_position_tracks,
    )
    from sonar_tracking.evaluation.metrics.position_truth import truth_as_tracks
    from sonar_tracking.evaluation.metrics.score_bag import score_bag
    from sonar_tracking.evaluation.monte_carlo.tracking_bound import tracking_bound
    from sonar_tracking.evaluation.offline.offline_bearing_chain import run_offline_chain
    from sonar_tracking.evaluation.offline.offline_contact_chain import run_offline_active_chain
    from sonar_tracking.evaluation.offline.offline_sample_chain import run_offline_sample_chain
    from sonar_tracking.evaluation.offline.offline_tma_chain import run_offline_tma_chain
else:
    __getattr__, __dir__ = lazy_exports(
        __name__,
        {
            "metrics.bearing_score": ["BearingScore", "score_bearing_tracks"],
            "metrics.ospa_gospa": ["Assignment", "assign", "gospa", "ospa"],
            "metrics.position_score": ["PositionScore", "score_position_tracks"],
            "metrics.position_truth": ["truth_as_tracks"],
            "metrics.score_bag": ["score_bag"],
            "monte_carlo.tracking_bound": ["tracking_bound"],
            "offline.offline_bearing_chain": ["run_offline_chain"],
            "offline.offline_contact_chain": ["run_offline_active_chain"],
            "offline.offline_sample_chain": ["run_offline_sample_chain"],
            "offline.offline_tma_chain": ["run_offline_tma_chain"],
        },
    )
