"""What a bag holds for people to look at, as records in memory."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeVar

from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.bags.storage.bag_records import (
    BEARING_TRACKS_TYPE,
    CONTACTS_TYPE,
    FREQUENCY_LINES_TYPE,
    IMAGE_TYPE,
    ODOMETRY_TYPE,
    POSITION_TRACKS_TYPE,
    contacts_of,
    directions_of,
    frequency_lines_of,
    lofar_rows_of,
    own_ship_of,
    position_tracks_of,
    topics_of_type,
)
from sonar_tracking.bags.storage.reader import Bag
from sonar_tracking.display.located_pings import located_pings, recorded_mounting
from sonar_tracking.display.position_history import (
    PositionHistory,
    open_histories,
    position_histories,
)
from sonar_tracking.display.track_history import TrackHistory, track_histories
from sonar_tracking.records.bearings import BearingTracks
from sonar_tracking.records.contacts import Contacts
from sonar_tracking.records.lines import FrequencyLines, LofarRows
from sonar_tracking.records.own_ship import OwnShipState

Value = TypeVar("Value")

CONTACT_TRACKER = "hpda_tracker"
"""Node whose parameters tell where the sensor of contacts is mounted, and the sound speed."""


@dataclass(frozen=True)
class BagContents:
    """Tracks, truth, contacts and own ship of a bag, by topic.

    Attributes
    ----------
    bearings : mapping of str to tuple of BearingTracks
        Bearing tracks, whether tracked or measured.
    bearing_tracks, bearing_truth : mapping of str to tuple of TrackHistory
        Those that ever were confirmed.
    position_tracks, position_truth : mapping of str to tuple of PositionHistory
        Those that ever were confirmed.
    open_tracks : tuple of PositionHistory
        Positions of bearing tracks that do not claim a target yet.
    frequency_lines : mapping of str to tuple of FrequencyLines
        Lines heard, by topic.
    lofar_rows : mapping of str to tuple of LofarRows
        Of topics called ``lofar``.
    contacts : tuple of Contacts
        Of the first topic that has any, those that can be placed.
    sound_speed : float
        With which the contacts were tracked, m/s.
    own_ship : tuple of OwnShipState
        Of the first topic that has any, in order of time.
    rejected : tuple of str
        A sentence for each message that does not hold what it says.
    """

    bearings: Mapping[str, tuple[BearingTracks, ...]] = field(default_factory=dict)
    bearing_tracks: Mapping[str, tuple[TrackHistory, ...]] = field(default_factory=dict)
    bearing_truth: Mapping[str, tuple[TrackHistory, ...]] = field(default_factory=dict)
    position_tracks: Mapping[str, tuple[PositionHistory, ...]] = field(default_factory=dict)
    position_truth: Mapping[str, tuple[PositionHistory, ...]] = field(default_factory=dict)
    open_tracks: tuple[PositionHistory, ...] = ()
    frequency_lines: Mapping[str, tuple[FrequencyLines, ...]] = field(default_factory=dict)
    lofar_rows: Mapping[str, tuple[LofarRows, ...]] = field(default_factory=dict)
    contacts: tuple[Contacts, ...] = ()
    sound_speed: float = ContactTrackerConfiguration().sound_speed
    own_ship: tuple[OwnShipState, ...] = ()
    rejected: tuple[str, ...] = ()

    def begins(self) -> list[int]:
        """Return the first stamps of all tracks, truths, lines and pings, ns."""
        bearings = (*self.bearing_tracks.values(), *self.bearing_truth.values())
        positions = (*self.position_tracks.values(), *self.position_truth.values())
        begins = [int(history.stamps[0]) for tracks in bearings for history in tracks]
        begins += [int(history.stamps[0]) for tracks in positions for history in tracks]
        begins += [entry.stamp for lists in self.frequency_lines.values() for entry in lists[:1]]
        begins += [entry.stamp for rows in self.lofar_rows.values() for entry in rows[:1]]
        return begins + [ping.stamp for ping in self.contacts[:1]]


def bag_contents(bag: Bag) -> BagContents:
    """Read what a bag holds for people to look at.

    Parameters
    ----------
    bag : Bag
        Opened bag.
    """
    rejected: list[str] = []
    truths = {name for name, topic in bag.topics.items() if topic.role == "truth"}
    columns = {
        **_bearings(bag, truths, rejected),
        **_positions(bag, truths, rejected),
        **_contacts(bag, rejected),
        **_lines(bag, rejected),
    }
    return BagContents(**columns, rejected=tuple(rejected))


def _bearings(bag: Bag, truths: set[str], rejected: list[str]) -> dict[str, Any]:
    bearings = _by_topic(bag, BEARING_TRACKS_TYPE, directions_of, rejected)
    histories = {name: _confirmed(lists) for name, lists in bearings.items()}
    return {
        "bearings": _without(bearings, truths),
        "bearing_tracks": _without(histories, truths),
        "bearing_truth": _only(histories, truths),
    }


def _positions(bag: Bag, truths: set[str], rejected: list[str]) -> dict[str, Any]:
    positions = _by_topic(bag, POSITION_TRACKS_TYPE, position_tracks_of, rejected)
    histories = {name: position_histories(lists) for name, lists in positions.items()}
    tracked = _without(positions, truths).values()
    return {
        "position_tracks": _without(histories, truths),
        "position_truth": _only(histories, truths),
        "open_tracks": tuple(history for lists in tracked for history in open_histories(lists)),
    }


def _contacts(bag: Bag, rejected: list[str]) -> dict[str, Any]:
    """Return the contacts in ``map``, by what the bag knows of own ship and the mounting."""
    pings = next(iter(_by_topic(bag, CONTACTS_TYPE, contacts_of, rejected).values()), ())
    states = next(iter(_by_topic(bag, ODOMETRY_TYPE, own_ship_of, rejected).values()), ())
    own_ship = tuple(sorted(states, key=lambda state: state.stamp))
    parameters = bag.recording.node_parameters if bag.recording else {}
    given = parameters.get(CONTACT_TRACKER, {})
    return {
        "contacts": located_pings(pings, own_ship, recorded_mounting(given), rejected),
        "sound_speed": float(given.get("sound_speed", BagContents.sound_speed)),
        "own_ship": own_ship,
    }


def _lines(bag: Bag, rejected: list[str]) -> dict[str, Any]:
    pictures = [name for name in topics_of_type(bag, IMAGE_TYPE) if name.endswith("/lofar")]
    return {
        "frequency_lines": _by_topic(bag, FREQUENCY_LINES_TYPE, frequency_lines_of, rejected),
        "lofar_rows": {name: tuple(lofar_rows_of(bag, name, rejected)) for name in pictures},
    }


def _without(by_topic: Mapping[str, Value], truths: set[str]) -> dict[str, Value]:
    return {name: value for name, value in by_topic.items() if name not in truths}


def _only(by_topic: Mapping[str, Value], truths: set[str]) -> dict[str, Value]:
    return {name: value for name, value in by_topic.items() if name in truths}


def _by_topic(
    bag: Bag,
    type_name: str,
    read: Callable[[Bag, str, list[str]], Iterable[Any]],
    rejected: list[str],
) -> dict[str, tuple[Any, ...]]:
    return {name: tuple(read(bag, name, rejected)) for name in topics_of_type(bag, type_name)}


def _confirmed(lists: Iterable[BearingTracks]) -> tuple[TrackHistory, ...]:
    return tuple(history for history in track_histories(lists) if history.confirmed)
