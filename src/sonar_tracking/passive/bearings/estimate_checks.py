"""Are the subspaces of a sample time usable: the checks before they may touch the tracks."""

from __future__ import annotations

import numpy as np

from sonar_tracking.errors import InputError
from sonar_tracking.passive.directions.signal_subspace import noise_factor
from sonar_tracking.passive.subspaces.array_checks import check_array
from sonar_tracking.records.arrays import ComplexArray
from sonar_tracking.records.bearings import SubspaceEstimates


def check_estimates(estimates: SubspaceEstimates) -> None:
    """Reject estimates whose parts do not fit together, are not finite or no covariance of noise.

    Raises
    ------
    InputError
        With one sentence for the first thing that is wrong.
    """
    shape, n_elements = estimates.basis.shape, len(estimates.element_positions)
    if estimates.basis.ndim < 3 or shape[-2] != n_elements:
        raise InputError(
            f"The bases have shape {shape} but the array has {n_elements} elements; they must "
            "be (n_subspaces, n_elements, n_columns)."
        )
    if shape[-3] != len(estimates.time_offsets):
        raise InputError(
            f"There are {shape[-3]} subspaces but {len(estimates.time_offsets)} time offsets."
        )
    if shape[-3] > 0 and not 0 < shape[-1] < n_elements:
        raise InputError(
            f"The subspaces have {shape[-1]} columns; an array of {n_elements} elements needs "
            f"between 1 and {n_elements - 1}."
        )
    check_array(estimates.element_positions, estimates.center_frequency, estimates.sound_speed)
    if not np.isfinite(estimates.basis).all():
        raise InputError("A subspace holds values that are not finite numbers.")
    if estimates.covariance is not None and not np.isfinite(estimates.covariance).all():
        raise InputError("The covariance holds values that are not finite numbers.")
    if estimates.covariance is not None:
        _check_powers(estimates.covariance)
    noise = estimates.noise_covariance
    if noise is not None:
        if noise.shape != (n_elements, n_elements) or not np.isfinite(noise).all():
            raise InputError(
                f"The noise covariance has shape {noise.shape} or values that are not finite; it "
                f"must be {n_elements} by {n_elements} finite numbers."
            )
        noise_factor(noise)


def _check_powers(covariance: ComplexArray) -> None:
    """Refuse a covariance that no snapshots have."""
    powers = np.diagonal(covariance, axis1=-2, axis2=-1).real
    largest = float(powers.max())
    asymmetry = np.abs(covariance - covariance.conj().swapaxes(-2, -1)).max()
    if powers.min() < 0.0 or asymmetry > 1e-6 * largest:
        raise InputError(
            "The covariance is not Hermitian, or has a negative power on its diagonal; it must be "
            "the mean of products of snapshots."
        )
    if np.abs(covariance).max() > (1.0 + 1e-6) * largest:
        raise InputError(
            "The covariance of two elements exceeds the power of both; it must be the mean of "
            "products of snapshots."
        )
