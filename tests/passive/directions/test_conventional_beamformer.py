"""A beam must give the power of a plane wave in its own direction, and less elsewhere."""

from __future__ import annotations

import numpy as np

from sonar_tracking.geometry import line_array, steering_vectors
from sonar_tracking.passive.directions.conventional_beamformer import beam_powers


def test_a_plane_wave_has_its_power_in_its_own_beam_and_a_null_one_beamwidth_away() -> None:
    positions, number = line_array(8, 0.5), 2 * np.pi
    snapshots = 2.0 * steering_vectors(positions, np.array([0.3]), number).T
    # The first null of 8 elements at half a wavelength lies 2 / 8 away in sin(theta).
    angles = np.array([0.3, np.arcsin(np.sin(0.3) + 0.25), -0.3])
    powers = beam_powers(snapshots, positions, angles, number)
    np.testing.assert_allclose(powers[:2], [4.0, 0.0], atol=1e-12)
    assert powers[2] < 0.5
