"""Protects who is who: two ships side by side are told apart by both choices, not one by one."""

from __future__ import annotations

import numpy as np

from sonar_tracking.fusion.joint_decisions import spoken_for, sure_pairs

LEAST, MARGIN = 4.0, 3.0


def test_two_ships_side_by_side_are_decided_together() -> None:
    """By hand: 18 + 21 against 19 + 12, though no bearing track prefers either by 3."""
    evidence = np.array([[18.0, 19.0], [12.0, 21.0]])
    assert sorted(sure_pairs(evidence, LEAST, MARGIN)) == [(0, 0), (1, 1)]


def test_both_are_heard_before_it_is_known_who_is_who() -> None:
    evidence = np.array([[15.0, 15.5], [15.0, 15.0]])
    assert sure_pairs(evidence, LEAST, MARGIN) == []
    assert spoken_for(evidence, MARGIN).tolist() == [0, 1]


def test_two_bearing_tracks_of_one_target_are_not_both_its() -> None:
    evidence = np.array([[10.0, 9.0]])
    assert sure_pairs(evidence, LEAST, MARGIN) == []
    assert spoken_for(evidence, MARGIN).size == 0
    assert sure_pairs(np.array([[10.0, 6.0]]), LEAST, MARGIN) == [(0, 0)]


def test_nothing_is_sure_of_what_chance_explains() -> None:
    evidence = np.array([[3.9, -np.inf], [-2.0, -np.inf]])
    assert sure_pairs(evidence, LEAST, MARGIN) == []
    assert spoken_for(np.empty((0, 0)), MARGIN).size == 0
