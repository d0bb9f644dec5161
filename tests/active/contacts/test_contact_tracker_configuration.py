"""Protects the refusal of parameters that do not fit together, from both sides of each bound."""

from __future__ import annotations

import pytest

from sonar_tracking.active.contacts.contact_tracker_configuration import (
    ContactTrackerConfiguration,
    check_configuration,
)
from sonar_tracking.errors import ConfigurationError


@pytest.mark.parametrize(
    "values",
    [
        {},
        {"termination_probability": 0.89},
        {"initial_existence": 0.44},
        {"sound_speed": 0.0},
        {"sound_speed": 100.0},
        {"method": "smc_phd"},
        {"gate_threshold": "fixed"},
    ],
)
def test_parameters_that_fit_pass(values: dict[str, float]) -> None:
    check_configuration(ContactTrackerConfiguration(**values))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"termination_probability": 0.9}, "would end as it is confirmed"),
        ({"termination_probability": 0.95}, "would end as it is confirmed"),
        ({"initial_existence": 0.45}, "less than half"),
        ({"initial_existence": 0.5}, "less than half"),
        ({"sound_speed": 99.0}, "about 1500"),
        ({"sound_speed": 1e-6}, "about 1500"),
        ({"method": "smc_phd", "gate_threshold": "fixed"}, "needs gates"),
        ({"method": "roi_clustering", "gate_threshold": "closed_form"}, "needs gates"),
    ],
)
def test_parameters_that_do_not_fit_are_refused(values: dict[str, float], sentence: str) -> None:
    with pytest.raises(ConfigurationError, match=sentence):
        check_configuration(ContactTrackerConfiguration(**values))  # type: ignore[arg-type]
