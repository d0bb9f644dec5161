"""What a detector with a higher threshold would have given of a ping.

A threshold tau = -ln P_F on the power leaves the contacts above it. With the powers of noise and
target exponential, the probability of detection becomes P_D^(ln P_F' / ln P_F), and false contacts
are fewer by P_F' / P_F.

References
----------
Jung, Shin (2002), equations 2-3.
"""

from __future__ import annotations

import math
from dataclasses import replace

from sonar_tracking.errors import InputError
from sonar_tracking.records.contacts import Contacts


def with_raised_threshold(contacts: Contacts, false_alarm_probability: float) -> Contacts:
    """Return the contacts above a threshold, and what it does to detection and clutter.

    Parameters
    ----------
    contacts : Contacts
        Of one ping, with amplitudes and the false-alarm probability they were detected with.
    false_alarm_probability : float
        P_F' per resolution cell, above 0. One above that of the contacts changes nothing.

    Returns
    -------
    Contacts
        With threshold, P_F, P_D and clutter density of the higher threshold; a P_D or density that
        was not known stays so.

    Raises
    ------
    InputError
        If the contacts have no amplitudes, or their false-alarm probability is not known.
    """
    before = contacts.false_alarm_probability
    if not 0.0 < before < 1.0 or not false_alarm_probability > 0.0:
        raise InputError(
            f"The false-alarm probability is {before:g} and {false_alarm_probability:g} is wanted; "
            "a threshold can be raised where both are above 0 and the first is below 1."
        )
    if len(contacts.amplitude) != len(contacts.range):
        raise InputError("The contacts have no amplitudes; a threshold cannot be raised.")
    if false_alarm_probability >= before:
        return contacts
    threshold = -math.log(false_alarm_probability)
    exponent = math.log(false_alarm_probability) / math.log(before)
    return replace(
        contacts.selected(contacts.amplitude >= threshold),
        detection_threshold=threshold,
        false_alarm_probability=false_alarm_probability,
        detection_probability=contacts.detection_probability**exponent,
        clutter_density=contacts.clutter_density * false_alarm_probability / before,
    )
