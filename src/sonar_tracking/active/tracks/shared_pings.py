"""What is found out of pings once for several trackers that are given the same ones."""

from __future__ import annotations

from collections.abc import Sequence

from sonar_tracking.active.contacts.contact_checks import PingOrigin, check_ping
from sonar_tracking.active.contacts.contact_positions import PlacedContacts, place_contacts
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.detection.detection_model import (
    DetectionDefaults,
    DetectionModel,
    make_detection_model,
)
from sonar_tracking.active.tracks.scene_rows import joined_tables
from sonar_tracking.errors import Notice
from sonar_tracking.records.contacts import Contacts

CheckedPing = tuple[Contacts, tuple[Notice, ...]]
"""Usable contacts, and what was wrong with the others."""

KnownPing = tuple[DetectionModel, tuple[Notice, ...]]
"""What is known of a ping, and what had to be guessed."""


class SharedPings:
    """Remembers which contacts of the newest pings can be used, and where they were reflected.

    What a tracker believes of a ping may differ from what the first one did: its contacts are then
    placed anew, those of the other scenes are not.
    """

    def __init__(self) -> None:
        self._stamp = 0
        self._received: dict[int, Contacts] = {}
        self._checked: dict[tuple[int, PingOrigin | None], CheckedPing] = {}
        self._models: dict[tuple[int, DetectionDefaults], KnownPing] = {}
        self._placed: dict[tuple[int, float], PlacedContacts] = {}
        self._joined: dict[tuple[tuple[int, ...], float], PlacedContacts] = {}

    def check(self, contacts: Contacts, last: PingOrigin | None) -> CheckedPing:
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
            If the ping as a whole cannot be used.
        """
        key = (self._number(contacts), last)
        if key not in self._checked:
            self._checked[key] = check_ping(contacts, last)
        return self._checked[key]

    def model(self, contacts: Contacts, configuration: ContactTrackerConfiguration) -> KnownPing:
        """Return what is known of a ping, and what had to be guessed.

        Parameters
        ----------
        contacts : Contacts
            Usable.
        configuration : ContactTrackerConfiguration
            Fills in what the ping does not carry.
        """
        defaults = DetectionDefaults.of(configuration)
        key = (self._number(contacts), defaults)
        if key not in self._models:
            self._models[key] = make_detection_model(contacts, defaults)
        return self._models[key]

    def _number(self, contacts: Contacts) -> int:
        """Return the number of a ping that is kept, so that it is no other's; forget older ones."""
        if contacts.stamp != self._stamp:
            self._stamp = contacts.stamp
            for known in (self._checked, self._models, self._placed, self._joined):
                known.clear()
            self._received.clear()
        self._received[id(contacts)] = contacts
        return id(contacts)

    def place(self, contacts: Contacts, sound_speed: float) -> PlacedContacts:
        """Return where the contacts of a ping were reflected.

        Parameters
        ----------
        contacts : Contacts
            Of the ping.
        sound_speed : float
            m/s; 0 = the ping takes no time.
        """
        key = (self._number(contacts), sound_speed)
        if key not in self._placed:
            self._placed[key] = place_contacts(contacts, sound_speed)
        return self._placed[key]

    def place_together(self, pings: Sequence[Contacts], sound_speed: float) -> PlacedContacts:
        """Return where the contacts of all scenes were reflected, one scene after the other.

        Parameters
        ----------
        pings : sequence of Contacts
            One a scene, with one stamp.
        sound_speed : float
            m/s; 0 = the ping takes no time.
        """
        key = (tuple(map(self._number, pings)), sound_speed)
        if key not in self._joined:
            self._joined[key] = joined_tables([self.place(each, sound_speed) for each in pings])
        return self._joined[key]
