"""Protects what a restart forgets: everything, the covariance, or the source frequencies."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.tma.estimators.bank_restart import (
    COVARIANCE,
    FULL,
    SOURCE_FREQUENCY,
    restart_bank,
)
from tests.tma.estimators.test_hypothesis_bank import random_bank

BANK = random_bank()
FRESH = replace(
    BANK,
    mean=BANK.mean + 7.0,
    covariance=2.0 * BANK.covariance,
    log_weight=BANK.log_weight[..., ::-1],
)
WHICH = np.array([False, True])


@pytest.mark.parametrize("policy", [FULL, COVARIANCE, SOURCE_FREQUENCY])
def test_a_run_that_is_not_restarted_stays_as_it_was(policy: str) -> None:
    restarted = restart_bank(BANK, FRESH, WHICH, policy)
    for name in ("mean", "covariance", "log_weight"):
        np.testing.assert_array_equal(getattr(restarted, name)[0], getattr(BANK, name)[0])
    assert restarted.known[0].all()


def test_a_full_restart_knows_nothing() -> None:
    restarted = restart_bank(BANK, FRESH, WHICH, FULL)
    for name in ("mean", "covariance", "log_weight"):
        np.testing.assert_array_equal(getattr(restarted, name)[1], getattr(FRESH, name)[1])
    assert not restarted.known[1].any()


def test_source_frequencies_alone_are_forgotten() -> None:
    restarted = restart_bank(BANK, FRESH, WHICH, SOURCE_FREQUENCY)
    np.testing.assert_array_equal(restarted.mean, BANK.mean)
    np.testing.assert_array_equal(restarted.covariance, BANK.covariance)
    assert restarted.known.tolist() == [[True, True], [False, False]]


def test_a_diffuse_covariance_around_what_was_estimated() -> None:
    restarted = restart_bank(BANK, FRESH, WHICH, COVARIANCE)
    np.testing.assert_array_equal(restarted.mean, BANK.mean)
    assert restarted.known.all()
    expected = FRESH.covariance[1].copy()
    for line in (4, 5):
        expected[:, line, line] = (BANK.mean[1, :, line] / 6.0) ** 2
    assert restarted.covariance[1] == pytest.approx(expected)
    np.testing.assert_array_equal(FRESH.covariance, 2.0 * BANK.covariance)
