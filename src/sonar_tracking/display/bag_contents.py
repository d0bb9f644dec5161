"""What a bag holds for people to look at, as records in memory.

The bag is read once, in log order. Of long recordings evenly chosen entries are kept, and rows of
pictures are integrated, so that memory is bounded whatever the length.
"""

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
    POSITION_TRACKS_TYPE,
    SAMPLES_TYPE,
    SNAPSHOTS_TYPE,
    records_in_order,
    topics_of_type,
)
from sonar_tracking.bags.storage.reader import Bag
from sonar_tracking.display.bearing_time_record import Waterfall
from sonar_tracking.display.located_pings import located_pings, recorded_mounting
from sonar_tracking.display.lofar_gram import GramRows
from sonar_tracking.display.page.outermost_topic import outermost_topic, station_of
from sonar_tracking.display.page.own_ship_legs import Leg, own_ship_legs
from sonar_tracking.display.position_history import (
    PositionHistory,
    open_histories,
    position_histories,
)
from sonar_tracking.display.recorded_dots import RecordedDots
from sonar_tracking.display.recorded_waterfalls import RecordedWaterfalls
from sonar_tracking.display.stacked_dots_record import TrackDots
from sonar_tracking.display.thinned_lists import Thinned
from sonar_tracking.display.track_history import TrackHistory, track_histories
from sonar_tracking.message_reading.own_ship_reading import ODOMETRY_TYPE
from sonar_tracking.records.bearings import BearingTracks
from sonar_tracking.records.contacts import Contacts
from sonar_tracking.records.lines import FrequencyLines
from sonar_tracking.records.own_ship import OwnShipState
from sonar_tracking.records.station_name import station_name

Value = TypeVar("Value")

CONTACT_TRACKER = "hpda_tracker"
"""Node whose parameters tell where the sensor of contacts is mounted, and the sound speed."""

MOST_KEPT = 6000
"""Records kept of one topic."""

_LISTED = (
    BEARING_TRACKS_TYPE,
    POSITION_TRACKS_TYPE,
    CONTACTS_TYPE,
    FREQUENCY_LINES_TYPE,
    ODOMETRY_TYPE,
)
_ROWS = (SNAPSHOTS_TYPE, SAMPLES_TYPE, IMAGE_TYPE)


@dataclass(frozen=True)
class BagContents:
    """Tracks, truth, contacts, own ship and rows of pictures of a bag, by topic.

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
    waterfalls : mapping of str to Waterfall
        Beam power of snapshots and samples.
    grams : mapping of str to GramRows
        Spectra of beams.
    dots : tuple of TrackDots
        Stacked dots of the solutions.
    contacts : mapping of str to tuple of Contacts
        Those that can be placed, by topic.
    sound_speed : float
        With which the contacts were tracked, m/s.
    own_ship : tuple of OwnShipState
        In order of time.
    other_ships : mapping of str to tuple of OwnShipState
        The same of other ships of own side, by their namespace.
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
    waterfalls: Mapping[str, Waterfall] = field(default_factory=dict)
    grams: Mapping[str, GramRows] = field(default_factory=dict)
    dots: tuple[TrackDots, ...] = ()
    contacts: Mapping[str, tuple[Contacts, ...]] = field(default_factory=dict)
    sound_speed: float = ContactTrackerConfiguration().sound_speed
    own_ship: tuple[OwnShipState, ...] = ()
    other_ships: Mapping[str, tuple[OwnShipState, ...]] = field(default_factory=dict)
    rejected: tuple[str, ...] = ()

    @property
    def legs(self) -> list[Leg]:
        """Own ship's legs and turns."""
        return own_ship_legs(self.own_ship)

    @property
    def is_own_ship_alone(self) -> bool:
        """Whether there is nothing to draw but own ship."""
        return bool(self.own_ship) and not self._begins()

    def begins(self) -> list[int]:
        """Return the first stamps of all that can be drawn, ns."""
        return self._begins() or [state.stamp for state in self.own_ship[:1]]

    def _begins(self) -> list[int]:
        """Return the first stamps of all but own ship, ns."""
        bearings = (*self.bearing_tracks.values(), *self.bearing_truth.values())
        positions = (*self.position_tracks.values(), *self.position_truth.values())
        begins = [int(history.stamps[0]) for tracks in bearings for history in tracks]
        begins += [int(history.stamps[0]) for tracks in positions for history in tracks]
        begins += [entry.stamp for lists in self.frequency_lines.values() for entry in lists[:1]]
        begins += [each.begin for each in self.waterfalls.values()]
        begins += [rows.begin for rows in self.grams.values()]
        return begins + [ping.stamp for pings in self.contacts.values() for ping in pings[:1]]


