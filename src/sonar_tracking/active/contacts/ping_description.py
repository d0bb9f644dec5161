"""What a ping says of its detector, as far as it makes sense.

A number that cannot be true is no reason to lose the contacts: it is taken for unknown, which the
parameters then fill in, and reported.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from sonar_tracking.errors import Notice, Severity
from sonar_tracking.records.contacts import Contacts

LIMITS: Mapping[str, tuple[float, float]] = {
    "detection_probability": (1e-6, 1.0),
    "false_alarm_probability": (1e-30, 0.999),
    "detection_threshold": (0.0, 1e6),
    "signal_to_noise_ratio_linear": (1e-3, 1e9),
    "clutter_density": (0.0, 1e3),
    "range_resolution": (1e-6, 1e6),
    "azimuth_resolution": (1e-9, 2.0 * np.pi),
    "minimum_range": (0.0, 1e7),
    "maximum_range": (1e-3, 1e7),
    "azimuth_width": (1e-6, 2.0 * np.pi + 1e-6),
}
"""Inclusive, in the units of the record."""


def plausible_description(contacts: Contacts) -> tuple[Contacts, tuple[Notice, ...]]:
    """Return a ping without what cannot be true of its detector, and a notice for each of that.

    Parameters
    ----------
    contacts : Contacts
        As received; NaN = unknown.
    """
    unknown: dict[str, Any] = {}
    notices = []
    for name, (low, high) in LIMITS.items():
        value = float(getattr(contacts, name))
        if math.isnan(value) or low <= value <= high:
            continue
        unknown[name] = np.nan
        notices.append(_notice(name, f"is {value:g}, outside {low:g} to {high:g}"))
    if contacts.minimum_range >= contacts.maximum_range and not unknown:
        unknown["minimum_range"] = np.nan
        text = f"is {contacts.minimum_range:g}, not below maximum_range"
        notices.append(_notice("minimum_range", text))
    return (replace(contacts, **unknown), tuple(notices)) if unknown else (contacts, ())


def _notice(name: str, text: str) -> Notice:
    sentence = f"{name} of the ping {text}; it is taken for unknown. Check the detector."
    return Notice(Severity.WARN, name, sentence)
