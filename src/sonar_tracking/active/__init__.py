"""Active sonar: detection thresholds, and tracks of several targets from contacts in clutter.

Positions are metres in the frame ``map`` (x east, y north), azimuths radians anticlockwise from
+x, amplitudes linear powers with noise mean 1. Decibels appear only in names that end in ``_db``.
"""

from typing import TYPE_CHECKING

from sonar_tracking.lazy_imports import lazy_exports

__all__ = [
    "CONTACT_METHODS",
    "GATE_THRESHOLDS",
    "ContactDefaultsConfiguration",
    "ContactMethodEntry",
    "ContactTracker",
    "ContactTrackerConfiguration",
    "FalseAlarmLimits",
    "GateThresholdEntry",
    "MountingConfiguration",
    "closed_form_false_alarm_probability",
    "detection_probability",
    "detection_threshold",
    "exact_information_reduction",
    "linear_from_decibel",
    "located",
    "make_contact_tracker",
    "optimal_false_alarm_probability",
    "with_defaults",
    "with_raised_threshold",
]

if TYPE_CHECKING:
    from sonar_tracking.active.contact_tracker import ContactTracker, make_contact_tracker
    from sonar_tracking.active.contacts.contact_defaults import (
        ContactDefaultsConfiguration,
        with_defaults,
    )
    from sonar_tracking.active.contacts.contact_method_registry import (
        CONTACT_METHODS,
        ContactMethodEntry,
    )
    from sonar_tracking.active.contacts.contact_tracker_configuration import (
        ContactTrackerConfiguration,
    )
    from sonar_tracking.active.contacts.gate_threshold_registry import (
        GATE_THRESHOLDS,
        GateThresholdEntry,
    )
    from sonar_tracking.active.contacts.sensor_location import MountingConfiguration, located
    from sonar_tracking.active.detection.detection_threshold import (
        FalseAlarmLimits,
        closed_form_false_alarm_probability,
        detection_probability,
        detection_threshold,
        linear_from_decibel,
    )
    from sonar_tracking.active.detection.information_reduction import (
        exact_information_reduction,
        optimal_false_alarm_probability,
    )
    from sonar_tracking.active.detection.raised_threshold import with_raised_threshold
else:
    __getattr__, __dir__ = lazy_exports(
        __name__,
        {
            "contact_tracker": ["ContactTracker", "make_contact_tracker"],
            "contacts.contact_defaults": ["ContactDefaultsConfiguration", "with_defaults"],
            "contacts.contact_method_registry": ["CONTACT_METHODS", "ContactMethodEntry"],
            "contacts.contact_tracker_configuration": ["ContactTrackerConfiguration"],
            "contacts.gate_threshold_registry": ["GATE_THRESHOLDS", "GateThresholdEntry"],
            "contacts.sensor_location": ["MountingConfiguration", "located"],
            "detection.detection_threshold": [
                "FalseAlarmLimits",
                "closed_form_false_alarm_probability",
                "detection_probability",
                "detection_threshold",
                "linear_from_decibel",
            ],
            "detection.information_reduction": [
                "exact_information_reduction",
                "optimal_false_alarm_probability",
            ],
            "detection.raised_threshold": ["with_raised_threshold"],
        },
    )