def bag_contents(bag: Bag, advance: Callable[[], object] = lambda: None) -> BagContents:
    """Read what a bag holds for people to look at.

    Parameters
    ----------
    bag : Bag
        Opened bag.
    advance : callable
        Called after each message of :func:`drawn_topics`.
    """
    topics = drawn_topics(bag)
    lists: dict[str, Thinned[Any]] = {}
    rejected: list[str] = []
    waterfalls, dots = RecordedWaterfalls(bag), RecordedDots(bag)
    for topic, record in records_in_order(bag, topics, rejected):
        if record is not None:
            waterfalls.take(topic, record)
            dots.take(topic, record)
            if bag.topics[topic].type_name in _LISTED:
                lists.setdefault(topic, Thinned(MOST_KEPT)).append(record)
        advance()
    truths = {name for name, topic in bag.topics.items() if topic.role == "truth"}

    def of_type(kind: str) -> dict[str, tuple[Any, ...]]:
        return {name: tuple(lists.get(name, ())) for name in topics_of_type(bag, kind)}

    columns = {
        **_bearings(of_type(BEARING_TRACKS_TYPE), truths),
        **_positions(of_type(POSITION_TRACKS_TYPE), truths),
        **_contacts(bag, of_type(CONTACTS_TYPE), of_type(ODOMETRY_TYPE), rejected),
        "frequency_lines": of_type(FREQUENCY_LINES_TYPE),
        "waterfalls": waterfalls.waterfalls,
        "grams": waterfalls.grams,
        "dots": dots.dots(),
    }
    return BagContents(**columns, rejected=tuple(rejected))


def drawn_topics(bag: Bag) -> list[str]:
    """Return the topics of a bag that are drawn."""
    return [
        topic
        for kind in (*_LISTED, *_ROWS)
        for topic in topics_of_type(bag, kind)
        if kind != IMAGE_TYPE or topic.endswith("/lofar")
    ]


def _bearings(by_topic: dict[str, tuple[Any, ...]], truths: set[str]) -> dict[str, Any]:
    histories = {name: _confirmed(lists) for name, lists in by_topic.items()}
    return {
        "bearings": _without(by_topic, truths),
        "bearing_tracks": _without(histories, truths),
        "bearing_truth": _only(histories, truths),
    }


def _positions(by_topic: dict[str, tuple[Any, ...]], truths: set[str]) -> dict[str, Any]:
    histories = {name: position_histories(lists) for name, lists in by_topic.items()}
    tracked = _without(by_topic, truths).values()
    return {
        "position_tracks": _without(histories, truths),
        "position_truth": _only(histories, truths),
        "open_tracks": tuple(history for lists in tracked for history in open_histories(lists)),
    }


def _contacts(
    bag: Bag,
    contacts: dict[str, tuple[Any, ...]],
    odometry: dict[str, tuple[Any, ...]],
    rejected: list[str],
) -> dict[str, Any]:
    """Return the contacts in ``map``, by what the bag knows of own ship and the mounting."""
    ships = {
        name: tuple(sorted(states, key=lambda state: state.stamp))
        for name, states in odometry.items()
    }
    own_ship = ships.pop(outermost_topic(ships), ())
    other_ships = {station_of(name): states for name, states in ships.items()}
    parameters = bag.recording.node_parameters if bag.recording else {}

    def located(topic: str, pings: tuple[Any, ...]) -> tuple[Contacts, ...]:
        station = station_of(topic)
        tracker = f"{station_name(station)}_{CONTACT_TRACKER}"
        given = parameters.get(tracker, parameters.get(CONTACT_TRACKER, {}))
        carrier = other_ships.get(station, own_ship)
        return located_pings(pings, carrier, recorded_mounting(given), rejected)

    given = parameters.get(CONTACT_TRACKER, {})
    found = {topic: located(topic, pings) for topic, pings in contacts.items()}
    return {
        "contacts": {topic: pings for topic, pings in found.items() if pings},
        "sound_speed": float(given.get("sound_speed", BagContents.sound_speed)),
        "own_ship": own_ship,
        "other_ships": other_ships,
    }


def _without(by_topic: Mapping[str, Value], truths: set[str]) -> dict[str, Value]:
    return {name: value for name, value in by_topic.items() if name not in truths}


def _only(by_topic: Mapping[str, Value], truths: set[str]) -> dict[str, Value]:
    return {name: value for name, value in by_topic.items() if name in truths}


def _confirmed(lists: Iterable[BearingTracks]) -> tuple[TrackHistory, ...]:
    return tuple(history for history in track_histories(lists) if history.confirmed)
