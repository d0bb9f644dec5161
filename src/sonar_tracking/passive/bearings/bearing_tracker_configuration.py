"""Parameters of the bearing tracker."""

from __future__ import annotations

import math
from dataclasses import dataclass

from sonar_tracking.configuration import parameter
from sonar_tracking.errors import ConfigurationError
from sonar_tracking.passive.bearings.bearing_method_registry import (
    BEARING_METHODS,
    BearingMethodEntry,
)
from sonar_tracking.passive.sources.weak_source_counting import COUNTED_TOGETHER
from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration
from sonar_tracking.passive.subspaces.subspace_method_registry import SUBSPACE_METHODS

SQUARE_DEGREE = math.radians(1.0) ** 2
"""rad^2."""


@dataclass(frozen=True)
class BearingTrackerConfiguration:
    """Parameters of the stage that tracks bearings."""

    method: str = parameter(
        "joint_map",
        "How bearings are measured and filtered",
        methods=BEARING_METHODS,
    )
    source_rank: int = parameter(
        0,
        "Rank of the sources, less than their number if some are coherent (coherent, joint_map); "
        "0 = found by MDL in every covariance",
        minimum=0,
    )
    start: str = parameter(
        "automatic",
        "First bearings: given as parameters, or found by MUSIC in four successive covariances",
        choices=("given", "automatic"),
    )
    initial_bearings_deg: tuple[float, ...] = parameter(
        (),
        "Arrival angles at the first estimate (start = given)",
        unit="deg",
        minimum=-180.0,
        maximum=180.0,
    )
    initial_rates_deg: tuple[float, ...] = parameter(
        (), "Their rates, one for each angle (start = given)", unit="deg/s"
    )
    initial_angle_variance_deg2: float = parameter(
        6.0, "Variance of the given angles", unit="deg^2", minimum=1e-9
    )
    initial_rate_variance_deg2: float = parameter(
        1.0, "Variance of the given rates", unit="deg^2/s^2", minimum=1e-9
    )
    maximum_rate_deg: float = parameter(
        5.0, "Fastest bearing that the automatic start looks for", unit="deg/s", minimum=1e-3
    )
    covariances_counted: int = parameter(
        COUNTED_TOGETHER,
        "Most successive covariances in whose mean sources are counted, beside the means of the "
        "last 1, 2, 4 and so on below it: more show weaker sources, but also weaker reflections, "
        "and nothing where a bearing may turn meanwhile; 1 = each by itself (coherent, joint_map)",
        minimum=1,
        maximum=16,
    )
    track_before_detect: bool = parameter(
        True,
        "Also start tracks of faint sources that no covariance shows by itself, by a Bernoulli "
        "filter on what the tracks leave of the covariances of a uniform line array; they are "
        "followed in all covariances together (start = automatic, joint_map)",
    )
    silence_time: float = parameter(
        1.5,
        "How long a source may be silent before it counts against its existence; a track without "
        "a source coasts about seven times as long and then ends (start = automatic)",
        unit="s",
        minimum=1e-3,
    )
    process_noise_deg2: float = parameter(
        0.1,
        "Spectral density q of the bearing acceleration; of joint_map while a bearing turns",
        unit="deg^2/s^3",
        minimum=0.0,
    )
    steady_process_noise_deg2: float = parameter(
        1e-6,
        "The same of a bearing that hardly ever turns; which of the two a bearing needs, or "
        "what between, is found out by its innovations; never less "
        "than 0.125 |rate|^3 (in radians), by which a target on a straight course turns; "
        "with process_noise_deg2 or more q is constant (joint_map)",
        unit="deg^2/s^3",
        minimum=0.0,
    )
    measurement_variance_deg2: float = parameter(
        0.0,
        "Variance R of one subspace's or block's measurement; 0 = from the Fisher information "
        "(joint_map always takes what the block itself tells)",
        unit="deg^2",
        minimum=0.0,
    )
    fused_variance: str = parameter(
        "correlated",
        "Variance of the fused measurement: adjacent subspaces correlated, or R / P (independent)",
        choices=("correlated", "independent"),
    )
    lag_correction: bool = parameter(
        True,
        "Take a measurement for the angle at the mean age of its snapshots instead of the sample "
        "time (only with the variance from the Fisher information: a given R covers the lag)",
    )
    phase_reference: str = parameter(
        "array_centre",
        "Point of zero phase of the steering vectors; with the first element innovations shrink "
        "when the residual is large (the published tracker)",
        choices=("first_element", "array_centre"),
    )
    first_id: int = parameter(1, "Identifier of the first track", minimum=1)

    @property
    def variance_from_data(self) -> bool:
        """Whether the measurement variance is computed from the data."""
        return self.measurement_variance_deg2 == 0.0

    @property
    def process_noise_density(self) -> float:
        """Spectral density q in rad^2/s^3."""
        return self.process_noise_deg2 * SQUARE_DEGREE

    @property
    def steady_process_noise_density(self) -> float:
        """Spectral density while the bearing moves steadily, rad^2/s^3."""
        steady = min(self.steady_process_noise_deg2, self.process_noise_deg2)
        return steady * SQUARE_DEGREE

    @property
    def ends_tracks(self) -> bool:
        """Whether tracks end when their source stays away.

        Not with given bearings, nor in the published trackers, whose measurement variance is given
        and whose number of targets is that of the columns of the subspace.
        """
        published = not self.needs_covariance and not self.variance_from_data
        return self.start == "automatic" and not published

    @property
    def entry(self) -> BearingMethodEntry:
        """What is known of the method."""
        return BEARING_METHODS[self.method]

    @property
    def needs_covariance(self) -> bool:
        """Whether the method measures in the block covariance and not in the subspaces."""
        return self.entry.needs_covariance


def check_configuration(configuration: BearingTrackerConfiguration) -> None:
    """Refuse parameters that do not fit together.

    Raises
    ------
    ConfigurationError
        With a sentence that names the parameters.
    """
    angles, rates = configuration.initial_bearings_deg, configuration.initial_rates_deg
    if configuration.start == "automatic":
        if angles or rates:
            raise ConfigurationError(
                "initial_bearings_deg and initial_rates_deg need start = given; with "
                "start = automatic leave them empty."
            )
        return
    if not angles:
        raise ConfigurationError(
            "start is given but initial_bearings_deg is empty; give the first bearings, or set "
            "start = automatic."
        )
    if len(angles) != len(rates):
        raise ConfigurationError(
            f"initial_bearings_deg has {len(angles)} entries but initial_rates_deg has "
            f"{len(rates)}; give one rate for each bearing."
        )


def check_estimator(tracker: BearingTrackerConfiguration, estimator: SubspaceConfiguration) -> None:
    """Refuse a subspace estimator that does not give what the tracker measures in.

    Raises
    ------
    ConfigurationError
        With a sentence that names both parameters.
    """
    if not tracker.needs_covariance:
        return
    if not estimator.entry.of_covariance:
        raise ConfigurationError(
            f"bearing_tracker.method {tracker.method} needs subspace_estimator.method "
            f"{subspace_methods_of_covariance()}, but that is {estimator.method}; set one of them "
            "to fit the other."
        )
    if estimator.covariance_snapshots == 0:
        raise ConfigurationError(
            f"bearing_tracker.method {tracker.method} measures in the sample covariance; set "
            "subspace_estimator.covariance_snapshots above zero."
        )


def subspace_methods_of_covariance() -> str:
    """Return the names of the subspace methods in whose covariance a tracker may measure."""
    return " or ".join(SUBSPACE_METHODS.names_with("of_covariance"))
