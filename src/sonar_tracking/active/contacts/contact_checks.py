"""Which pings and which of their contacts are usable.

A ping whose description is wrong is rejected as a whole; a single bad contact is left out and
reported, since the others are still good.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from sonar_tracking.active.contacts.ping_description import plausible_description
from sonar_tracking.errors import InputError, Notice, Severity
from sonar_tracking.records.contacts import Contacts
from sonar_tracking.records.time import seconds

LARGEST_RANGE = 1e7
LARGEST_AMPLITUDE = 1e12
"""m, and linear power: what exceeds them is no contact."""

LARGEST_SENSOR_SPEED = 200.0
"""m/s; places of reflection need a sensor far slower than sound."""

DEVIATION_LIMITS = {
    "range_standard_deviation": (1e-3, 1e6),
    "azimuth_standard_deviation": (1e-7, np.pi),
}
"""m and rad; smaller and larger ones are taken for these, so that gates stay regular."""

LARGEST_JUMP = 100.0
LARGEST_ACCELERATION = 1.0
"""Of own ship, m and m/s^2: a position that needs more than both has jumped."""


@dataclass(frozen=True)
class PingOrigin:
    """When and from where a ping was sent.

    Attributes
    ----------
    stamp : int
        ns.
    position, velocity : tuple of float
        Of the sensor in ``map``, m and m/s.
    """

    stamp: int
    position: tuple[float, float]
    velocity: tuple[float, float]

    def interval(self, stamp: int) -> float:
        """Return the time from this ping to a stamp, s."""
        return seconds(stamp - self.stamp)

    def moved_to(self, stamp: int) -> PingOrigin:
        """Return where the sensor is at another stamp if it goes on as it does."""
        interval = self.interval(stamp)
        x, y = (p + interval * v for p, v in zip(self.position, self.velocity, strict=True))
        return PingOrigin(stamp, (x, y), self.velocity)


def origin_of(contacts: Contacts) -> PingOrigin:
    """Return when and from where a ping was sent."""
    return PingOrigin(contacts.stamp, contacts.sensor_position, contacts.sensor_velocity)


def check_ping(contacts: Contacts, last: PingOrigin | None) -> tuple[Contacts, tuple[Notice, ...]]:
    """Return the usable contacts of a ping and what was wrong with the others.

    Parameters
    ----------
    contacts : Contacts
        As received.
    last : PingOrigin or None
        The ping before; None at the first.

    Raises
    ------
    InputError
        If the ping as a whole cannot be used; one sentence for the first thing that is wrong.
    """
    check_order(contacts.stamp, last)
    n_contacts = len(contacts.range)
    if len(contacts.azimuth) != n_contacts or len(contacts.amplitude) not in (0, n_contacts):
        raise InputError(
            f"The ping has {n_contacts} ranges, {len(contacts.azimuth)} azimuths and "
            f"{len(contacts.amplitude)} amplitudes; give equally many (amplitudes may be empty)."
        )
    contacts = _with_regular_deviations(contacts)
    where = (*contacts.sensor_position, *contacts.sensor_velocity)
    if not all(map(math.isfinite, where)):
        raise InputError("Position or velocity of the sensor is unknown; give own-ship motion.")
    speed = math.hypot(*contacts.sensor_velocity)
    if speed > LARGEST_SENSOR_SPEED:
        raise InputError(f"The sensor moves at {speed:.0f} m/s, which it cannot; check its motion.")
    described, doubts = plausible_description(contacts)
    usable, notices = _usable(described)
    return usable, (*doubts, *notices, *_jump_notices(contacts, last))


def check_order(stamp: int, last: PingOrigin | None) -> None:
    """Refuse a stamp that is not later than that of the ping before.

    Raises
    ------
    InputError
        If it is not.
    """
    if last is not None and stamp <= last.stamp:
        raise InputError(
            f"The ping at {stamp} ns is not later than the one before at {last.stamp} ns; "
            "duplicates and pings out of order are left out."
        )


def _with_regular_deviations(contacts: Contacts) -> Contacts:
    changed: dict[str, Any] = {}
    for name, (smallest, largest) in DEVIATION_LIMITS.items():
        given = getattr(contacts, name)
        if isinstance(given, float) and smallest <= given <= largest:
            continue
        values = np.asarray(given)
        if values.shape not in ((), (len(contacts.range),)):
            raise InputError(
                f"{name} of the ping has {values.size} entries for {len(contacts.range)} contacts; "
                "give one, or one a contact."
            )
        if ((values >= smallest) & (values <= largest)).all():
            continue
        if not ((values > 0.0) & (values < np.inf)).all():
            raise InputError(
                f"{name} of the ping is unknown or not positive; give the errors of the sensor, in "
                "the message or as a parameter."
            )
        changed[name] = np.clip(values, smallest, largest)
    return replace(contacts, **changed) if changed else contacts


def sensor_jump(contacts: Contacts, last: PingOrigin | None) -> float:
    """Return how far the sensor is from where its motion takes it, m; 0 = it may be there.

    Parameters
    ----------
    contacts : Contacts
        The ping.
    last : PingOrigin or None
        The ping before; None at the first.
    """
    if last is None:
        return 0.0
    interval = last.interval(contacts.stamp)
    motion = zip(last.position, last.velocity, contacts.sensor_velocity, strict=True)
    expected = [position + 0.5 * interval * (before + now) for position, before, now in motion]
    jump = math.dist(contacts.sensor_position, expected)
    return jump if jump > LARGEST_JUMP + 0.5 * LARGEST_ACCELERATION * interval**2 else 0.0


def _jump_notices(contacts: Contacts, last: PingOrigin | None) -> tuple[Notice, ...]:
    """Say that the sensor is not where its motion takes it; its contacts are still used."""
    jump = sensor_jump(contacts, last)
    if jump == 0.0:
        return ()
    text = (
        f"The sensor is {jump:.0f} m from where its motion takes it; contacts are placed from its "
        "new position, and tracks coast if they do not fit. Check own-ship navigation."
    )
    return (Notice(Severity.WARN, "sensor_position", text),)


def _usable(contacts: Contacts) -> tuple[Contacts, tuple[Notice, ...]]:
    good = np.isfinite(contacts.azimuth) & (contacts.range > 0.0)
    good &= contacts.range <= LARGEST_RANGE
    measured = len(contacts.amplitude) > 0
    if measured:
        good &= (contacts.amplitude >= 0.0) & (contacts.amplitude <= LARGEST_AMPLITUDE)
    notices = []
    if not good.all():
        text = (
            f"{np.count_nonzero(~good)} of {len(good)} contacts have no positive finite range, "
            "no finite azimuth or a negative amplitude and are left out; check the detector."
        )
        notices.append(Notice(Severity.WARN, "contacts", text))
        contacts = contacts.selected(good)
    if not measured and len(contacts.range):
        text = "The contacts have no amplitudes; they are associated by distance alone."
        notices.append(Notice(Severity.WARN, "amplitude", text))
    return contacts, tuple(notices)
