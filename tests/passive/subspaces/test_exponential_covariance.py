"""Protects the weights of the exponential covariance, by hand."""

from __future__ import annotations

import numpy as np

from sonar_tracking.passive.subspaces.exponential_covariance import ExponentialCovariance
from sonar_tracking.passive.subspaces.subspace_configuration import SubspaceConfiguration

METHOD = ExponentialCovariance(0.5)


def test_the_newest_snapshot_weighs_most() -> None:
    """Halves of halves: 1 / 8, 1 / 4 and 1 / 2 of the products of three snapshots."""
    data = np.array([[4.0, 0.0], [0.0, 2.0], [1.0, 1.0j]])
    after = METHOD.update(METHOD.start(2, 1), data)
    assert after.covariance.tolist() == [[2.0 + 0.5, -0.5j], [0.5j, 1.0 + 0.5]]
    later = METHOD.update(after, np.array([[0.0, 0.0], [0.0, 2.0]]))
    assert later.covariance.tolist() == [[0.625, -0.125j], [0.125j, 0.375 + 2.0]]
    assert np.abs(METHOD.basis(later)[1, 0]) > 0.99
    assert METHOD.basis(later).shape == (2, 1)


def test_the_start_is_nothing_and_the_factor_is_the_configured_one() -> None:
    assert METHOD.start(3, 2, (4,)).covariance.tolist() == np.zeros((4, 3, 3)).tolist()
    configured = ExponentialCovariance.configured(SubspaceConfiguration(forgetting_factor=0.9))
    assert (configured.forgetting_factor, configured.update_snapshots) == (0.9, 1)
