"""Protects the counts of manoeuvres: each counts once, none that is merely possible."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.active.tracks.mode_changes import MEMORY, changes_after, pooled_changes

N_MODES = 4
STATIC, TURNING = 0, 3


def seen(turning: list[float], interval: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Return counts and times of a target that turns with a probability at each ping."""
    entered, calm = np.zeros((1, N_MODES)), np.zeros((1, N_MODES))
    shown = np.ones((1, N_MODES), dtype=bool)
    for probability in turning:
        modes = np.array([[0.0, 1.0 - probability, 0.0, probability]])
        entered, calm, shown = changes_after(modes, entered, calm, shown, interval, STATIC)
    return entered[0], calm[0]


def test_a_turn_counts_once_however_its_probability_wavers() -> None:
    entered, _ = seen([0.01, 0.3, 0.6, 0.4, 0.7, 0.9, 0.2, 0.6, 0.05])
    assert entered[TURNING] == pytest.approx(1.0, rel=0.01)
    twice, _ = seen([0.01, 0.6, 0.05, 0.6, 0.05])
    assert twice[TURNING] == pytest.approx(2.0, rel=0.01)


def test_what_is_merely_possible_at_every_ping_is_never_counted() -> None:
    entered, calm = seen([0.2] * 500)
    assert entered[TURNING] == 0.0
    assert calm[TURNING] == pytest.approx(0.8 * 500.0, rel=0.15)


def test_a_target_that_is_new_has_not_begun_what_it_does() -> None:
    assert seen([0.9, 0.9, 0.05])[0][TURNING] == 0.0


def test_nothing_begins_at_rest() -> None:
    modes = np.array([[0.75, 0.25, 0.0, 0.0]])
    nothing = np.zeros((1, N_MODES))
    calm = changes_after(modes, nothing, nothing, nothing > 0, 8.0, STATIC)[1]
    assert calm[0] == pytest.approx([0.0, 0.0, 2.0, 2.0])
    calm = changes_after(modes, nothing, nothing, nothing > 0, 8.0, None)[1]
    assert calm[0] == pytest.approx([0.0, 6.0, 8.0, 8.0])


def test_what_was_long_ago_is_forgotten() -> None:
    entered, calm = seen([0.05, 0.9] + [0.0] * 1000, interval=10.0)
    assert entered[TURNING] < np.exp(-5.0)
    assert calm[TURNING] == pytest.approx(MEMORY, rel=0.02)


def test_confirmed_targets_are_added_up() -> None:
    entered = np.array([[0.0, 0.0, 0.0, 2.0], [0.0, 0.0, 0.0, 9.0], [0.0, 0.0, 0.0, 1.0]])
    pooled = pooled_changes(entered, 100.0 * entered, np.array([True, False, True]))
    assert pooled[:, TURNING].tolist() == [3.0, 300.0]
