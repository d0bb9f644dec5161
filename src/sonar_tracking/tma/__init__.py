"""Target motion analysis: bearings and frequency lines become positions and velocities.

Azimuths are radians anticlockwise from +x (east) of the frame ``map``. The kinematic state is
``[x, y, vx, vy]``, absolute in ``map``; behind it stands one source frequency a line. Leading
dimensions ``...`` are a batch of independent runs; a node has none.

Three ways in: :class:`TmaTrackerStage` takes the bearing tracks of whole frames as the node does,
:class:`TargetSolver` the observations of one target, and an estimator such as :class:`RangeBank`
batches of runs.
"""

from typing import TYPE_CHECKING

from sonar_tracking.lazy_imports import lazy_exports

__all__ = [
    "TMA_METHODS",
    "BatchConfiguration",
    "BatchEstimate",
    "ChanSummedLines",
    "CheongFusedLine",
    "DirectionHistory",
    "DirectionSmootherConfiguration",
    "Estimator",
    "JauffretStackedLines",
    "ObservationLog",
    "PassiveFrame",
    "RangeBank",
    "RangeBankConfiguration",
    "SingleFilterConfiguration",
    "SmoothedTracks",
    "TargetHistory",
    "TargetObservation",
    "TargetPath",
    "TargetSmootherConfiguration",
    "TargetSolution",
    "TargetSolver",
    "TmaEstimate",
    "TmaMeasurement",
    "TmaMethodEntry",
    "TmaTrackerConfiguration",
    "TmaTrackerStage",
    "TmaUpdate",
    "estimate_batch_likelihood",
    "polar_bound",
    "posterior_bound",
    "smooth_directions",
    "smooth_target",
    "smooth_tracks",
]

if TYPE_CHECKING:
    from sonar_tracking.tma.baselines.chan_summed_lines import ChanSummedLines
    from sonar_tracking.tma.baselines.cheong_fused_line import CheongFusedLine
    from sonar_tracking.tma.baselines.jauffret_stacked_lines import JauffretStackedLines
    from sonar_tracking.tma.batch.batch_likelihood import (
        BatchConfiguration,
        BatchEstimate,
        estimate_batch_likelihood,
    )
    from sonar_tracking.tma.batch.direction_smoother import (
        DirectionHistory,
        DirectionSmootherConfiguration,
        smooth_directions,
    )
    from sonar_tracking.tma.batch.target_history import TargetHistory
    from sonar_tracking.tma.batch.target_smoother import (
        TargetPath,
        TargetSmootherConfiguration,
        smooth_target,
    )
    from sonar_tracking.tma.estimators.estimator import Estimator
    from sonar_tracking.tma.estimators.range_bank import RangeBank
    from sonar_tracking.tma.estimators.range_bank_configuration import RangeBankConfiguration
    from sonar_tracking.tma.estimators.sensor_frame import TmaEstimate, TmaMeasurement
    from sonar_tracking.tma.estimators.single_filter_configuration import SingleFilterConfiguration
    from sonar_tracking.tma.performance.posterior_cramer_rao_bound import (
        polar_bound,
        posterior_bound,
    )
    from sonar_tracking.tma.targets.observation_log import ObservationLog
    from sonar_tracking.tma.targets.passive_frame import PassiveFrame, TmaUpdate
    from sonar_tracking.tma.targets.target_records import TargetObservation, TargetSolution
    from sonar_tracking.tma.targets.target_solver import TargetSolver
    from sonar_tracking.tma.targets.tma_method_registry import TMA_METHODS, TmaMethodEntry
    from sonar_tracking.tma.targets.tma_tracker_configuration import TmaTrackerConfiguration
    from sonar_tracking.tma.tracker.tma_tracker_stage import TmaTrackerStage
    from sonar_tracking.tma.tracker.track_smoothing import SmoothedTracks, smooth_tracks
else:
    __getattr__, __dir__ = lazy_exports(
        __name__,
        {
            "batch.batch_likelihood": [
                "BatchConfiguration",
                "BatchEstimate",
                "estimate_batch_likelihood",
            ],
            "batch.direction_smoother": [
                "DirectionHistory",
                "DirectionSmootherConfiguration",
                "smooth_directions",
            ],
            "batch.target_history": ["TargetHistory"],
            "batch.target_smoother": [
                "TargetPath",
                "TargetSmootherConfiguration",
                "smooth_target",
            ],
            "baselines.chan_summed_lines": ["ChanSummedLines"],
            "baselines.cheong_fused_line": ["CheongFusedLine"],
            "estimators.estimator": ["Estimator"],
            "baselines.jauffret_stacked_lines": ["JauffretStackedLines"],
            "estimators.range_bank": ["RangeBank"],
            "estimators.range_bank_configuration": ["RangeBankConfiguration"],
            "estimators.single_filter_configuration": ["SingleFilterConfiguration"],
            "estimators.sensor_frame": ["TmaEstimate", "TmaMeasurement"],
            "performance.posterior_cramer_rao_bound": ["polar_bound", "posterior_bound"],
            "targets.observation_log": ["ObservationLog"],
            "targets.passive_frame": ["PassiveFrame", "TmaUpdate"],
            "targets.target_records": ["TargetObservation", "TargetSolution"],
            "targets.target_solver": ["TargetSolver"],
            "targets.tma_method_registry": ["TMA_METHODS", "TmaMethodEntry"],
            "targets.tma_tracker_configuration": ["TmaTrackerConfiguration"],
            "tracker.tma_tracker_stage": ["TmaTrackerStage"],
            "tracker.track_smoothing": ["SmoothedTracks", "smooth_tracks"],
        },
    )
