"""Protects what is learnt of motion: changes are weighed by the inverse of the process noise."""

import numpy as np

from sonar_tracking.tma.batch.learnt_variances import squared_changes, unit_noise
from sonar_tracking.tma.batch.linear_smoother import SmoothedStates


def test_changes_are_those_of_the_matrices_written_out() -> None:
    generator = np.random.default_rng(3)
    elapsed, moved = np.array([0.5, 2.0, 7.0]), np.array([0, 1, 3])
    root = generator.standard_normal((5, 6, 6))
    states = SmoothedStates(
        generator.standard_normal((5, 6)),
        root @ np.swapaxes(root, -1, -2),
        generator.standard_normal((4, 6, 6)),
        0.0,
    )
    transition = np.tile(np.eye(4), (3, 1, 1))
    transition[:, 0, 2] = transition[:, 1, 3] = elapsed
    mean, covariance = states.mean[:, :4], states.covariance[:, :4, :4]
    change = mean[moved + 1] - (transition @ mean[moved, :, None])[..., 0]
    crossed = transition @ states.crossed[moved, :4, :4]
    spread = covariance[moved + 1] - crossed - np.swapaxes(crossed, -1, -2)
    spread += transition @ covariance[moved] @ np.swapaxes(transition, -1, -2)
    inverse = np.linalg.inv(unit_noise(elapsed))
    squared, left = squared_changes(states, moved, elapsed)
    np.testing.assert_allclose(squared, np.einsum("ni,nij,nj->n", change, inverse, change))
    np.testing.assert_allclose(left, np.einsum("nij,nji->n", inverse, spread))
