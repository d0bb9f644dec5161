"""Protects: what is judged of a long line is the mean of its sub-arrays, in both directions."""

from __future__ import annotations

import numpy as np

from sonar_tracking.passive.array_fit.judged_covariance import judged_covariance
from tests.passive.crossing_scene import circular_noise


def test_sub_arrays_are_averaged_forward_and_backward() -> None:
    snapshots = circular_noise(np.random.default_rng(1), 30, 7) + 2.0j * np.arange(7)
    expected = np.zeros((3, 3), dtype=complex)
    for snapshot in snapshots:
        for own in (snapshot[:3], snapshot[3:6]):  # the seventh element is in neither
            for row in (own, own[::-1].conj()):
                expected += np.outer(row, row.conj()) / (4 * len(snapshots))
    np.testing.assert_allclose(judged_covariance(snapshots, 3), expected, rtol=1e-12)


def test_a_line_as_a_whole_has_its_sample_covariance() -> None:
    snapshots = circular_noise(np.random.default_rng(2), 30, 4)
    expected = np.einsum("ni,nj->ij", snapshots, snapshots.conj()) / 30
    np.testing.assert_allclose(judged_covariance(snapshots, 4), expected, rtol=1e-12)
