"""How detection thresholds in the gates of confirmed tracks are chosen."""

from __future__ import annotations

from dataclasses import dataclass

from sonar_tracking.method_registry import MethodEntry, MethodRegistry, trait

AS_DETECTED = "as_detected"

_HERE = "sonar_tracking.active.tracks.gate_thresholds"


@dataclass(frozen=True)
class GateThresholdEntry(MethodEntry):
    """A choice of thresholds.

    Its factory takes a :class:`~sonar_tracking.active.contacts.contact_tracker_configuration.\
ContactTrackerConfiguration` and returns a
    :data:`~sonar_tracking.active.tracks.gate_thresholds.GateProbability`.

    Attributes
    ----------
    sets_thresholds : bool
        Thresholds in gates differ from those outside: it needs gates, and a ping that tells its
        resolution and its false alarms.
    """

    sets_thresholds: bool = trait("needs gates, resolution and false alarms of the ping")


GATE_THRESHOLDS = MethodRegistry(
    "hpda_tracker.gate_threshold",
    GateThresholdEntry(
        AS_DETECTED,
        f"{_HERE}:as_outside_gates",
        "every contact, as outside the gates",
        label="as detected",
    ),
    GateThresholdEntry(
        "fixed",
        f"{_HERE}:fixed_probability",
        "a fixed false-alarm probability",
        label="fixed",
        sets_thresholds=True,
    ),
    GateThresholdEntry(
        "closed_form",
        f"{_HERE}:closed_form_probability",
        "the false-alarm probability of least expected error",
        label="closed form",
        paper="Jung, Shin 2002",
        sets_thresholds=True,
    ),
)
