"""The detection threshold in each gate: the loop from the tracker back to detection.

In the gate of a confirmed track the false-alarm probability is the one of least expected error for
that gate's number of resolution cells; candidates take the search threshold. Both only raise the
threshold of the detector. A higher threshold means less clutter and less detection in that gate.

References
----------
Jung, Shin (2002), equation 25.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.contacts.gate_threshold_registry import AS_DETECTED
from sonar_tracking.active.detection.detection_levels import mean_probability
from sonar_tracking.active.detection.detection_model import DetectionModel
from sonar_tracking.active.detection.detection_threshold import (
    FalseAlarmLimits,
    closed_form_false_alarm_probability,
    detection_probability,
    detection_threshold,
)
from sonar_tracking.active.tracks.contact_gating import TrackGates
from sonar_tracking.active.tracks.track_bank import TrackBank
from sonar_tracking.errors import InputError
from sonar_tracking.records.arrays import FloatArray
from sonar_tracking.records.contacts import GateThresholds

SMALLEST_FALSE_ALARM_PROBABILITY = 1e-6

GateProbability = Callable[[FloatArray, DetectionModel], FloatArray]
"""Takes the resolution cells in each gate (n,) and what is known of the ping; returns the
false-alarm probability wanted in each gate (n,)."""


@dataclass(frozen=True)
class AppliedThresholds:
    """Thresholds in force, one a track and one for the search.

    Attributes
    ----------
    threshold, detection_probability : ndarray, shape (n,)
        tau (linear; NaN = unknown) and P_D of each track.
    clutter_share : ndarray, shape (n,)
        False contacts above the threshold relative to those of the detector, pure numbers.
    search_threshold, search_share : float
        The same for contacts outside the gates.
    published : GateThresholds
        For those who want to follow.
    """

    threshold: FloatArray
    detection_probability: FloatArray
    clutter_share: FloatArray
    search_threshold: float
    search_share: float
    published: GateThresholds


def apply_thresholds(
    bank: TrackBank,
    gates: TrackGates,
    model: DetectionModel,
    configuration: ContactTrackerConfiguration,
    stamp: int,
    next_stamp: int,
) -> AppliedThresholds:
    """Return the thresholds in force.

    Parameters
    ----------
    bank : TrackBank
        Predicted tracks.
    gates : TrackGates
        Their gates.
    model : DetectionModel
        Of the ping.
    configuration : ContactTrackerConfiguration
        Which thresholds are wanted; :func:`check_thresholds` has passed.
    stamp, next_stamp : int
        Of the ping, ns.
    """
    cells = gates.volume / (model.cell_size * np.maximum(gates.distance, 1.0))
    if not _wanted(configuration):
        return _as_detected(bank, gates, model, cells, (stamp, next_stamp))
    base = model.false_alarm_probability
    search = _search_probability(configuration, model)
    probability = np.full(len(bank), search)
    in_gates: GateProbability = configuration.gate_threshold_entry.make(configuration)
    probability = np.where(bank.confirmed, in_gates(cells, model), probability)
    threshold = detection_threshold(probability)
    ratio = model.signal_to_noise_ratio_linear
    # What is found of P_D is that of the detector; a higher threshold leaves a share of it.
    left = detection_probability(probability, ratio) / detection_probability(base, ratio)
    return AppliedThresholds(
        threshold=threshold,
        detection_probability=mean_probability(bank.detection_weight) * left,
        clutter_share=probability / base,
        search_threshold=-float(np.log(search)),
        search_share=search / base,
        published=GateThresholds(
            **_gates_of_confirmed(bank, gates, cells, ratio),
            stamp=stamp,
            next_stamp=next_stamp,
            false_alarm_probability=probability[bank.confirmed],
            threshold=threshold[bank.confirmed],
            search_false_alarm_probability=search,
            search_threshold=-float(np.log(search)),
            method=configuration.gate_threshold,
        ),
    )


def check_thresholds(model: DetectionModel, configuration: ContactTrackerConfiguration) -> None:
    """Refuse a ping in which thresholds are wanted but cannot be set.

    Raises
    ------
    InputError
        If the ping tells neither resolution nor false alarms.
    """
    known = np.isfinite(model.cell_size) and 0.0 < model.false_alarm_probability < 1.0
    if _wanted(configuration) and not known:
        raise InputError(
            "Thresholds in gates need range_resolution, azimuth_resolution and "
            f"false_alarm_probability of the ping; give them, or use gate_threshold {AS_DETECTED}."
        )


def _wanted(configuration: ContactTrackerConfiguration) -> bool:
    own_gates = configuration.gate_threshold_entry.sets_thresholds
    return own_gates or configuration.search_false_alarm_probability > 0.0


def _search_probability(configuration: ContactTrackerConfiguration, model: DetectionModel) -> float:
    base = model.false_alarm_probability
    return min(configuration.search_false_alarm_probability or base, base)


def _as_detected(
    bank: TrackBank,
    gates: TrackGates,
    model: DetectionModel,
    cells: FloatArray,
    stamps: tuple[int, int],
) -> AppliedThresholds:
    n_tracks, n_confirmed = len(bank), int(np.count_nonzero(bank.confirmed))
    ratio = model.signal_to_noise_ratio_linear
    return AppliedThresholds(
        threshold=np.full(n_tracks, model.threshold),
        detection_probability=mean_probability(bank.detection_weight),
        clutter_share=np.ones(n_tracks),
        search_threshold=model.threshold,
        search_share=1.0,
        published=GateThresholds(
            **_gates_of_confirmed(bank, gates, cells, ratio),
            stamp=stamps[0],
            next_stamp=stamps[1],
            false_alarm_probability=np.full(n_confirmed, model.false_alarm_probability),
            threshold=np.full(n_confirmed, model.threshold),
            search_false_alarm_probability=model.false_alarm_probability,
            search_threshold=model.threshold,
            method=AS_DETECTED,
        ),
    )


def _gates_of_confirmed(
    bank: TrackBank, gates: TrackGates, cells: FloatArray, ratio: float
) -> dict[str, Any]:
    """Return what describes the gates of the confirmed tracks, whatever their thresholds."""
    rows = np.flatnonzero(bank.confirmed)
    return {
        "track_id": bank.id[rows],
        "resolution_cells": cells[rows],
        "gate_volume": gates.volume[rows],
        "predicted_position": gates.centre[rows],
        "gate_covariance": gates.covariance[rows],
        "signal_to_noise_ratio_linear": np.full(len(rows), ratio),
    }


def as_outside_gates(configuration: ContactTrackerConfiguration) -> GateProbability:
    """Return the choice of the threshold that is in force outside the gates."""

    def probability(cells: FloatArray, model: DetectionModel) -> FloatArray:
        return np.full(len(cells), _search_probability(configuration, model))

    return probability


def fixed_probability(configuration: ContactTrackerConfiguration) -> GateProbability:
    """Return the choice of one false-alarm probability for all gates."""

    def probability(cells: FloatArray, model: DetectionModel) -> FloatArray:
        base = model.false_alarm_probability
        return np.full(len(cells), min(configuration.gate_false_alarm_probability, base))

    return probability


def closed_form_probability(configuration: ContactTrackerConfiguration) -> GateProbability:
    """Return the choice of the false-alarm probability of least expected error in each gate."""

    def probability(cells: FloatArray, model: DetectionModel) -> FloatArray:
        base = model.false_alarm_probability
        limits = FalseAlarmLimits(min(SMALLEST_FALSE_ALARM_PROBABILITY, 0.5 * base), base)
        ratio = model.signal_to_noise_ratio_linear
        return closed_form_false_alarm_probability(cells, ratio, limits)

    return probability
