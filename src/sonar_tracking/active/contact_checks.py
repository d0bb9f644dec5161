"""Which pings and which of their contacts are usable.

A ping whose description is wrong is rejected as a whole; a single bad contact is left out and
reported, since the others are still good.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sonar_tracking.active.records import Contacts, FloatArray
from sonar_tracking.errors import InputError, Notice, Severity


def check_ping(contacts: Contacts, last_stamp: int | None) -> tuple[Contacts, tuple[Notice, ...]]:
    """Return the usable contacts of a ping and what was wrong with the others.

    Parameters
    ----------
    contacts : Contacts
        As received.
    last_stamp : int or None
        Stamp of the ping before, ns; None at the first.

    Raises
    ------
    InputError
        If the ping as a whole cannot be used; one sentence for the first thing that is wrong.
    """
    if last_stamp is not None and contacts.stamp <= last_stamp:
        raise InputError(
            f"The ping at {contacts.stamp} ns is not later than the one before at "
            f"{last_stamp} ns; duplicates and pings out of order are left out."
        )
    n_contacts = len(contacts.range)
    if len(contacts.azimuth) != n_contacts or len(contacts.amplitude) not in (0, n_contacts):
        raise InputError(
            f"The ping has {n_contacts} ranges, {len(contacts.azimuth)} azimuths and "
            f"{len(contacts.amplitude)} amplitudes; give equally many (amplitudes may be empty)."
        )
    for name in ("range_standard_deviation", "azimuth_standard_deviation"):
        values = np.asarray(getattr(contacts, name))
        if values.shape not in ((), (n_contacts,)):
            raise InputError(
                f"{name} of the ping has {values.size} entries for {n_contacts} contacts; give "
                "one, or one a contact."
            )
        if not (np.all(np.isfinite(values)) and np.all(values > 0.0)):
            raise InputError(f"{name} of the ping is not positive; give the errors of the sensor.")
    where = (*contacts.sensor_position, *contacts.sensor_velocity)
    if not np.all(np.isfinite(where)):
        raise InputError("Position or velocity of the sensor is unknown; give own-ship motion.")
    return _usable(contacts)


def _usable(contacts: Contacts) -> tuple[Contacts, tuple[Notice, ...]]:
    good = np.isfinite(contacts.range) & np.isfinite(contacts.azimuth) & (contacts.range > 0.0)
    measured = len(contacts.amplitude) > 0
    if measured:
        good &= np.isfinite(contacts.amplitude) & (contacts.amplitude >= 0.0)
    notices = []
    if not np.all(good):
        text = (
            f"{np.count_nonzero(~good)} of {len(good)} contacts have no positive finite range, "
            "no finite azimuth or a negative amplitude and are left out; check the detector."
        )
        notices.append(Notice(Severity.WARN, "contacts", text))
        contacts = replace(
            contacts,
            range=contacts.range[good],
            azimuth=contacts.azimuth[good],
            amplitude=contacts.amplitude[good] if measured else contacts.amplitude,
            range_standard_deviation=_kept(contacts.range_standard_deviation, good),
            azimuth_standard_deviation=_kept(contacts.azimuth_standard_deviation, good),
        )
    if not measured and len(contacts.range):
        text = "The contacts have no amplitudes; they are associated by distance alone."
        notices.append(Notice(Severity.WARN, "amplitude", text))
    return contacts, tuple(notices)


def _kept(values: float | FloatArray, good: NDArray[np.bool_]) -> float | FloatArray:
    return values[good] if isinstance(values, np.ndarray) and values.ndim else values
