"""How many eigenvectors of a block covariance are signal, and why there are none."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.errors import InputError, Severity
from sonar_tracking.passive.bearings.bearing_tracker_configuration import (
    BearingTrackerConfiguration,
)
from sonar_tracking.passive.bearings.covariance_subspace import covariance_subspace
from tests.passive.block_scene import INCOHERENT, exact_covariance
from tests.passive.estimate_scene import estimates_of

SEEN = exact_covariance(INCOHERENT)


@pytest.mark.parametrize(
    ("given", "found", "largest", "snapshots", "rank"),
    [
        (0, 2, 5, 100, 2),
        (0, 5, 3, 100, 3),  # no more than targets
        (0, -1, 5, 100, 2),  # not counted: the columns of the basis
        (0, 14, 20, 100, 14),
        (0, 15, 20, 100, 14),
        (0, 15, None, 100, 14),  # one eigenvector is noise
        (3, 1, 2, 100, 3),  # what is given is taken
        (3, 1, 2, 3, 2),  # of three snapshots
        (14, 1, 2, 100, 14),
        (0, 1, 5, 2, 1),
    ],
)
def test_rank(given: int, found: int, largest: int | None, snapshots: int, rank: int) -> None:
    configuration = BearingTrackerConfiguration(source_rank=given)
    estimates = estimates_of(SEEN, rank=found, covariance_snapshots=snapshots)
    subspace, notices = covariance_subspace(configuration, estimates, largest)
    assert subspace is not None
    assert (subspace.vectors.shape, notices) == ((15, rank), ())


@pytest.mark.parametrize(
    ("covariance", "found", "snapshots", "culprit"),
    [
        (None, 2, 100, "covariance"),
        (SEEN, 0, 100, "rank"),
        (SEEN, 2, 1, "rank"),
        (0.0 * SEEN, 2, 100, "rank"),
    ],
)
def test_without_signal_the_reason_is_told(
    covariance: np.ndarray | None, found: int, snapshots: int, culprit: str
) -> None:
    estimates = estimates_of(covariance, rank=found, covariance_snapshots=snapshots)
    subspace, notices = covariance_subspace(BearingTrackerConfiguration(), estimates, 5)
    assert subspace is None
    assert [(notice.severity, notice.culprit) for notice in notices] == [(Severity.WARN, culprit)]


def test_a_rank_that_leaves_no_noise_is_refused() -> None:
    configuration = BearingTrackerConfiguration(source_rank=15)
    with pytest.raises(InputError, match="only 15 elements; give at most 14"):
        covariance_subspace(configuration, estimates_of(SEEN), 5)
