"""Protects that a detector described wrongly loses its description and not its contacts."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sonar_tracking.active.contacts.ping_description import plausible_description
from sonar_tracking.records.contacts import Contacts


def ping(**description: Any) -> Contacts:
    return Contacts(
        stamp=1,
        range=np.array([1000.0]),
        azimuth=np.array([0.1]),
        amplitude=np.array([2.0]),
        range_standard_deviation=10.0,
        azimuth_standard_deviation=0.01,
        **description,
    )


@pytest.mark.parametrize(
    ("name", "possible", "impossible"),
    [
        ("detection_probability", (1e-3, 1.0), (0.0, -0.1, 1.01)),
        ("false_alarm_probability", (1e-12, 0.9), (0.0, 1.0, -0.1)),
        ("detection_threshold", (0.0, 1e4), (-0.1, 1e7, np.inf)),
        ("signal_to_noise_ratio_linear", (1e-2, 1e6), (0.0, -3.0, np.inf)),
        ("clutter_density", (0.0, 1.0), (-1e-9, 1e4, np.inf)),
        ("range_resolution", (1e-3, 1e4), (0.0, 1e7)),
        ("azimuth_resolution", (1e-6, 2.0 * np.pi), (0.0, 6.4)),
        ("minimum_range", (0.0, 1e4), (-1.0, 1e8)),
        ("maximum_range", (1.0, 1e7), (0.0, -5.0, 1e8)),
        ("azimuth_width", (1e-3, 2.0 * np.pi), (0.0, -1.0, 6.4)),
    ],
)
def test_what_cannot_be_true_is_unknown_and_named(
    name: str, possible: tuple[float, ...], impossible: tuple[float, ...]
) -> None:
    for value in possible:
        described, notices = plausible_description(ping(**{name: value}))
        assert getattr(described, name) == value
        assert notices == ()
    for value in impossible:
        described, notices = plausible_description(ping(**{name: value}))
        assert np.isnan(getattr(described, name))
        assert [notice.culprit for notice in notices] == [name]
        assert described.range.tolist() == [1000.0]


@pytest.mark.parametrize(("minimum", "kept"), [(4999.0, True), (5000.0, False), (6000.0, False)])
def test_a_survey_must_begin_before_it_ends(minimum: float, kept: bool) -> None:
    described, notices = plausible_description(ping(minimum_range=minimum, maximum_range=5000.0))
    assert np.isfinite(described.minimum_range) == kept
    assert described.maximum_range == 5000.0
    assert len(notices) == (0 if kept else 1)
