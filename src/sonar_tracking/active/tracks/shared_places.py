"""Contacts of a ping placed once for several trackers that are given the same pings."""

from __future__ import annotations

from collections.abc import Sequence

from sonar_tracking.active.contacts.contact_positions import PlacedContacts, place_contacts
from sonar_tracking.active.tracks.scene_rows import joined_tables
from sonar_tracking.records.contacts import Contacts


class SharedPlaces:
    """Remembers where the contacts of the newest pings were reflected.

    What a tracker believes of a ping may differ from what the first one did: its contacts are then
    placed anew, those of the other scenes are not.
    """

    def __init__(self) -> None:
        self._known: tuple[int, float] | None = None
        self._pings: tuple[Contacts, ...] = ()
        self._each: list[PlacedContacts] = []
        self._joined: PlacedContacts | None = None

    def place(self, pings: Sequence[Contacts], sound_speed: float) -> PlacedContacts:
        """Return where the contacts of all scenes were reflected, one scene after the other.

        Parameters
        ----------
        pings : sequence of Contacts
            One a scene, with one stamp.
        sound_speed : float
            m/s; 0 = the ping takes no time.
        """
        if self._known != (pings[0].stamp, sound_speed) or len(self._pings) != len(pings):
            self._known, self._pings = (pings[0].stamp, sound_speed), tuple(pings)
            self._each = [place_contacts(contacts, sound_speed) for contacts in pings]
            self._joined = joined_tables(self._each)
            return self._joined
        same = [one is other for one, other in zip(self._pings, pings, strict=True)]
        if all(same) and self._joined is not None:
            return self._joined
        return joined_tables(
            [
                placed if known else place_contacts(contacts, sound_speed)
                for placed, known, contacts in zip(self._each, same, pings, strict=True)
            ]
        )
