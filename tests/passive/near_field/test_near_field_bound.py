"""The information of bearings and ranges is that of the steering vectors' own differences."""

from __future__ import annotations

import numpy as np

from sonar_tracking.geometry import line_array
from sonar_tracking.passive.near_field.near_field_bound import near_field_information
from sonar_tracking.passive.near_field.spherical_steering import spherical_vectors
from sonar_tracking.records.arrays import ComplexArray

POSITIONS = line_array(9, 0.5)
WAVENUMBER = 2.0 * np.pi


def vector(angle: float, distance: float) -> ComplexArray:
    return spherical_vectors(POSITIONS, np.array([angle]), np.array([1.0 / distance]), WAVENUMBER)[
        :, 0
    ]


def test_angle_and_range_go_together_with_the_right_sign() -> None:
    """J by hand for one source: differences of the vector by angle and by range, not curvature."""
    angle, distance, power, noise, snapshots = 0.4, 6.0, 3.0, 0.5, 40.0
    step = 1e-6
    slopes = np.stack(
        [
            (vector(angle + step, distance) - vector(angle - step, distance)) / (2.0 * step),
            (vector(angle, distance + step) - vector(angle, distance - step)) / (2.0 * step),
        ],
        axis=1,
    )
    a = vector(angle, distance)
    gain = np.vdot(a, a).real
    outside = slopes - np.outer(a, a.conj() @ slopes) / gain
    signal = power * gain * power / (power * gain + noise)
    expected = 2.0 * snapshots / noise * signal * (outside.conj().T @ outside).real
    found = near_field_information(
        POSITIONS,
        np.array([angle]),
        np.array([distance]),
        WAVENUMBER,
        np.array([[power + 0j]]),
        noise,
        snapshots,
    )
    assert np.allclose(found, expected, rtol=1e-5)
    assert abs(expected[0, 1]) > 1e-3 * np.sqrt(expected[0, 0] * expected[1, 1])
