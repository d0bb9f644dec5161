"""Is a block of snapshots usable: the checks before it may touch the recursion.

A block that cannot be used is rejected with a sentence that names the culprit and the remedy. A bad
element is left out by :mod:`sonar_tracking.passive.subspaces.channel_monitor`, as the others are
still good.
"""

from __future__ import annotations

import numpy as np

from sonar_tracking.errors import InputError, shown
from sonar_tracking.geometry import aperture, has_grating_lobes, largest_spacing, wavenumber
from sonar_tracking.passive.subspaces.array_checks import check_array
from sonar_tracking.records.bearings import ArraySnapshots

MAXIMUM_RELATIVE_BANDWIDTH = 0.1
"""Largest bandwidth * aperture / sound speed at which an array is narrowband."""


def check_first_block(block: ArraySnapshots, source_count: int) -> None:
    """Reject a run whose array or frequency cannot be used.

    Parameters
    ----------
    block : ArraySnapshots
        First block of the run.
    source_count : int
        Sources to be tracked; 0 = not known yet.

    Raises
    ------
    InputError
        With one sentence for the first thing that is wrong.
    """
    check_block(block)
    n_elements = len(block.element_positions)
    if n_elements < 2:
        raise InputError(f"The array has {n_elements} element; bearings need at least 2.")
    if source_count >= n_elements:
        raise InputError(
            f"source_count is {source_count} but the array has only {n_elements} elements; "
            f"give at most {n_elements - 1} sources."
        )
    _check_numbers(block)
    length = aperture(block.element_positions)
    relative = block.bandwidth * length / block.sound_speed
    if relative >= MAXIMUM_RELATIVE_BANDWIDTH:
        allowed = MAXIMUM_RELATIVE_BANDWIDTH * block.sound_speed / length
        raise InputError(
            f"The bandwidth of {block.bandwidth:g} Hz is too wide for an aperture of {length:g} m "
            f"(bandwidth * aperture / sound_speed is {relative:.3g}, it must be below "
            f"{MAXIMUM_RELATIVE_BANDWIDTH:g}); filter to less than {allowed:.3g} Hz."
        )
    if has_grating_lobes(
        block.element_positions, wavenumber(block.center_frequency, block.sound_speed)
    ):
        half = 0.5 * block.sound_speed / block.center_frequency
        raise InputError(
            f"The elements are {largest_spacing(block.element_positions):g} m apart, more than "
            f"half a wavelength ({half:g} m at {block.center_frequency:g} Hz), so that bearings "
            "alias; use a lower frequency or a denser array."
        )
    _check_noise_covariance(block)


def check_block(block: ArraySnapshots) -> None:
    """Reject a block with no or malformed samples.

    Raises
    ------
    InputError
        With one sentence for the first thing that is wrong.
    """
    positions = block.element_positions
    if positions.ndim != 2 or positions.shape[-1] != 3:
        raise InputError(
            f"element_positions has shape {positions.shape}; it must be (n_elements, 3)."
        )
    if block.data.ndim < 2 or block.data.shape[-1] != len(positions):
        raise InputError(
            f"The data have shape {block.data.shape} but the array has {len(positions)} elements; "
            "send one column for each element position."
        )
    if block.data.shape[-2] == 0:
        raise InputError("The block holds zero snapshots; send at least one.")
    finite = np.isfinite(block.data)
    if not finite.all():
        bad = np.argwhere(~finite)
        snapshot, element = bad[0][-2:]
        raise InputError(
            f"Element {element} of snapshot {snapshot} is not a finite number "
            f"({len(bad)} such samples in the block); the block is not used."
        )


def check_next_block(block: ArraySnapshots, first: ArraySnapshots) -> None:
    """Reject a block that is malformed, or of another array, frequency or rate than the first one.

    Raises
    ------
    InputError
        Naming what is wrong or what changed.
    """
    check_block(block)
    for name in ("sample_period", "center_frequency", "bandwidth", "sound_speed"):
        old, new = getattr(first, name), getattr(block, name)
        if old != new:
            raise InputError(
                f"{name} changed from {old:g} to {new:g} during the run; restart the node to "
                "track with other settings."
            )
    for name in ("element_positions", "noise_covariance"):
        old, new = getattr(first, name), getattr(block, name)
        if (old is None) != (new is None) or (old is not None and not np.array_equal(old, new)):
            raise InputError(
                f"{name} changed during the run; restart the node to track with another array."
            )
    if block.sensor.sensor_id != first.sensor.sensor_id:
        raise InputError(
            f"The block comes from sensor '{shown(block.sensor.sensor_id)}' but the run is of "
            f"sensor '{shown(first.sensor.sensor_id)}'; stop the second publisher."
        )
    if block.data.shape[:-2] != first.data.shape[:-2]:
        raise InputError(
            f"The data have batch shape {block.data.shape[:-2]}, before it was "
            f"{first.data.shape[:-2]}."
        )


def _check_numbers(block: ArraySnapshots) -> None:
    if not (np.isfinite(block.sample_period) and block.sample_period > 0.0):
        raise InputError(f"sample_period is {block.sample_period:g}; it must be above zero.")
    if not (np.isfinite(block.bandwidth) and block.bandwidth >= 0.0):
        raise InputError(f"bandwidth is {block.bandwidth:g} Hz; it must be zero or more.")
    check_array(block.element_positions, block.center_frequency, block.sound_speed)


def _check_noise_covariance(block: ArraySnapshots) -> None:
    covariance = block.noise_covariance
    if covariance is None:
        return
    n_elements = len(block.element_positions)
    if covariance.shape != (n_elements, n_elements):
        raise InputError(
            f"noise_covariance has shape {covariance.shape}; it must be "
            f"({n_elements}, {n_elements}), or empty for white noise."
        )
    hermitian = np.allclose(covariance, covariance.conj().T, atol=1e-9)
    trace = float(np.trace(covariance).real)
    if not hermitian or np.linalg.eigvalsh(covariance)[0] <= 0.0:
        raise InputError("noise_covariance is not Hermitian and positive definite.")
    if abs(trace - n_elements) > 1e-6 * n_elements:
        raise InputError(
            f"noise_covariance has trace {trace:g}; divide it so that the trace is {n_elements}."
        )
