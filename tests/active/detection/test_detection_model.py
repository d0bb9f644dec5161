"""Protects what a ping is taken to say of detection, clutter and amplitudes, by hand."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.detection.detection_model import (
    SMALLEST_CLUTTER_DENSITY,
    DetectionModel,
    make_detection_model,
)
from sonar_tracking.active.detection.gate_association import amplitude_likelihood_ratio
from sonar_tracking.records.contacts import Contacts

DEFAULT = ContactTrackerConfiguration()
SECTOR: dict[str, Any] = {"minimum_range": 100.0, "maximum_range": 300.0, "azimuth_width": 0.5}
CELLS: dict[str, Any] = {
    "range_resolution": 10.0,
    "azimuth_resolution": 0.02,
    "false_alarm_probability": 1e-3,
}


def ping(count: int = 2, **changes: Any) -> Contacts:
    values: dict[str, Any] = {
        "stamp": 1,
        "range": np.linspace(150.0, 200.0, count),
        "azimuth": np.zeros(count),
        "amplitude": 5.0 + np.arange(count),
        "range_standard_deviation": 1.0,
        "azimuth_standard_deviation": 0.01,
    }
    return Contacts(**{**values, **changes})


def model(contacts: Contacts, **parameters: Any) -> DetectionModel:
    return make_detection_model(contacts, replace(DEFAULT, **parameters))[0]


def test_clutter_of_a_density_fills_the_sector_that_is_surveyed() -> None:
    # (300^2 - 100^2) / 2 * 0.5 = 20,000 m^2.
    told = model(ping(clutter_density=1e-3, **SECTOR))
    assert told.expected_clutter() == pytest.approx(20.0)
    assert told.clutter_density(np.array([1.0, 250.0])) == pytest.approx([1e-3, 1e-3])
    tripled = replace(told, clutter_factor=3.0)
    assert tripled.clutter_density(np.array([250.0])) == pytest.approx([3e-3])


def test_clutter_by_the_cell_thins_out_with_the_range() -> None:
    # 0.5 rad / 0.02 rad times 200 m / 10 m: 500 cells, 0.2 m rad each.
    told = model(ping(**CELLS, **SECTOR))
    assert told.expected_clutter() == pytest.approx(0.5)
    assert told.clutter_density(np.array([100.0, 200.0])) == pytest.approx([5e-5, 2.5e-5])
    assert told.clutter_density(np.array([0.0, 1.0])) == pytest.approx([5e-3, 5e-3])
    doubled = replace(told, clutter_factor=2.0)
    assert doubled.clutter_density(np.array([100.0])) == pytest.approx([1e-4])


def test_a_density_that_is_told_goes_before_cells() -> None:
    told = model(ping(clutter_density=1e-3, **CELLS, **SECTOR), clutter_density=7e-3)
    assert told.clutter_density(np.array([100.0])) == pytest.approx([1e-3])


def test_unknown_clutter_is_the_parameter_or_counted_over_the_survey() -> None:
    assert model(ping(**SECTOR), clutter_density=7e-3).uniform_density == 7e-3
    assert model(ping(4, **SECTOR)).uniform_density == pytest.approx(4.0 / 20_000.0)
    # Without a survey: all round, as far as the farthest contact, 200 m.
    assert model(ping(4)).uniform_density == pytest.approx(4.0 / (np.pi * 200.0**2))
    limited = model(ping(4), maximum_range=400.0)
    assert limited.uniform_density == pytest.approx(4.0 / (np.pi * 400.0**2))
    nothing = np.zeros(0)
    assert model(ping(0, range=nothing, amplitude=nothing)).uniform_density == (
        SMALLEST_CLUTTER_DENSITY
    )
    close = model(ping(1, range=np.array([0.1])))
    assert close.uniform_density == 1.0, "an area is at least a square metre"


@pytest.mark.parametrize("density", [0.0, 1e-20])
def test_no_clutter_at_all_is_not_believed(density: float) -> None:
    told, notices = make_detection_model(ping(clutter_density=density), DEFAULT)
    assert told.clutter_density(np.array([5.0])) == pytest.approx([SMALLEST_CLUTTER_DENSITY])
    assert len(notices) == (1 if density == 0.0 else 0)
    by_cell = replace(model(ping(**CELLS)), false_alarm_probability=0.0)
    assert by_cell.clutter_density(np.array([5.0])) == pytest.approx([SMALLEST_CLUTTER_DENSITY])


def test_what_the_ping_tells_goes_before_the_parameters() -> None:
    told = model(ping(detection_probability=0.7, signal_to_noise_ratio_linear=4.0))
    assert (told.detection_probability, told.signal_to_noise_ratio_linear) == (0.7, 4.0)
    given = model(ping(), detection_probability=0.6, signal_to_noise_ratio_db=20.0)
    assert (given.detection_probability, given.signal_to_noise_ratio_linear) == (0.6, 100.0)
    assert model(ping(detection_probability=1.0)).detection_probability == 0.999
    assert model(ping(detection_probability=1e-4)).detection_probability == 0.01


def test_the_threshold_is_told_or_follows_from_false_alarms_or_the_weakest_contact() -> None:
    assert model(ping(detection_threshold=3.0, false_alarm_probability=0.1)).threshold == 3.0
    assert model(ping(false_alarm_probability=0.1)).threshold == pytest.approx(np.log(10.0))
    assert model(ping(amplitude=np.array([6.0, 4.0]))).threshold == 4.0
    # No false alarms at all is what nobody has told, not an infinite threshold.
    unsaid = ping(false_alarm_probability=0.0, amplitude=np.array([6.0, 4.0]))
    assert model(unsaid).threshold == 4.0
    assert np.isnan(model(ping(amplitude=np.zeros(0))).threshold)


@pytest.mark.parametrize("share", [0.0, 0.01, 1.0])
def test_outliers_bound_what_an_amplitude_says(share: float) -> None:
    """Of false contacts a share has the amplitudes of targets: e / (1 - share + share e)."""
    told = model(ping(), signal_to_noise_ratio_db=10.0, outlier_share=share)
    amplitudes, thresholds = np.array([2.0, 30.0]), np.array([2.0, 5.0])
    plain = np.array([1.0, np.exp(25.0 * 10.0 / 11.0)]) / 11.0
    expected = plain / (1.0 - share + share * plain)
    assert told.amplitude_ratio(amplitudes, thresholds) == pytest.approx(expected)
    unknown = told.amplitude_ratio(np.array([np.nan, 5.0]), np.array([2.0, np.nan]))
    assert unknown.tolist() == [1.0, 1.0]


def test_an_unknown_ratio_is_averaged_over_3_to_20_decibels() -> None:
    told = model(ping(), outlier_share=0.0)
    levels = 10.0 ** (np.arange(3.0, 20.5) / 10.0)
    assert len(levels) == 18
    excess = np.array([4.0])
    expected = np.mean([amplitude_likelihood_ratio(excess, 0.0, level) for level in levels])
    assert told.amplitude_ratio(excess + 2.0, np.array([2.0])) == pytest.approx([expected])
    assert told.amplitude_ratio(np.array([6.0]), np.array([2.0])) != pytest.approx(
        model(ping(), signal_to_noise_ratio_db=10.0, outlier_share=0.0).amplitude_ratio(
            np.array([6.0]), np.array([2.0])
        )
    )
