"""The trackers that the doa-fusion study compares, with the parameters of the paper.

RYU takes one subspace a sample time, PROPOSED the fused measurement of seven and believes its
variance to be a seventh. Two trackers in between show which of the two changes matters: one that
averages but keeps the variance, and one that claims a seventh of the variance without averaging.

References
----------
Ryu, Park, Choi (2003), sections II-IV. Parameters that the paper leaves open (forgetting factor,
process noise, element spacing) are those under which its published figures are met.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sonar_tracking.evaluation.monte_carlo.compared_methods import compared_methods
from sonar_tracking.evaluation.monte_carlo.run_synthesis import true_bearings
from sonar_tracking.passive.bearings.bearing_method_registry import BEARING_METHODS
from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    BearingTrackerConfiguration,
)
from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration
from sonar_tracking.simulation.scenarios.scenario import Scenario

N_SUBSPACES = 7
FORGETTING_FACTOR = 0.86
PROCESS_NOISE_DEG2 = 1.0
SINGLE_VARIANCE_DEG2 = 36.0
INITIAL_ANGLE_VARIANCE_DEG2 = 6.0
INITIAL_RATE_VARIANCE_DEG2 = 1.0

RYU = "RYU"
PROPOSED = "PROPOSED"
AUTOMATIC = "automatic start"
AVERAGE_ONLY = "average only"
VARIANCE_ONLY = "R/7 only"
CORRELATED = "correlated variance"


@dataclass(frozen=True)
class FusionSystem:
    """One tracker of the study.

    Attributes
    ----------
    name : str
        In tables and figures.
    method : str
        ``ryu`` (one subspace) or ``ml_fusion`` (all).
    single_variance_deg2 : float
        R that the tracker believes one subspace to have, deg^2.
    fused_variance : str
        ``independent`` (the paper's equation 14) or ``correlated``.
    """

    name: str
    method: str
    single_variance_deg2: float
    fused_variance: str = "independent"


_NAMED = (
    FusionSystem(RYU, "ryu", SINGLE_VARIANCE_DEG2),
    FusionSystem(AVERAGE_ONLY, "ml_fusion", N_SUBSPACES * SINGLE_VARIANCE_DEG2),
    FusionSystem(VARIANCE_ONLY, "ryu", SINGLE_VARIANCE_DEG2 / N_SUBSPACES),
    FusionSystem(PROPOSED, "ml_fusion", SINGLE_VARIANCE_DEG2),
    FusionSystem(CORRELATED, "ml_fusion", SINGLE_VARIANCE_DEG2, "correlated"),
)
_METHODS = compared_methods(
    [entry for entry in BEARING_METHODS if not entry.needs_covariance],
    {system.name: system.method for system in _NAMED},
)

SYSTEMS = (
    *_NAMED,
    *(
        FusionSystem(name, method, SINGLE_VARIANCE_DEG2)
        for name, method in list(_METHODS.items())[len(_NAMED) :]
    ),
)
"""Trackers that start from the truth: all methods that measure in subspaces."""


def subspace_configuration(n_sources: int) -> SubspaceConfiguration:
    """Return the subspace estimator of all trackers: PAST, seven subspaces a second."""
    return SubspaceConfiguration(
        method="past",
        forgetting_factor=FORGETTING_FACTOR,
        period=1.0,
        source_count=n_sources,
        n_subspaces=N_SUBSPACES,
    )


def given_start_configuration(
    system: FusionSystem, scenario: Scenario
) -> BearingTrackerConfiguration:
    """Return the parameters of a tracker that starts from the true bearings at time 0.

    Parameters
    ----------
    system : FusionSystem
        The tracker.
    scenario : Scenario
        Whose targets it starts on.
    """
    angles, rates = true_bearings(scenario, np.zeros(1))
    return BearingTrackerConfiguration(
        method=system.method,
        start="given",
        initial_bearings_deg=tuple(np.degrees(angles[0]).tolist()),
        initial_rates_deg=tuple(np.degrees(rates[0]).tolist()),
        initial_angle_variance_deg2=INITIAL_ANGLE_VARIANCE_DEG2,
        initial_rate_variance_deg2=INITIAL_RATE_VARIANCE_DEG2,
        process_noise_deg2=PROCESS_NOISE_DEG2,
        measurement_variance_deg2=system.single_variance_deg2,
        fused_variance=system.fused_variance,
        phase_reference="first_element",
    )


def automatic_start_configuration() -> BearingTrackerConfiguration:
    """Return the parameters of PROPOSED when it has to find the bearings itself."""
    return BearingTrackerConfiguration(
        method="ml_fusion",
        start="automatic",
        process_noise_deg2=PROCESS_NOISE_DEG2,
        measurement_variance_deg2=SINGLE_VARIANCE_DEG2,
        fused_variance="independent",
        phase_reference="first_element",
    )
