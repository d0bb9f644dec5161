"""Protects the tracks from subspaces and covariances that no array and no sound can have."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.errors import InputError
from sonar_tracking.passive.bearings.estimate_checks import check_estimates, check_runs
from tests.passive.block_scene import noise_colour
from tests.passive.crossing_scene import POSITIONS
from tests.passive.estimate_scene import estimates_of

UNIT = np.eye(15, dtype=complex)
NAN_AT_ONE = np.where(np.arange(15) == 3, np.nan, 1.0)


def changed(row: int, column: int, value: complex) -> np.ndarray:
    """Return the covariance of unit noise with one entry changed."""
    covariance = UNIT.copy()
    covariance[row, column] = value
    return covariance


@pytest.mark.parametrize("n_columns", [1, 14])
def test_one_column_to_one_less_than_elements(n_columns: int) -> None:
    check_estimates(estimates_of(UNIT, basis=np.eye(15, n_columns)[None]))


def test_no_subspace_and_no_covariance_are_allowed() -> None:
    check_estimates(estimates_of(None, basis=np.empty((0, 15, 0)), time_offsets=np.empty(0)))
    check_estimates(estimates_of(0.0 * UNIT, noise_covariance=noise_colour(0.5)))


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"basis": np.eye(15, 2)}, "n_subspaces, n_elements, n_columns"),
        ({"basis": np.eye(14, 2)[None]}, "the array has 15 elements"),
        ({"basis": np.stack([np.eye(15, 2)] * 2)}, "2 subspaces but 1 time offsets"),
        ({"basis": np.eye(15, 0)[None]}, "between 1 and 14"),
        ({"basis": np.eye(15, 15)[None]}, "between 1 and 14"),
        ({"basis": np.diag(NAN_AT_ONE)[None, :, 3:5]}, "A subspace holds values"),
        ({"covariance": np.diag(NAN_AT_ONE)}, "The covariance holds values"),
        ({"element_positions": POSITIONS * NAN_AT_ONE[:, None]}, "element position"),
        ({"center_frequency": 0.0}, "center_frequency is 0"),
        ({"noise_covariance": np.eye(14)}, "15 by 15 finite numbers"),
        ({"noise_covariance": np.diag(NAN_AT_ONE)}, "15 by 15 finite numbers"),
        ({"noise_covariance": np.diag(-np.ones(15))}, "not positive definite"),
    ],
)
def test_parts_that_do_not_fit_are_refused(changes: dict[str, object], sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        check_estimates(replace(estimates_of(UNIT), **changes))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "covariance",
    [
        changed(4, 7, 0.2),  # without its mirror image
        changed(4, 4, 1.0 + 0.1j),  # a power is real
        changed(4, 4, -0.1),  # and not below zero
        changed(4, 7, 1.1e-6),
    ],
)
def test_a_covariance_is_hermitian_with_powers_on_its_diagonal(covariance: np.ndarray) -> None:
    with pytest.raises(InputError, match="not Hermitian, or has a negative power"):
        check_estimates(estimates_of(covariance))


@pytest.mark.parametrize(("entry", "refused"), [(1.0 + 0.9e-6, False), (1.0 + 1.1e-6, True)])
def test_two_elements_are_no_more_alike_than_the_same(entry: float, refused: bool) -> None:
    covariance = changed(4, 7, 1j * entry) + changed(7, 4, -1j * entry) - UNIT
    if refused:
        with pytest.raises(InputError, match="exceeds the power of both"):
            check_estimates(estimates_of(covariance))
    else:
        check_estimates(estimates_of(covariance))


def test_rounding_is_no_asymmetry() -> None:
    check_estimates(estimates_of(1e6 * changed(4, 7, 0.9e-6 + 0.0j)))


def test_the_runs_of_a_batch_are_checked_together() -> None:
    runs = np.stack([UNIT, 2.0 * UNIT, changed(3, 3, 0.0)])
    estimates = estimates_of(runs, basis=np.stack([np.eye(15, 2)[None]] * 3))
    check_estimates(estimates)
    with pytest.raises(InputError, match="negative power"):
        check_estimates(replace(estimates, covariance=np.stack([UNIT, UNIT, -0.1 * UNIT])))


def test_one_bad_run_of_several_is_refused_whether_they_are_alike_or_not() -> None:
    good, bad = estimates_of(UNIT), estimates_of(-0.1 * UNIT)
    other = replace(good, element_positions=good.element_positions.copy())
    check_runs([good, good, other])
    for runs in ([good, bad, good], [good, other, bad]):
        with pytest.raises(InputError, match="negative power"):
            check_runs(runs)
