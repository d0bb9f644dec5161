"""The methods that follow the signal subspace."""

from __future__ import annotations

from dataclasses import dataclass

from sonar_tracking.method_registry import MethodEntry, MethodRegistry, trait

_HERE = "sonar_tracking.passive.subspaces"


@dataclass(frozen=True)
class SubspaceMethodEntry(MethodEntry):
    """A method that follows the signal subspace.

    Its factory takes a :class:`~sonar_tracking.passive.subspaces.subspace_configuration.\
SubspaceConfiguration` and returns a
    :class:`~sonar_tracking.passive.subspaces.subspace_method.SubspaceMethod`.

    Attributes
    ----------
    snapshot_by_snapshot : bool
        Each snapshot is a step of its own: adjacent subspaces are one snapshot apart.
    of_covariance : bool
        Its columns are no limit to what is in the covariance that is published beside them:
        sources are counted on all of it, and bearing trackers may measure in it.
    """

    snapshot_by_snapshot: bool = trait("a step each snapshot")
    of_covariance: bool = trait("gives the covariance that some bearing trackers measure in")


SUBSPACE_METHODS = MethodRegistry(
    "subspace_estimator.method",
    SubspaceMethodEntry(
        "past",
        f"{_HERE}.past:Past.configured",
        "projection approximation subspace tracking",
        label="PAST",
        paper="Yang 1995",
        snapshot_by_snapshot=True,
    ),
    SubspaceMethodEntry(
        "opast",
        f"{_HERE}.orthonormal_past:OrthonormalPast.configured",
        "PAST whose basis stays orthonormal",
        label="OPAST",
        paper="Abed-Meraim, Chkeif, Hua 2000",
        snapshot_by_snapshot=True,
    ),
    SubspaceMethodEntry(
        "block_past",
        f"{_HERE}.block_past:BlockPast.configured",
        "PAST with one step for update_snapshots snapshots",
        label="block PAST",
        paper="Yang 1995",
    ),
    SubspaceMethodEntry(
        "covariance",
        f"{_HERE}.exponential_covariance:ExponentialCovariance.configured",
        "eigenvectors of an exponentially weighted covariance",
        label="covariance",
        of_covariance=True,
    ),
)
