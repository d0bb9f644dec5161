"""What a ping does not tell of its detector: taken from parameters.

References
----------
The fields are those of the message ``Contacts``, where NaN stands for the parameter.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from sonar_tracking.configuration import parameter
from sonar_tracking.records.contacts import Contacts


@dataclass(frozen=True)
class ContactDefaultsConfiguration:
    """Description of the detector where the contacts do not carry it; 0 = unknown."""

    range_standard_deviation: float = parameter(
        0.0, "of a contact, where the contacts do not carry it", unit="m", minimum=0.0
    )
    azimuth_standard_deviation_deg: float = parameter(
        0.0, "of a contact, where the contacts do not carry it", unit="deg", minimum=0.0
    )
    detection_threshold: float = parameter(
        0.0, "linear power, noise mean 1, where the contacts do not carry it", minimum=0.0
    )
    false_alarm_probability: float = parameter(
        0.0,
        "per resolution cell, where the contacts do not carry it",
        minimum=0.0,
        maximum=0.5,
    )
    range_resolution: float = parameter(
        0.0, "of a cell, where the contacts do not carry it", unit="m", minimum=0.0
    )
    azimuth_resolution_deg: float = parameter(
        0.0, "of a cell, where the contacts do not carry it", unit="deg", minimum=0.0
    )
    minimum_range: float = parameter(
        0.0, "of the survey, where the contacts do not carry it", unit="m", minimum=0.0
    )
    azimuth_width_deg: float = parameter(
        0.0,
        "of the survey, where the contacts do not carry it; 0 = all round",
        unit="deg",
        minimum=0.0,
        maximum=360.0,
    )


def with_defaults(contacts: Contacts, defaults: ContactDefaultsConfiguration) -> Contacts:
    """Return a ping with what it does not tell filled in from the parameters.

    Parameters
    ----------
    contacts : Contacts
        NaN = unknown.
    defaults : ContactDefaultsConfiguration
        What is zero there stays unknown.
    """
    given = {
        "range_standard_deviation": defaults.range_standard_deviation,
        "azimuth_standard_deviation": np.radians(defaults.azimuth_standard_deviation_deg),
        "detection_threshold": defaults.detection_threshold,
        "false_alarm_probability": defaults.false_alarm_probability,
        "range_resolution": defaults.range_resolution,
        "azimuth_resolution": np.radians(defaults.azimuth_resolution_deg),
        "minimum_range": defaults.minimum_range,
        "azimuth_width": np.radians(defaults.azimuth_width_deg),
    }
    missing: dict[str, Any] = {
        name: float(value)
        for name, value in given.items()
        if value > 0.0 and np.all(np.isnan(getattr(contacts, name)))
    }
    return replace(contacts, **missing) if missing else contacts
