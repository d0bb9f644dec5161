"""The methods that track bearings."""

from __future__ import annotations

from dataclasses import dataclass

from sonar_tracking.method_registry import MethodEntry, MethodRegistry, trait

_HERE = "sonar_tracking.passive.bearings"


@dataclass(frozen=True)
class BearingMethodEntry(MethodEntry):
    """A method that tracks bearings.

    Its factory takes a :class:`~sonar_tracking.passive.bearings.bearing_tracker_configuration.\
BearingTrackerConfiguration` and returns
    :class:`~sonar_tracking.passive.bearings.bearing_filters.BearingFilters`.

    Attributes
    ----------
    needs_covariance : bool
        Measures in the block covariance and not in the subspaces.
    holds_faint : bool
        Follows sources so faint that no covariance shows them by itself.
    """

    needs_covariance: bool = trait("measures in the covariance of the subspace estimator")
    holds_faint: bool = trait("follows sources that no single covariance shows")


BEARING_METHODS = MethodRegistry(
    "bearing_tracker.method",
    BearingMethodEntry(
        "ryu",
        f"{_HERE}.independent_filters:one_subspace_filters",
        "one filter a target, measured in the one subspace at the sample time",
        label="Ryu",
        paper="Ryu, Park, Choi 2003",
    ),
    BearingMethodEntry(
        "ml_fusion",
        f"{_HERE}.independent_filters:fused_subspace_filters",
        "one filter a target, measured in all adjacent subspaces, fused",
        label="ML fusion",
        paper="Ryu, Park, Choi 2003",
    ),
    BearingMethodEntry(
        "coherent",
        f"{_HERE}.independent_filters:projection_filters",
        "one filter a target, measured by a fit to the block covariance, sources may be coherent",
        label="coherent",
        paper="Hwang, Kim, Kim, Park, Nam 2005",
        needs_covariance=True,
    ),
    BearingMethodEntry(
        "joint_map",
        f"{_HERE}.joint_map_filters:JointMapFilters",
        "one filter over all targets, updated with the likelihood of the block covariance",
        label="joint MAP",
        needs_covariance=True,
        holds_faint=True,
    ),
)
