"""Protects what is concluded of misalignments from what bearings tell: by answers by hand."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.alignment.shared_alignment import AlignmentInformation, no_information
from sonar_tracking.tma.targets.misaligned_stations import (
    ALIGNED,
    ODDS_AGAINST,
    UsedAlignment,
    misalignments,
)
from sonar_tracking.tma.targets.target_records import TargetObservation

PRIOR, LASTING = 0.04**2, 0.01**2


def measured(value: float, deviation: float) -> AlignmentInformation:
    """Return what a measurement of the misalignment of the only station tells."""
    return AlignmentInformation(np.array([[deviation**-2]]), np.array([value * deviation**-2]))


def test_what_is_not_observed_stays_as_it_was_before() -> None:
    """Aligned to 0.01 with 10 to 1, else to 0.04."""
    found = misalignments(no_information(1), PRIOR, LASTING)
    assert found.aligned == pytest.approx(ODDS_AGAINST / (1.0 + ODDS_AGAINST))
    assert not found.found
    assert found.mean == pytest.approx([0.0])
    by_hand = (ODDS_AGAINST * LASTING + PRIOR) / (1.0 + ODDS_AGAINST)
    assert found.covariance[0, 0] == pytest.approx(by_hand)


def test_a_misalignment_that_is_measured_is_found() -> None:
    """The odds are those of the densities of the measurement, with the misalignment and without."""
    value, variance = 0.03, 0.004**2
    found = misalignments(measured(value, 0.004), PRIOR, LASTING)
    with_it = np.exp(-0.5 * value**2 / (PRIOR + variance)) / np.sqrt(PRIOR + variance)
    without = np.exp(-0.5 * value**2 / variance) / np.sqrt(variance)
    odds = with_it / without / ODDS_AGAINST
    assert found.aligned == pytest.approx(1.0 / (1.0 + odds))
    assert found.found
    assert found.mean == pytest.approx([value * PRIOR / (PRIOR + variance)])
    assert found.deviation == pytest.approx([(1.0 / variance + 1.0 / PRIOR) ** -0.5])


def test_a_measurement_of_an_aligned_station_leaves_it_aligned() -> None:
    found = misalignments(measured(0.004, 0.004), PRIOR, LASTING)
    assert not found.found and found.aligned > 0.98
    assert abs(found.mean[0]) < 1e-4


def test_two_stations_that_only_disagree_may_either_be_turned() -> None:
    """The first is turned by 0.03, the second by -0.03, or both by halves of it."""
    sight = np.array([1.0, -1.0])
    told = AlignmentInformation(np.outer(sight, sight) / 1e-6, 0.03 * sight / 1e-6)
    found = misalignments(told, PRIOR, LASTING)
    assert found.found
    assert found.mean == pytest.approx([0.015, -0.015], rel=0.05)
    assert np.all(found.deviation > 0.01)
    disagreement = sight @ found.covariance @ sight
    assert disagreement < 0.5 * np.trace(found.covariance)


def test_only_those_found_are_corrected() -> None:
    told = TargetObservation(1, "pier", (0.0, 0.0), (0.0, 0.0), (1.0, -1.0), 1e-4)
    used = UsedAlignment(("pier",), np.array([0.02]), np.array([[1e-6]]))
    assert used.corrected(told).azimuths == pytest.approx((1.02, -0.98))
    assert ALIGNED.corrected(told) is told
    assert ALIGNED.spread(["pier"], 0.01) is None
    assert used.spread(["buoy", "pier"], 0.01) == pytest.approx(np.diag([1e-4, 1e-6]))
