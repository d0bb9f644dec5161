"""Protects the density of false contacts over the distance: rings, claims, contradictions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sonar_tracking.active.detection.clutter_profile import (
    FORGETTING,
    RINGS,
    UNSEEN,
    ClutterProfile,
    ring_edges,
)
from sonar_tracking.active.detection.detection_model import DetectionModel

REACH = 6400.0
MODEL = DetectionModel(
    detection_probability=0.9,
    signal_to_noise_ratio_linear=10.0,
    averaged=False,
    outlier_share=0.01,
    threshold=3.0,
    false_alarm_probability=1e-3,
    cell_size=2.0,
    uniform_density=np.nan,
    maximum_range=REACH,
)
"""False contacts per cell: as many in each metre of the distance."""


def counted(distance: list[float], pings: int) -> ClutterProfile:
    profile, expected = ClutterProfile(), MODEL.expected_in_rings(REACH)
    for _ in range(pings):
        profile = profile.after(np.array(distance), expected, REACH)
    return profile


def test_rings_double_outwards_and_hold_all_that_is_expected() -> None:
    edges = ring_edges(REACH)
    assert edges[:3].tolist() == [0.0, 100.0, 200.0] and edges[-1] == REACH
    assert len(edges) == RINGS + 1
    per_cell = MODEL.expected_in_rings(REACH)
    assert per_cell == pytest.approx(2.0 * np.pi * 1e-3 / 2.0 * np.diff(edges))
    assert np.sum(per_cell) == pytest.approx(MODEL.expected_clutter())
    uniform = replace(MODEL, uniform_density=1e-6, minimum_range=150.0, sector=1.0)
    expected = uniform.expected_in_rings(REACH)
    assert expected[0] == 0.0
    assert expected[1] == pytest.approx(0.5e-6 * (200.0**2 - 150.0**2))
    assert np.sum(expected) == pytest.approx(uniform.expected_clutter())


def test_a_ring_with_clearly_more_than_its_share_gets_what_it_has() -> None:
    """The innermost ring expects 0.314 contacts a ping, and has four."""
    profile = counted([10.0, 40.0, 70.0, 99.0, 5000.0], 3)
    weights = 1.0 + FORGETTING + FORGETTING**2
    ratio = (4.0 * weights + UNSEEN) / (0.1 * np.pi * weights + UNSEEN)
    factor = profile.factor(np.array([0.0, 99.0, 101.0, 6000.0, 9000.0]))
    assert factor == pytest.approx([ratio, ratio, 1.0, 1.0, 1.0])
    dense = replace(MODEL, clutter_profile=profile)
    distance = np.array([50.0, 500.0])
    assert dense.clutter_density(distance) == pytest.approx(
        MODEL.clutter_density(distance) * [ratio, 1.0]
    )


def test_a_few_contacts_contradict_nothing() -> None:
    assert np.all(counted([10.0], 3).factor(np.array([10.0])) == 1.0)
    assert np.all(ClutterProfile().factor(np.array([10.0, 1e5])) == 1.0)


def test_with_another_reach_counting_begins_anew() -> None:
    profile = counted([10.0] * 9, 3)
    expected = MODEL.expected_in_rings(2.0 * REACH)
    longer = profile.after(np.zeros(0), expected, 2.0 * REACH)
    assert longer.reach == 2.0 * REACH
    assert np.all(longer.counted == 0.0) and np.array_equal(longer.expected, expected)
