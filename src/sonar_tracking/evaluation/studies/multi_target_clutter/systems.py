"""The trackers that the multi-target-clutter study compares, with the parameters of the paper.

What the paper leaves open is one set for all: initial existence 0.003 and its rule for candidates.
``integrated`` is also shown without its turning motion modes, and with the defaults of the package,
which are told nothing of the targets; the others are the paper's method in two versions and the two
it is compared with, clustering also with the published distance limit of 1.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from sonar_tracking.active.contacts.contact_method_registry import CONTACT_METHODS
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.contacts.gate_threshold_registry import GATE_THRESHOLDS
from sonar_tracking.evaluation.monte_carlo.compared_methods import compared_methods
from sonar_tracking.evaluation.studies.multi_target_clutter.scene import (
    ACCELERATION_DEVIATION,
    LATERAL_ACCELERATION,
)

INTEGRATED = "integrated"
INTEGRATED_STRAIGHT = "integrated, no turns"
INTEGRATED_DEFAULTS = "integrated, defaults"
HPDA_PARTICLE = "HPDA, particles"
HPDA_KALMAN = "HPDA, Kalman"
CLUSTERING = "clustering"
CLUSTERING_LITERAL = "clustering, limit 1"
PHD = "SMC-PHD"

KALMAN_ACCELERATION_DEVIATION = 0.008
"""Covers the turns, which a single straight motion mode does not know, m/s^2."""

SEARCH_FALSE_ALARM_PROBABILITY = 1e-3

_COMMON = ContactTrackerConfiguration(
    sound_speed=0.0,
    motion="turning",
    acceleration_deviation=ACCELERATION_DEVIATION,
    lateral_acceleration=LATERAL_ACCELERATION,
    initial_speed_deviation=1.5,
    detection_probability=0.9,
    signal_to_noise_ratio_db=10.0,
)
"""The paper tells its trackers how targets move; the contacts carry what differs from these."""

_DEFAULTS = ContactTrackerConfiguration(sound_speed=0.0)
_STRAIGHT = replace(
    _COMMON, motion="straight", acceleration_deviation=KALMAN_ACCELERATION_DEVIATION
)
_KALMAN = replace(
    _COMMON, method="hpda_kalman", acceleration_deviation=KALMAN_ACCELERATION_DEVIATION
)

_NAMED: Mapping[str, ContactTrackerConfiguration] = {
    INTEGRATED: _COMMON,
    INTEGRATED_STRAIGHT: _STRAIGHT,
    INTEGRATED_DEFAULTS: _DEFAULTS,
    HPDA_PARTICLE: replace(_COMMON, method="hpda_particle"),
    HPDA_KALMAN: _KALMAN,
    CLUSTERING: replace(_COMMON, method="roi_clustering"),
    CLUSTERING_LITERAL: replace(_COMMON, method="roi_clustering", roi_distance=1.0),
    PHD: replace(_COMMON, method="smc_phd"),
}
_METHODS = {name: configuration.method for name, configuration in _NAMED.items()}

PAPER_SYSTEMS: Mapping[str, ContactTrackerConfiguration] = {
    name: _NAMED.get(name, replace(_COMMON, method=method))
    for name, method in compared_methods(CONTACT_METHODS, _METHODS).items()
}
"""For environments 1 and 2."""

STRAIGHT_SYSTEMS: Mapping[str, ContactTrackerConfiguration] = {
    INTEGRATED: _COMMON,
    HPDA_KALMAN: _KALMAN,
}
"""For targets that do not turn: the same parameters as for those that do."""


_COMPUTED = {
    entry.label: entry.name
    for entry in GATE_THRESHOLDS
    if entry.sets_thresholds and entry.name != "fixed"
}


def _with_threshold(
    configuration: ContactTrackerConfiguration, threshold: str
) -> ContactTrackerConfiguration:
    configuration = replace(
        configuration, search_false_alarm_probability=SEARCH_FALSE_ALARM_PROBABILITY
    )
    if threshold in _COMPUTED:
        return replace(configuration, gate_threshold=_COMPUTED[threshold])
    return replace(
        configuration, gate_threshold="fixed", gate_false_alarm_probability=float(threshold)
    )


THRESHOLD_SYSTEMS: Mapping[str, ContactTrackerConfiguration] = {
    f"{name}, {threshold}": _with_threshold(configuration, threshold)
    for name, configuration in ((INTEGRATED, _COMMON), (HPDA_KALMAN, _KALMAN))
    for threshold in ("0.001", "0.01", "0.03", *_COMPUTED)
}
"""For environment 3: fixed and computed false-alarm probabilities in the gates.

0.03 is that of the detector: every contact in a gate is used.
"""
