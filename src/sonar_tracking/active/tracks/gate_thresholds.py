"""The detection threshold in each gate: the loop from the tracker back to detection.

In the gate of a confirmed track the false-alarm probability is the one of least expected error for
that gate's number of resolution cells; candidates take the search threshold. Both only raise the
threshold of the detector. A higher threshold means less clutter and less detection in that gate.

References
----------
Jung, Shin (2002), equation 25.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

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
from sonar_tracking.active.tracks.scene_rows import SceneRows, joined
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
    tracks: SceneRows,
    gates: TrackGates,
    models: Sequence[DetectionModel],
    configuration: ContactTrackerConfiguration,
    stamps: tuple[int, int],
) -> list[AppliedThresholds]:
    """Return the thresholds in force in each scene.

    Parameters
    ----------
    bank : TrackBank
        Predicted tracks.
    tracks : SceneRows
        Whose they are.
    gates : TrackGates
        Their gates.
    models : sequence of DetectionModel
        Of the ping in each scene.
    configuration : ContactTrackerConfiguration
        Which thresholds are wanted; :func:`check_thresholds` has passed.
    stamps : tuple of int
        Of the ping and of the next one, ns.
    """
    cell_size = tracks.spread([model.cell_size for model in models])
    cells = gates.volume / (cell_size * np.maximum(gates.distance, 1.0))
    found = joined([mean_probability(own) for own in tracks.split(bank.detection_weight)])
    in_force = _as_detected(tracks, models, found)
    if _wanted(configuration):
        in_force = _as_wanted(bank, tracks, models, configuration, cells, found)
    published = _published(bank, tracks, gates, models, cells, in_force, stamps)
    return [
        AppliedThresholds(threshold, detection, share, search.threshold, search.share, told)
        for threshold, detection, share, search, told in zip(
            tracks.split(in_force.threshold),
            tracks.split(in_force.detection_probability),
            tracks.split(in_force.clutter_share),
            in_force.search,
            published,
            strict=True,
        )
    ]


@dataclass(frozen=True)
class _Search:
    """What holds outside the gates of a scene."""

    probability: float
    threshold: float
    share: float


@dataclass(frozen=True)
class _InForce:
    """The same for all tracks of all scenes, shape (n,), and for the search in each scene."""

    probability: FloatArray
    threshold: FloatArray
    detection_probability: FloatArray
    clutter_share: FloatArray
    search: Sequence[_Search]
    method: str


def _as_detected(
    tracks: SceneRows, models: Sequence[DetectionModel], found: FloatArray
) -> _InForce:
    return _InForce(
        probability=_filled(tracks, [model.false_alarm_probability for model in models]),
        threshold=_filled(tracks, [model.threshold for model in models]),
        detection_probability=found,
        clutter_share=np.ones(len(found)),
        search=[_Search(m.false_alarm_probability, m.threshold, 1.0) for m in models],
        method=AS_DETECTED,
    )


def _as_wanted(
    bank: TrackBank,
    tracks: SceneRows,
    models: Sequence[DetectionModel],
    configuration: ContactTrackerConfiguration,
    cells: FloatArray,
    found: FloatArray,
) -> _InForce:
    in_gates: GateProbability = configuration.gate_threshold_entry.make(configuration)
    scenes = zip(tracks.split(cells), models, strict=True)
    wanted = joined([in_gates(own, model) for own, model in scenes])
    search = [_search_probability(configuration, model) for model in models]
    probability = np.where(bank.confirmed, wanted, tracks.spread(search))
    bases = [model.false_alarm_probability for model in models]
    base = tracks.spread(bases)
    ratio = tracks.spread([model.signal_to_noise_ratio_linear for model in models])
    # What is found of P_D is that of the detector; a higher threshold leaves a share of it.
    left = detection_probability(probability, ratio) / detection_probability(base, ratio)
    return _InForce(
        probability=probability,
        threshold=detection_threshold(probability),
        detection_probability=found * left,
        clutter_share=probability / base,
        search=[
            _Search(own, -float(np.log(own)), own / detected)
            for own, detected in zip(search, bases, strict=True)
        ],
        method=configuration.gate_threshold,
    )


def _published(
    bank: TrackBank,
    tracks: SceneRows,
    gates: TrackGates,
    models: Sequence[DetectionModel],
    cells: FloatArray,
    in_force: _InForce,
    stamps: tuple[int, int],
) -> list[GateThresholds]:
    """Return what is told of the gates of the confirmed tracks of each scene."""
    rows = np.flatnonzero(bank.confirmed)
    confirmed = tracks.of(rows)
    ratios = [model.signal_to_noise_ratio_linear for model in models]
    columns = {
        "track_id": bank.id,
        "false_alarm_probability": in_force.probability,
        "threshold": in_force.threshold,
        "resolution_cells": cells,
        "gate_volume": gates.volume,
        "predicted_position": gates.centre,
        "gate_covariance": gates.covariance,
    }
    told = {name: confirmed.split(column[rows]) for name, column in columns.items()}
    told["signal_to_noise_ratio_linear"] = confirmed.split(_filled(confirmed, ratios))
    return [
        GateThresholds(
            stamp=stamps[0],
            next_stamp=stamps[1],
            search_false_alarm_probability=search.probability,
            search_threshold=search.threshold,
            method=in_force.method,
            **dict(zip(told, own, strict=True)),
        )
        for search, own in zip(in_force.search, zip(*told.values(), strict=True), strict=True)
    ]


def _filled(rows: SceneRows, values: Sequence[float]) -> FloatArray:
    """Return the value of each scene at all of its rows."""
    return np.asarray(np.repeat(values, rows.counts))


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
