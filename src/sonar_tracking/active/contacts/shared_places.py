"""Contacts of a ping placed once for several trackers that are given the same pings."""

from __future__ import annotations

from collections.abc import Sequence

from sonar_tracking.active.contacts.contact_positions import PlacedContacts
from sonar_tracking.records.contacts import Contacts


class SharedPlaces:
    """Remembers where the contacts of the newest pings were reflected, as found first."""

    def __init__(self) -> None:
        self._stamp: int | None = None
        self._pings: tuple[Contacts, ...] = ()
        self._sound_speed = 0.0
        self._placed: PlacedContacts | None = None

    def find(self, pings: Sequence[Contacts], sound_speed: float) -> PlacedContacts | None:
        """Return what is remembered of these very pings, one a scene; None = nothing.

        Parameters
        ----------
        pings : sequence of Contacts
            One a scene, with one stamp.
        sound_speed : float
            m/s; 0 = the ping takes no time.
        """
        known = self._sound_speed == sound_speed and len(self._pings) == len(pings)
        if known and all(one is other for one, other in zip(self._pings, pings, strict=True)):
            return self._placed
        return None

    def keep(self, pings: Sequence[Contacts], sound_speed: float, placed: PlacedContacts) -> None:
        """Remember what was found, if it is the first of its stamp.

        Parameters
        ----------
        pings : sequence of Contacts
            One a scene.
        sound_speed : float
            m/s.
        placed : PlacedContacts
            Of all of them.
        """
        if self._stamp != pings[0].stamp:
            self._stamp, self._pings = pings[0].stamp, tuple(pings)
            self._sound_speed, self._placed = sound_speed, placed
