"""Span of steering vectors: a projector, the pseudo-inverse, and both near a crossing."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.geometry import steering_pair, steering_vectors
from sonar_tracking.passive.directions.steering_span import steering_span
from tests.passive.crossing_scene import POSITIONS, WAVENUMBER, circular_noise

ANGLES = np.deg2rad([[-30.0, 2.0, 14.0], [0.0, 9.0, 50.0]])


def test_separated_vectors_have_the_ordinary_inverse_and_projector() -> None:
    vectors = steering_vectors(POSITIONS, ANGLES, WAVENUMBER)
    span = steering_span(vectors)
    columns = circular_noise(np.random.default_rng(1), 2, 15, 4)
    assert np.allclose(span.inverse, np.linalg.pinv(vectors))
    expected = columns - vectors @ (np.linalg.pinv(vectors) @ columns)
    assert np.allclose(span.outside(columns), expected)
    assert np.abs(span.outside(vectors)).max() < 1e-12


@pytest.mark.parametrize("separation", [1e-3, 1e-5, 1e-7])
def test_near_a_crossing_what_is_outside_keeps_its_accuracy(separation: float) -> None:
    # There the span is that of the vector and its derivative.
    angles = np.array([0.2 - 0.5 * separation, 0.2 + 0.5 * separation])
    span = steering_span(steering_vectors(POSITIONS, angles, WAVENUMBER))
    limit = np.concatenate(steering_pair(POSITIONS, np.array([0.2]), WAVENUMBER), axis=-1)
    second = POSITIONS[:, :1] ** 2 * limit[:, :1]
    expected = second - limit @ (np.linalg.pinv(limit) @ second)
    error = np.abs(span.outside(second) - expected).max()
    assert error < (1e-14 / separation + 10.0 * separation) * np.abs(second).max() + 1e-10


def test_at_a_crossing_two_vectors_are_one() -> None:
    twice = steering_vectors(POSITIONS, np.array([0.2, 0.2]), WAVENUMBER)
    span = steering_span(twice)
    once = steering_span(twice[:, :1])
    columns = circular_noise(np.random.default_rng(2), 15, 4)
    assert np.allclose(span.outside(columns), once.outside(columns))
    assert np.allclose(span.inverse, np.vstack([once.inverse, once.inverse]) / 2.0)
