"""Protects the motion model, by hand."""

from __future__ import annotations

import pytest

from sonar_tracking.filtering.constant_velocity import (
    in_plane,
    process_noise_matrix,
    transition_matrix,
)


def test_motion_of_two_seconds() -> None:
    assert transition_matrix(2.0).tolist() == [[1.0, 2.0], [0.0, 1.0]]
    # 3 [[8 / 3, 2], [2, 2]]
    assert process_noise_matrix(3.0, 2.0).ravel().tolist() == pytest.approx([8.0, 6.0, 6.0, 6.0])


def test_noise_of_two_intervals_is_that_of_both_together() -> None:
    step, whole = transition_matrix(0.75), process_noise_matrix(2.0, 2.0)
    in_two = step @ process_noise_matrix(2.0, 1.25) @ step.T + process_noise_matrix(2.0, 0.75)
    assert in_two == pytest.approx(whole)


def test_both_axes_of_a_plane_move_alike_and_apart() -> None:
    state = in_plane(transition_matrix(2.0)) @ [10.0, 20.0, 1.0, -3.0]
    assert state.tolist() == [12.0, 14.0, 1.0, -3.0]
