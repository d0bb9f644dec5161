"""Protects the ranks of a target among clutter, by hand.

A target of SNR 1 has s = 1/2: P(rank l of m) = s B(s, m) Gamma(l - 1/2) / (Gamma(1/2) Gamma(l)).
"""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.active.detection.amplitude_order_statistics import (
    load_rank_probabilities,
    rank_probabilities,
    rank_probabilities_of,
)


def test_a_target_as_strong_as_its_clutter_may_have_any_rank() -> None:
    assert rank_probabilities(4, 0.0) == pytest.approx([0.25] * 4)


def test_a_target_of_twice_the_power() -> None:
    assert rank_probabilities(1, 1.0) == pytest.approx([1.0])
    assert rank_probabilities(2, 1.0) == pytest.approx([2.0 / 3.0, 1.0 / 3.0])
    assert rank_probabilities(3, 1.0) == pytest.approx([8.0 / 15.0, 4.0 / 15.0, 3.0 / 15.0])


def test_the_strongest_of_two_by_the_exponentials_themselves() -> None:
    """A target of mean 1 + SNR exceeds noise of mean 1 with probability (1 + SNR) / (2 + SNR)."""
    assert rank_probabilities(2, 9.0)[0] == pytest.approx(10.0 / 11.0)


def test_contacts_get_the_probability_of_their_rank() -> None:
    found = rank_probabilities_of(np.array([1.0, 5.0, 3.0]), 1.0)
    assert found == pytest.approx([3.0 / 15.0, 8.0 / 15.0, 4.0 / 15.0])
    assert rank_probabilities_of(np.array([2.0, 2.0]), 1.0) == pytest.approx([2.0 / 3.0, 1.0 / 3.0])
    assert rank_probabilities_of(np.array([1.0, np.nan, 3.0]), 1.0) == pytest.approx(
        [1.0 / 3.0] * 3
    )
    assert rank_probabilities_of(np.empty(0), 1.0).shape == (0,)


def test_what_is_kept_is_not_written_to() -> None:
    load_rank_probabilities()
    with pytest.raises(ValueError, match="read-only"):
        rank_probabilities(3, 1.0)[0] = 0.0
