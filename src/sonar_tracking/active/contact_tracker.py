"""The tracker of contacts, whatever its method.

One ping after the other goes into :meth:`ContactTracker.update`; a ping that could not be used is
replaced by :meth:`ContactTracker.coast`, so that there is one picture for each.
"""

from __future__ import annotations

from typing import Protocol, runtime_checkable

from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.active.tracks.shared_pings import SharedPings
from sonar_tracking.records.contacts import Contacts, ContactTrackerUpdate


class ContactTracker(Protocol):
    """Tracks several targets from contacts in clutter, one ping after the other.

    Attributes
    ----------
    configuration : ContactTrackerConfiguration
        Read at every ping; another may be put in its place in between, if only what is declared
        changeable differs.
    """

    configuration: ContactTrackerConfiguration

    def update(self, contacts: Contacts, shared: SharedPings | None = None) -> ContactTrackerUpdate:
        """Return the tracks after one ping.

        Parameters
        ----------
        contacts : Contacts
            Of the ping; may be empty.
        shared : SharedPings, optional
            Of other trackers that are given the same ping.

        Raises
        ------
        InputError
            If the ping cannot be used; the state is then unchanged.
        """

    def coast(self, stamp: int, next_stamp: int) -> ContactTrackerUpdate:
        """Return the tracks predicted to a ping of which nothing else is known.

        Raises
        ------
        InputError
            If the stamp is not later than that of the ping before.
        """

    def warm_up(self) -> None:
        """Load what the first ping needs, so that it need not wait for it."""

    def continue_from(self, first_id: int) -> None:
        """Let new tracks have identifiers from one on, if those so far are below it."""

    @property
    def next_id(self) -> int:
        """Identifier the next track will get."""


@runtime_checkable
class CommandedTracker(Protocol):
    """A tracker of contacts to which an operator may say what is a target, and what is not."""

    def start_track(self, position: tuple[float, float]) -> None:
        """Start a track at x and y in ``map``, m.

        Raises
        ------
        InputError
            If that cannot be.
        """

    def end_track(self, number: int) -> None:
        """End a track, by its identifier.

        Raises
        ------
        InputError
            If there is no such track.
        """

    def merge_tracks(self, number: int, other: int) -> None:
        """Let two tracks, by their identifiers, be one that has the first.

        Raises
        ------
        InputError
            If there is no such track.
        """


def make_contact_tracker(configuration: ContactTrackerConfiguration) -> ContactTracker:
    """Return the tracker of the configured method.

    Parameters
    ----------
    configuration : ContactTrackerConfiguration
        Method and parameters.

    Raises
    ------
    ConfigurationError
        If parameters do not fit together.
    """
    tracker: ContactTracker = configuration.entry.make(configuration)
    return tracker
