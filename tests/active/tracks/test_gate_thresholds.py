"""Protects the thresholds in gates: which are in force, within which limits, and what is told."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.detection.detection_levels import mean_probability, weigh
from sonar_tracking.active.detection.detection_model import DetectionModel
from sonar_tracking.active.detection.detection_threshold import (
    FalseAlarmLimits,
    closed_form_false_alarm_probability,
)
from sonar_tracking.active.detection.gate_association import PROBABILITY_IN_GATE
from sonar_tracking.active.tracks.contact_gating import SensorGeometry, TrackGates, predict_gates
from sonar_tracking.active.tracks.gate_thresholds import (
    AppliedThresholds,
    apply_thresholds,
    check_thresholds,
)
from sonar_tracking.active.tracks.scene_rows import SceneRows
from sonar_tracking.active.tracks.track_bank import TrackBank
from sonar_tracking.errors import InputError
from tests.active.track_scene import bank_of

MODEL = DetectionModel(
    detection_probability=0.85,
    signal_to_noise_ratio_linear=10.0,
    averaged=False,
    outlier_share=0.0,
    threshold=3.0,
    false_alarm_probability=0.03,
    cell_size=2.0,
    uniform_density=np.nan,
    maximum_range=10_000.0,
)
BANK = replace(
    bank_of([[3000.0, 0.0], [0.0, 2000.0], [0.0, -500.0]]),
    confirmed=np.array([True, False, True]),
)
GATES: TrackGates = predict_gates(BANK, SensorGeometry(np.zeros(2), 20.0, 0.01, 1500.0))
CELLS = GATES.volume / (2.0 * GATES.distance)


def applied(model: DetectionModel = MODEL, **parameters: Any) -> AppliedThresholds:
    configuration = ContactTrackerConfiguration(**parameters)
    return in_force(BANK, GATES, model, configuration)


def in_force(
    bank: TrackBank,
    gates: TrackGates,
    model: DetectionModel,
    configuration: ContactTrackerConfiguration,
) -> AppliedThresholds:
    """Return the thresholds of one scene."""
    tracks = SceneRows((len(bank),))
    (found,) = apply_thresholds(bank, tracks, gates, [model], configuration, (7, 8))
    return found


def test_as_detected_leaves_the_detector_alone() -> None:
    thresholds = applied()
    assert thresholds.threshold.tolist() == [3.0] * 3
    assert thresholds.detection_probability.tolist() == [0.95] * 3
    assert thresholds.clutter_share.tolist() == [1.0] * 3
    assert (thresholds.search_threshold, thresholds.search_share) == (3.0, 1.0)
    assert thresholds.published.false_alarm_probability.tolist() == [0.03] * 2
    assert thresholds.published.threshold.tolist() == [3.0] * 2
    assert thresholds.published.search_threshold == 3.0


@pytest.mark.parametrize("parameters", [{}, {"gate_threshold": "closed_form"}])
def test_what_is_told_of_the_gates_of_confirmed_tracks(parameters: dict[str, Any]) -> None:
    published = applied(**parameters).published
    assert published.track_id.tolist() == [1, 3]
    assert published.resolution_cells == pytest.approx(CELLS[[0, 2]])
    assert published.gate_volume == pytest.approx(GATES.volume[[0, 2]])
    assert published.predicted_position == pytest.approx(GATES.centre[[0, 2]])
    assert published.gate_covariance == pytest.approx(GATES.covariance[[0, 2]])
    assert published.signal_to_noise_ratio_linear.tolist() == [10.0, 10.0]
    assert (published.stamp, published.next_stamp) == (7, 8)


def test_what_is_found_of_detection_is_not_forgotten_in_a_gate_with_a_threshold() -> None:
    """A ping weighs P_D at the detector's threshold, of which the gate's leaves a known share."""
    uneven = np.array([0.0, 0.5, 0.0, 0.0, 0.0, 0.5])
    bank = replace(BANK, detection_weight=np.tile(uneven, (3, 1)))
    configuration = ContactTrackerConfiguration(gate_threshold="fixed")
    detection = in_force(bank, GATES, MODEL, configuration).detection_probability
    left = (configuration.gate_false_alarm_probability / 0.03) ** (1.0 / 11.0)
    confirmed = detection[[0, 2]]
    assert confirmed == pytest.approx(0.625 * left)
    missed = 1.0 - confirmed * PROBABILITY_IN_GATE
    before = bank.detection_weight[[0, 2]]
    weights = weigh(before, mean_probability(before), missed)
    expected = 1.0 - np.array([0.3, 0.95]) * left * PROBABILITY_IN_GATE
    assert weights[0, [1, 5]] == pytest.approx(expected / np.sum(expected))


def test_a_search_threshold_alone_holds_in_gates_as_well() -> None:
    thresholds = applied(search_false_alarm_probability=0.01)
    assert thresholds.threshold == pytest.approx(np.full(3, np.log(100.0)))
    assert thresholds.clutter_share == pytest.approx(np.full(3, 1.0 / 3.0))
    assert thresholds.search_share == pytest.approx(1.0 / 3.0)
    assert thresholds.search_threshold == pytest.approx(np.log(100.0))
    # A detector that is stricter than what is asked for cannot be made less so.
    strict = applied(search_false_alarm_probability=0.2)
    assert strict.search_share == 1.0
    assert strict.threshold == pytest.approx(np.full(3, -np.log(0.03)))


def test_a_fixed_threshold_is_in_force_in_gates_of_confirmed_tracks() -> None:
    thresholds = applied(gate_threshold="fixed", gate_false_alarm_probability=0.003)
    assert thresholds.threshold == pytest.approx(-np.log([0.003, 0.03, 0.003]))
    assert thresholds.published.false_alarm_probability == pytest.approx([0.003, 0.003])
    assert thresholds.search_share == 1.0
    loose = applied(gate_threshold="fixed", gate_false_alarm_probability=0.3)
    assert loose.threshold == pytest.approx(np.full(3, -np.log(0.03)))


@pytest.mark.parametrize(("base", "lowest"), [(0.03, 1e-6), (1e-7, 5e-8)])
def test_the_closed_form_is_held_between_a_millionth_and_the_detector(
    base: float, lowest: float
) -> None:
    model = replace(MODEL, false_alarm_probability=base)
    probability = applied(model, gate_threshold="closed_form").published.false_alarm_probability
    limits = FalseAlarmLimits(lowest, base)
    expected = closed_form_false_alarm_probability(CELLS[[0, 2]], 10.0, limits)
    assert probability == pytest.approx(expected)
    crowded = replace(model, cell_size=1e-9)  # so many cells that the lower limit holds
    told = applied(crowded, gate_threshold="closed_form").published.false_alarm_probability
    assert told == pytest.approx([lowest] * 2)


def test_cells_next_to_the_sensor_are_no_smaller_than_at_a_metre() -> None:
    gates = replace(GATES, distance=np.array([0.1, 1.0, 2.0]))
    configuration = ContactTrackerConfiguration()
    published = in_force(BANK, gates, MODEL, configuration).published
    assert published.resolution_cells == pytest.approx(GATES.volume[[0, 2]] / [2.0, 4.0])


@pytest.mark.parametrize(
    ("changes", "known"),
    [
        ({}, True),
        ({"cell_size": np.nan}, False),
        ({"false_alarm_probability": np.nan}, False),
        ({"false_alarm_probability": 0.0}, False),
        ({"false_alarm_probability": 1.0}, False),
    ],
)
@pytest.mark.parametrize(
    "parameters",
    [
        {"gate_threshold": "fixed"},
        {"gate_threshold": "closed_form"},
        {"search_false_alarm_probability": 0.01},
    ],
)
def test_thresholds_that_are_wanted_but_cannot_be_set_are_refused(
    changes: dict[str, Any], known: bool, parameters: dict[str, Any]
) -> None:
    model = replace(MODEL, **changes)
    check_thresholds(model, ContactTrackerConfiguration())
    if known:
        check_thresholds(model, ContactTrackerConfiguration(**parameters))
        return
    with pytest.raises(InputError, match="range_resolution"):
        check_thresholds(model, ContactTrackerConfiguration(**parameters))
