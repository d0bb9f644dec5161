"""Are the subspaces of a sample time usable: the checks before they may touch the tracks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sonar_tracking.errors import InputError
from sonar_tracking.passive.directions.signal_subspace import noise_factor
from sonar_tracking.passive.sources.noise_of_windows import common_or_stacked
from sonar_tracking.passive.subspaces.array_checks import check_array
from sonar_tracking.records.arrays import ComplexArray
from sonar_tracking.records.bearings import SubspaceEstimates


def check_runs(estimates: Sequence[SubspaceEstimates]) -> None:
    """Reject the estimates of several runs, as :func:`check_estimates` does that of one.

    Parameters
    ----------
    estimates : sequence of SubspaceEstimates
        One a run; those of one array and of the same shapes are looked at in one go.

    Raises
    ------
    InputError
        With one sentence for the first thing that is wrong.
    """
    first = estimates[0]
    covariances = [each.covariance for each in estimates if each.covariance is not None]
    kinds = {
        (
            id(each.element_positions),
            each.center_frequency,
            each.sound_speed,
            each.basis.shape,
            each.time_offsets.shape,
            None if each.covariance is None else each.covariance.shape,
            None if each.noise_covariance is None else each.noise_covariance.shape,
        )
        for each in estimates
    }
    if len(estimates) == 1 or len(kinds) > 1:
        for each in estimates:
            check_estimates(each)
        return
    together = replace(
        first,
        basis=np.stack([each.basis for each in estimates]),
        covariance=np.stack(covariances) if covariances else None,
        noise_covariance=common_or_stacked([each.noise_covariance for each in estimates]),
    )
    check_estimates(together)


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
        if noise.shape[-2:] != (n_elements, n_elements) or not np.isfinite(noise).all():
            raise InputError(
                f"The noise covariance has shape {noise.shape} or values that are not finite; it "
                f"must be {n_elements} by {n_elements} finite numbers."
            )
        noise_factor(noise)


def _check_powers(covariance: ComplexArray) -> None:
    """Refuse a covariance that no snapshots have."""
    powers = np.diagonal(covariance, axis1=-2, axis2=-1).real
    largest = powers.max(axis=-1)
    asymmetry = np.abs(covariance - covariance.conj().swapaxes(-2, -1)).max(axis=(-2, -1))
    if powers.min() < 0.0 or (asymmetry > 1e-6 * largest).any():
        raise InputError(
            "The covariance is not Hermitian, or has a negative power on its diagonal; it must be "
            "the mean of products of snapshots."
        )
    if (np.abs(covariance).max(axis=(-2, -1)) > (1.0 + 1e-6) * largest).any():
        raise InputError(
            "The covariance of two elements exceeds the power of both; it must be the mean of "
            "products of snapshots."
        )
