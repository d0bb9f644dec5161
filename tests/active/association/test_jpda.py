"""Protects: joint association is what listing all events gives; crowds fall back."""

import numpy as np
import pytest

from sonar_tracking.active.association.jpda import associate_jointly


def test_joint_association_agrees_with_listing_all_events() -> None:
    ratios, missed = np.array([[2.0, 0.5], [1.5, 0.0]]), 0.1
    events = {
        (-1, -1): missed * missed,
        (0, -1): 2.0 * missed,
        (1, -1): 0.5 * missed,
        (-1, 0): missed * 1.5,
        (1, 0): 0.5 * 1.5,
    }
    total = sum(events.values())
    expected = np.zeros((2, 2))
    for chosen, weight in events.items():
        for track, contact in enumerate(chosen):
            if contact >= 0:
                expected[track, contact] += weight / total
    assert associate_jointly(ratios, missed) == pytest.approx(expected)


def test_joint_association_of_crowds_falls_back() -> None:
    ratios = np.full((8, 30), 0.1)
    probabilities = associate_jointly(ratios, 0.5)
    assert np.sum(probabilities, axis=1) == pytest.approx(np.full(8, 3.0 / 3.5))
    assert associate_jointly(np.zeros((0, 3)), 0.1).shape == (0, 3)
