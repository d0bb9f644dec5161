"""Passive chain: subspaces of an array, bearing tracks, frequency lines.

Two ways in: the stages, which take blocks of a stream as the nodes do (:class:`SubspaceStage`,
:class:`BearingTrackerStage`, :class:`BandDemodulatorStage`, :class:`LineTrackerStage`), and the
functions behind them, which take plain arrays. Arrival angles are radians from array broadside.
"""

from typing import TYPE_CHECKING

from sonar_tracking.lazy_imports import lazy_exports

__all__ = [
    "BEARING_METHODS",
    "SUBSPACE_METHODS",
    "BandDemodulatorConfiguration",
    "BandDemodulatorStage",
    "BearingMethodEntry",
    "BearingTrackerConfiguration",
    "BearingTrackerStage",
    "LineTrackerConfiguration",
    "LineTrackerStage",
    "ProjectionProblem",
    "SignalSubspace",
    "SubspaceConfiguration",
    "SubspaceMethod",
    "SubspaceMethodEntry",
    "SubspaceStage",
    "beam_powers",
    "minimum_description_length",
    "music_bearings",
    "near_field_bound",
    "near_field_grid",
    "near_field_information",
    "near_field_maximum_likelihood",
    "near_field_music",
    "projection_fit",
    "rayleigh_distance",
    "sample_covariance",
    "signal_subspace",
    "source_count",
    "source_covariance",
    "spherical_vectors",
    "stochastic_fisher_information",
]

if TYPE_CHECKING:
    from sonar_tracking.passive.bearings.bearing_method_registry import (
        BEARING_METHODS,
        BearingMethodEntry,
    )
    from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
        BearingTrackerConfiguration,
    )
    from sonar_tracking.passive.bearings.bearing_tracker_stage import BearingTrackerStage
    from sonar_tracking.passive.directions.conventional_beamformer import beam_powers
    from sonar_tracking.passive.directions.projection_fit import ProjectionProblem, projection_fit
    from sonar_tracking.passive.directions.signal_subspace import SignalSubspace, signal_subspace
    from sonar_tracking.passive.lines.band_demodulator_configuration import (
        BandDemodulatorConfiguration,
    )
    from sonar_tracking.passive.lines.band_demodulator_stage import BandDemodulatorStage
    from sonar_tracking.passive.lines.line_tracker_configuration import LineTrackerConfiguration
    from sonar_tracking.passive.lines.line_tracker_stage import LineTrackerStage
    from sonar_tracking.passive.near_field.near_field_bound import (
        near_field_bound,
        near_field_information,
    )
    from sonar_tracking.passive.near_field.near_field_search import (
        near_field_grid,
        near_field_maximum_likelihood,
        near_field_music,
    )
    from sonar_tracking.passive.near_field.spherical_steering import (
        rayleigh_distance,
        spherical_vectors,
    )
    from sonar_tracking.passive.performance.fisher_information import (
        source_covariance,
        stochastic_fisher_information,
    )
    from sonar_tracking.passive.sources.mdl import minimum_description_length, source_count
    from sonar_tracking.passive.sources.moving_source_counting import sample_covariance
    from sonar_tracking.passive.sources.music import music_bearings
    from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration
    from sonar_tracking.passive.subspaces.subspace_method import SubspaceMethod
    from sonar_tracking.passive.subspaces.subspace_method_registry import (
        SUBSPACE_METHODS,
        SubspaceMethodEntry,
    )
    from sonar_tracking.passive.subspaces.subspace_stage import SubspaceStage
else:
    __getattr__, __dir__ = lazy_exports(
        __name__,
        {
            "bearings.bearing_method_registry": ["BEARING_METHODS", "BearingMethodEntry"],
            "bearings.bearing_tracker_configuration": ["BearingTrackerConfiguration"],
            "bearings.bearing_tracker_stage": ["BearingTrackerStage"],
            "directions.conventional_beamformer": ["beam_powers"],
            "directions.projection_fit": ["ProjectionProblem", "projection_fit"],
            "directions.signal_subspace": ["SignalSubspace", "signal_subspace"],
            "lines.band_demodulator_configuration": ["BandDemodulatorConfiguration"],
            "lines.band_demodulator_stage": ["BandDemodulatorStage"],
            "lines.line_tracker_configuration": ["LineTrackerConfiguration"],
            "lines.line_tracker_stage": ["LineTrackerStage"],
            "near_field.near_field_bound": ["near_field_bound", "near_field_information"],
            "near_field.near_field_search": [
                "near_field_grid",
                "near_field_maximum_likelihood",
                "near_field_music",
            ],
            "near_field.spherical_steering": ["rayleigh_distance", "spherical_vectors"],
            "performance.fisher_information": [
                "source_covariance",
                "stochastic_fisher_information",
            ],
            "sources.mdl": ["minimum_description_length", "source_count"],
            "sources.moving_source_counting": ["sample_covariance"],
            "sources.music": ["music_bearings"],
            "subspaces.subspace_configuration": ["SubspaceConfiguration"],
            "subspaces.subspace_method": ["SubspaceMethod"],
            "subspaces.subspace_method_registry": ["SUBSPACE_METHODS", "SubspaceMethodEntry"],
            "subspaces.subspace_stage": ["SubspaceStage"],
        },
    )
